// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/bulk_solver.h>
#include <viscoplastic_contact/contact/contact_solver.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/time_stepping/step_problem.h>

#include <functional>

namespace Viscoplastic
{
  /**
   * The proximal point method for bodies that only contact holds, whose matrix
   * is singular: weak springs tie the contact nodes to where they are, the step
   * is solved, and this is repeated from the solution until the springs carry
   * nothing.
   */
  template <int dim>
  class ProximalSprings
  {
  public:
    explicit ProximalSprings(const Discretization<dim> &discretization);

    /// The matrix with the springs; @p matrix stays in use. Collective.
    const DistributedMatrix &
    attach(const DistributedMatrix &matrix);

    /// Add the load of springs that carry nothing at @p u.
    void
    add_load(const DistributedVector &u, DistributedVector &load) const;

    /// Solves the step with the springs from u and contact, for a right side
    /// and a tolerance.
    using Solve =
      std::function<ContactReport(const DistributedVector &, const double)>;

    /**
     * Solve the step of @p problem by repeated calls of @p solve, which change
     * @p u and @p contact. Throws ExcMessage where no contact force balances
     * the loads. Collective.
     */
    ContactReport
    solve(const StepProblem<dim>  &problem,
          const DistributedVector &right_side,
          const double             tolerance,
          const BulkSolver        &bulk,
          const Solve             &solve,
          DistributedVector       &u,
          ContactState            &contact) const;

  private:
    /// How far a motion can be repeated from @p u without entering an obstacle.
    /// Collective.
    double
    way_to_obstacles(const StepProblem<dim>  &problem,
                     const ContactState      &contact,
                     const DistributedVector &u,
                     const DistributedVector &motion) const;

    /// The norm of a displacement in the springs. Collective.
    double
    norm(const DistributedVector &u) const;

    const Discretization<dim> &discretization;
    const DistributedMatrix   *singular_matrix = nullptr;
    DistributedMatrix          regular_matrix;
    DistributedVector          springs; // a diagonal matrix
    /// What rounding in the matrix leaves in the springs, relative to u.
    double rounding = 0.;
  };
} // namespace Viscoplastic
