// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/tangent_matrix.h>
#include <viscoplastic_contact/time_stepping/step_method.h>
#include <viscoplastic_contact/time_stepping/step_solver.h>

namespace Viscoplastic
{
  /// Backward Euler: z_n = z_{n-1} + k G(t_n, sigma_n, eps_n) and (3.20)
  /// together, by Newton's method for the bulk around the contact solver. In
  /// each iteration, z(eps) is replaced by its tangent C at the strain of an
  /// iterate m, or by an earlier one if that does as well, and friction is
  /// solved with that matrix:
  ///
  ///     a(u, v) + (z_m + C (eps(u) - eps(u_m)), eps(v)) + friction = L(v).
  ///
  /// With a potential this is a convex minimization, J(u) -> min, and a step
  /// along d = u - u_m that overshoots is shortened to where J' d = 0, so that
  /// J always decreases. Without a potential, the same rule looks for a zero of
  /// the residual along d.
  ///
  /// The iteration ends when (u, z(eps(u))) satisfies the equations to the
  /// contact tolerance: the linearization error dz is a residual whose dual
  /// norm is at most the norm of dz.
  template <int dim>
  class ImplicitStep : public StepMethod<dim>
  {
  public:
    /// @p takes_all_steps: whether all steps use this method. Then constant
    /// tangents and the state of their linear solver are kept from step to
    /// step.
    ImplicitStep(const Discretization<dim> &discretization,
                 TimerOutput               &timer,
                 const bool                 takes_all_steps = true);

    StepSolution<dim>
    advance(const StepProblem<dim> &problem) override;

    StepSolution<dim>
    equilibrate(const StepProblem<dim> &problem) override;

    StepSolver<dim> *
    elastic_solver() override
    {
      return nullptr;
    }

    std::optional<PreconditionerState>
    preconditioner_state() const override;

    void
    restore(const EvaluatedState<dim>                &accepted,
            const std::optional<PreconditionerState> &preconditioner) override;

    std::string
    solver_name() const override
    {
      return solver.is_ready() ? solver.bulk().name() : "";
    }

  private:
    class Newton;

    /// Return the old state as the solution if no datum changes and nothing
    /// flows; otherwise nothing. Collective.
    std::optional<StepSolution<dim>>
    rest(const StepProblem<dim> &problem) const;

    /// Set up tangents, matrix and solver at the strains of @p ghosted_u and @p
    /// z; the result depends on no earlier step.
    void
    linearize(const DistributedVector              &ghosted_u,
              const IrreversibleStress             &z,
              const typename FlowLaws<dim>::AtTime &laws,
              const double                          k);

    const Discretization<dim> &discretization;
    TimerOutput               &timer;
    const bool                 takes_all_steps;
    TangentMatrix<dim>         tangent;
    StepSolver<dim>            solver;
  };
} // namespace Viscoplastic
