// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/time_stepping/step_method.h>
#include <viscoplastic_contact/time_stepping/step_solver.h>

namespace Viscoplastic
{
  /// Forward Euler, the scheme (3.18)-(3.20) of the paper, and Heun's method:
  /// z_n follows from G at known states, then u_n from (3.20). The matrix is
  /// that of a(.,.), so that one solver serves all steps on a mesh. Elastic
  /// bodies use this method, too.
  template <int dim>
  class ExplicitStep : public StepMethod<dim>
  {
  public:
    ExplicitStep(const Discretization<dim> &discretization, TimerOutput &timer);

    StepSolution<dim>
    advance(const StepProblem<dim> &problem) override;

    StepSolution<dim>
    equilibrate(const StepProblem<dim> &problem) override;

    StepSolver<dim> *
    elastic_solver() override
    {
      return &solver;
    }

    std::optional<PreconditionerState>
    preconditioner_state() const override
    {
      return solver.bulk().preconditioner_state();
    }

    void
    restore(const EvaluatedState<dim> & /*accepted*/,
            const std::optional<PreconditionerState> &preconditioner) override
    {
      if (!solver.bulk().is_exact())
        solver.bulk().restore(preconditioner);
    }

    std::string
    solver_name() const override
    {
      return solver.bulk().name();
    }

  private:
    /// Solve (3.20) with the z of @p solution for its u, active sets and
    /// report, starting from the velocity and sets of @p guess.
    void
    solve(const StepProblem<dim> &problem,
          const State<dim>       &guess,
          StepSolution<dim>      &solution);

    /// Whether the body has the same data, the same z and the same history as
    /// in the state before. Collective.
    bool
    nothing_has_changed(const StepProblem<dim> &problem,
                        const State<dim>       &state) const;

    const Discretization<dim> &discretization;
    const bool                 is_heun;
    TimerOutput               &timer;
    StepSolver<dim>            solver;
  };



  /// Throws StepBeyondStability if a step from a state with this G is longer
  /// than 2/r, the stability limit of explicit schemes.
  template <int dim>
  void
  check_stability(const Parameters &parameters,
                  const FlowRate   &rate,
                  const TimeStep   &time_step);

  /// Whether k <= 2/r up to rounding.
  inline bool
  is_stable(const FlowRate &rate, const double k)
  {
    return k * rate.relaxation_rate <= 2. * (1. + 1e-10);
  }
} // namespace Viscoplastic
