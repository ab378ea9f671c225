// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_solver.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver.h>
#include <viscoplastic_contact/time_stepping/proximal_springs.h>
#include <viscoplastic_contact/time_stepping/step_problem.h>

#include <memory>

namespace Viscoplastic
{
  /// Solves the variational inequality (3.20) of a step for u_n, the
  /// multipliers and the active sets, with the matrix of a(.,.) or of a
  /// tangent, whose linear solver it owns.
  template <int dim>
  class StepSolver
  {
  public:
    explicit StepSolver(const Discretization<dim> &discretization);

    /// Solve with @p matrix from now on, which is kept by reference. @p
    /// max_poissons_ratio: the largest one of the material. Collective.
    void
    set_matrix(const DistributedMatrix &matrix,
               const double             max_poissons_ratio);

    void
    clear()
    {
      bulk_solver.reset();
    }

    bool
    is_ready() const
    {
      return bulk_solver != nullptr;
    }

    BulkSolver &
    bulk()
    {
      return *bulk_solver;
    }

    const BulkSolver &
    bulk() const
    {
      return *bulk_solver;
    }

    /// The initial guess: u in nodal frames, extrapolated from the last
    /// displacement with the velocity of @p guess, and the active sets of @p
    /// guess in @p contact.
    DistributedVector
    initial_guess(const StepProblem<dim> &problem,
                  const State<dim>       &guess,
                  ContactState           &contact) const;

    /// Solve the step from @p u and @p contact, which are set to the solution.
    /// @p right_side is the load of the problem minus internal forces that do
    /// not depend on u; @p tolerance is relative. Coulomb's law with the
    /// pressure of the step itself is solved within the step (CoulombLaw), or
    /// by a fixed-point iteration of p -> p(rho = mu p), as the scene says.
    /// Throws ExcMessage. Collective.
    ContactReport
    solve(const StepProblem<dim>  &problem,
          const DistributedVector &right_side,
          const double             tolerance,
          DistributedVector       &u,
          ContactState            &contact);

    /// Move @p u, in nodal frames, into equilibrium with @p right_side, while
    /// all points with friction and those that touch an obstacle stay in place.
    /// One linear solve to the relative error @p tolerance. Throws ExcMessage.
    /// Collective.
    void
    solve_with_held_friction(const DistributedVector &right_side,
                             const double             tolerance,
                             ContactState             contact,
                             DistributedVector       &u);

    /// Set displacement and velocity of @p state from u in nodal frames.
    void
    set_displacement(const StepProblem<dim>  &problem,
                     const DistributedVector &u,
                     State<dim>              &state) const;

  private:
    /// The data of a solve, which give the scale of its solution.
    struct Data
    {
      const DistributedVector &old_u, &load, &right_side;
      const Vector<double>    &foundation_step; // on the face
    };

    /// solve() by a fixed point iteration of solves with given bounds, for
    /// Coulomb's law with the pressure of the step itself.
    ContactReport
    find_fixed_point(const StepProblem<dim>  &problem,
                     const DistributedVector &right_side,
                     const double             tolerance,
                     DistributedVector       &u,
                     ContactState            &contact);

    /// A bound on the rounding error of the sum of the friction bounds that
    /// follow from the pressures of @p u. Collective.
    double
    rounding_of_bounds(const StepProblem<dim>  &problem,
                       const DistributedVector &right_side,
                       DistributedVector       &u);

    /// solve() with Coulomb's law of the pressure of the step itself, by
    /// Newton's method. If its linear systems cast doubt on uniqueness, other
    /// starts are tried, and the report tells what they have found.
    ContactReport
    solve_with_own_pressure(const StepProblem<dim>  &problem,
                            const DistributedVector &right_side,
                            const double             tolerance,
                            DistributedVector       &u,
                            ContactState            &contact);

    /// solve() with the bounds of @p contact, or with a law that gives them.
    ContactReport
    solve_with_bounds(const StepProblem<dim>  &problem,
                      const DistributedVector &right_side,
                      const double             tolerance,
                      DistributedVector       &u,
                      ContactState            &contact,
                      const CoulombLaw        *law = nullptr);

    /// solve() with a regular matrix, for a displacement @p old_u of the step
    /// before.
    ContactReport
    solve_regular(const StepProblem<dim>  &problem,
                  const DistributedVector &old_u,
                  const DistributedVector &right_side,
                  const double             tolerance,
                  DistributedVector       &u,
                  ContactState            &contact,
                  const CoulombLaw        *law);

    /// Add the error that rounding of residuals may cause in a solution @p u of
    /// this @p size with contact to @p report, if it is above the tolerance. It
    /// costs as much as a few solves, so it is computed only if stiffness
    /// varies much within the body. Throws ExcMessage if rounding is too large.
    /// Collective.
    void
    add_rounding(const Data        &data,
                 DistributedVector &u,
                 const double       size,
                 ContactReport     &report);

    /// The loads and stresses of the data in the dual norm of the diagonal.
    /// Collective.
    double
    load_size(const Data &data) const;

    /// The data and @p u in the norm of the diagonal, loads in its dual.
    /// Collective.
    double
    size_of(const Data &data, const DistributedVector &u) const;

    const Discretization<dim>  &discretization;
    const ContactSolver         contact_solver;
    std::unique_ptr<BulkSolver> bulk_solver;
    DistributedVector           diagonal; // of the matrix
    /// Where only contact prevents a rigid motion; otherwise null.
    std::unique_ptr<ProximalSprings<dim>> springs;
  };
} // namespace Viscoplastic
