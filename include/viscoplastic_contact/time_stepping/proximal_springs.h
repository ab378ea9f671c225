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
  /// carry nothing. Between two solves the body settles as a whole where
  /// contact balances its loads. Whether it can, statics says before the first
  /// solve.
  template <int dim>
  class ProximalSprings
  {
  public:
    explicit ProximalSprings(const Discretization<dim> &discretization);

    /// The matrix with the springs; @p matrix stays in use. Collective.
    const DistributedMatrix &
    attach(const DistributedMatrix &matrix);

    /// Add to a load that of springs which are relaxed at @p u.
    void
    add_load(const DistributedVector &u, DistributedVector &load) const
    {
      DistributedVector force(springs);
      force.scale(u);
      load += force;
    }

    /// The bounds of friction with which a step is solved: @p bounds, raised
    /// where bounds that follow the pressure could hold the body but these
    /// cannot. Throws ExcMessage where no contact force balances the loads.
    /// Collective.
    std::vector<double>
    bounds_that_hold(const StepProblem<dim>    &problem,
                     const std::vector<double> &bounds) const;

    /// Solves the step with the springs from u and contact, for a displacement
    /// of the step before, a right side and a tolerance.
    using Solve = std::function<ContactReport(const DistributedVector &,
                                              const DistributedVector &,
                                              const double)>;

    /// Solve the step of @p problem by repeated calls of @p solve, which change
    /// @p u and @p contact. Throws ExcMessage. Collective.
    ContactReport
    solve(const StepProblem<dim>  &problem,
          const DistributedVector &right_side,
          const double             tolerance,
          const Solve             &solve,
          DistributedVector       &u,
          ContactState            &contact) const;

  private:
    /// Whether contact can balance the loads of a problem, with the pressure
    /// that is to be found, or within given bounds. Collective.
    Statics
    statics(const StepProblem<dim>    &problem,
            const std::vector<double> &bounds,
            const bool                 with_pressure) const;

    /// The body and its loads as statics sees them. Collective.
    HeldBody
    held_body(const StepProblem<dim> &problem) const;

    /// Whether neither loads nor a foundation do work on a rigid motion, and
    /// old contact forces were rounding. Collective.
    bool
    rests(const StepProblem<dim>  &problem,
          const HeldBody          &body,
          const DistributedVector &right_side) const;

    /// What springs hold after a solve: their energy norm, that of the
    /// solution, and whether it is no more than the loads balance.
    struct Held
    {
      double in_springs, size;
      bool   in_balance;
    };

    /// Add what they hold of @p change, the last one of @p u, to the error of
    /// @p report; @p whole: how far the body was before. Collective.
    Held
    measure(const StepProblem<dim>  &problem,
            const DistributedVector &right_side,
            const double             tolerance,
            const DistributedVector &u,
            const DistributedVector &change,
            const DistributedVector &whole,
            ContactReport           &report) const;

    /// Move u and the rest of the springs as a whole to where the loads are in
    /// balance with soft ground. Collective.
    void
    settle_whole(const StepProblem<dim>  &problem,
                 const HeldBody          &body,
                 const ContactState      &contact,
                 const DistributedVector &old_u,
                 DistributedVector       &center,
                 DistributedVector       &u) const;

    /// Why a body that still moves by @p change does not come to rest, as a
    /// sentence. Collective.
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

    /// How many times as far the springs' rest should go as the last solve has
    /// moved the body away from it, by what the last two have taught: the step
    /// of Barzilai & Borwein (IMA J. Numer. Anal. 8, 1988) for the minimum of
    /// the energy with springs, whose gradient is what they carry. With a
    /// single motion it is the rule of the secant. Collective.
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
    /// Where springs act: components of contact nodes, as many as motions, that
    /// constrain these; positions among the owned degrees of freedom.
    std::vector<unsigned int> supports;
    const DistributedMatrix  *singular_matrix = nullptr;
    DistributedMatrix         regular_matrix;
    DistributedVector         springs; // a diagonal matrix
    /// What rounding in the matrix leaves in the springs, relative to u.
    double rounding = 0.;
  };
} // namespace Viscoplastic
