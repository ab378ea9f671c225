// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_solver.h>
#include <viscoplastic_contact/contact/statics.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/time_stepping/step_problem.h>

#include <functional>

namespace Viscoplastic
{
  /// The proximal point method for bodies that only contact holds, whose matrix
  /// is singular: weak springs tie the contact nodes to where they are, the
  /// step is solved, and this is repeated from the solution until the springs
  /// carry nothing. Between two solves a body on a compliant foundation is
  /// moved as a whole to where contact balances its loads. Before the first
  /// solve, bounds_that_hold() checks that contact can balance the loads.
  template <int dim>
  class ProximalSprings
  {
  public:
    explicit ProximalSprings(const Discretization<dim> &discretization);

    /// Return @p matrix, which is kept by reference, with springs. Collective.
    const DistributedMatrix &
    attach(const DistributedMatrix &matrix);

    /// Add to @p load that of springs with the rest position @p u.
    void
    add_load(const DistributedVector &u, DistributedVector &load) const
    {
      DistributedVector force(springs);
      force.scale(u);
      load += force;
    }

    /// Return the friction bounds for the solve of a step: @p bounds, raised if
    /// bounds that follow the pressure can hold the body and @p bounds cannot.
    /// Throws ExcMessage if no contact force balances the loads. Collective.
    std::vector<double>
    bounds_that_hold(const StepProblem<dim>    &problem,
                     const std::vector<double> &bounds) const;

    /// Solves the step with springs for u and contact. The arguments are the
    /// displacement of the step before, the right side and the tolerance.
    using Solve = std::function<ContactReport(const DistributedVector &,
                                              const DistributedVector &,
                                              const double)>;

    /// Solve the step of @p problem by repeated calls of @p solve, which change
    /// @p u and @p contact. Throws ExcMessage if the body does not come to
    /// rest. Collective.
    ContactReport
    solve(const StepProblem<dim>  &problem,
          const DistributedVector &right_side,
          const double             tolerance,
          const Solve             &solve,
          DistributedVector       &u,
          ContactState            &contact) const;

  private:
    /// Whether contact can balance the loads of a problem, with friction bounds
    /// that follow the pressure to be found, or with given ones. Collective.
    Statics
    statics(const StepProblem<dim>    &problem,
            const std::vector<double> &bounds,
            const bool                 with_pressure) const;

    /// The body and its loads as balance() and settle() take them. Collective.
    HeldBody
    held_body(const StepProblem<dim> &problem) const;

    /// Whether neither loads nor a foundation do work on a rigid motion, and
    /// old contact forces are rounding. Collective.
    bool
    rests(const StepProblem<dim>  &problem,
          const HeldBody          &body,
          const DistributedVector &right_side) const;

    /// What springs carry after a solve: the norm in the springs, the energy
    /// norm of the solution, and whether spring forces are negligible.
    struct Held
    {
      double in_springs, size;
      bool   in_balance;
    };

    /// Add the norm in the springs of @p change, the last change of @p u, to
    /// the error of @p report. @p whole: the springs' rest position with all
    /// rigid motion. Collective.
    Held
    measure(const StepProblem<dim>  &problem,
            const DistributedVector &right_side,
            const double             tolerance,
            const DistributedVector &u,
            const DistributedVector &change,
            const DistributedVector &whole,
            ContactReport           &report) const;

    /// Move u and the rest position of the springs by the rigid motion to where
    /// the loads balance on a compliant foundation. Collective.
    void
    settle_whole(const StepProblem<dim>  &problem,
                 const HeldBody          &body,
                 const ContactState      &contact,
                 const DistributedVector &old_u,
                 DistributedVector       &center,
                 DistributedVector       &u) const;

    /// A sentence on why a body that still moves by @p change does not come to
    /// rest. Collective.
    std::string
    restlessness(DistributedVector change, const double left_by_rounding) const;

    /// The norm of a displacement in the springs. Collective.
    double
    norm(const DistributedVector &u) const
    {
      DistributedVector force(springs);
      force.scale(u);
      return std::sqrt(std::max(0., u * force));
    }

    /// The step along @p change, the last motion of the body away from the rest
    /// position of the springs, to a better rest position: the step of Barzilai
    /// & Borwein (IMA J. Numer. Anal. 8, 1988) from the last two solves for the
    /// minimum of the energy with springs, whose gradient is their force. It is
    /// the secant rule for a single motion. Collective.
    double
    learned_step(const DistributedVector &last_center,
                 const DistributedVector &center,
                 const DistributedVector &last_change,
                 const DistributedVector &change) const;

    /// The rigid motion, of those that only contact can prevent, nearest to a
    /// displacement. Collective.
    DistributedVector
    rigid_part(const DistributedVector &u) const
    {
      DistributedVector result = discretization.space.owned_vector();
      for (const DistributedVector &motion : orthonormal_motions)
        result.add(u * motion, motion);
      return result;
    }

    const Discretization<dim> &discretization;
    /// The rigid motions that only contact can prevent.
    const std::vector<DistributedVector> motions;
    std::vector<DistributedVector>       orthonormal_motions;
    /// The degrees of freedom with springs, as local indices: as many
    /// components of contact nodes as there are motions, which they constrain.
    std::vector<unsigned int> supports;
    const DistributedMatrix  *singular_matrix = nullptr;
    DistributedMatrix         regular_matrix;
    DistributedVector         springs; // a diagonal matrix
    /// The rounding of the matrix in the springs, relative to u.
    double rounding = 0.;
  };
} // namespace Viscoplastic
