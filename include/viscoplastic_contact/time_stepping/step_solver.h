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

    /// Solve with @p matrix from now on, which stays in use. @p
    /// max_poissons_ratio: of the material that it stands for. Collective.
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

    /// Solve from @p u and @p contact, which take the solution up.
    /// @p right_side is the load of the problem less what does not depend on u;
    /// @p tolerance is relative. Where Coulomb's law takes the pressure of the
    /// step itself, it is solved with the step (CoulombLaw), or the fixed point
    /// p of p -> p(rho = mu p) is found by solving again, as the scene says.
    /// Throws ExcMessage. Collective.
    ContactReport
    solve(const StepProblem<dim>  &problem,
          const DistributedVector &right_side,
          const double             tolerance,
          DistributedVector       &u,
          ContactState            &contact);

    /// Move @p u, in frames, into equilibrium with @p right_side while all
    /// points with friction, and those that touch an obstacle, stay where they
    /// are. One linear solve to the
    /// relative error @p tolerance. Throws ExcMessage. Collective.
    void
    solve_with_held_friction(const DistributedVector &right_side,
                             const double             tolerance,
                             ContactState             contact,
                             DistributedVector       &u);

    /// Displacement and velocity of the end of a step from u in frames.
    void
    set_displacement(const StepProblem<dim>  &problem,
                     const DistributedVector &u,
                     State<dim>              &state) const;

  private:
    /// The vectors to which the solution of a solve is proportional.
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
    /// Newton's method. Where its linear systems make it doubtful that there is
    /// one solution, other starts are tried, and the report says so.
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

    /// Count what rounding of residuals may leave of the error of a solution
    /// @p u of this @p size with contact, where that is more than the
    /// tolerance: as dear as some solves, so it is asked for only where
    /// stiffness differs much within the body. Throws ExcMessage where it
    /// leaves no solution. Collective.
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
