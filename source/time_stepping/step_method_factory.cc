// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/time_stepping/explicit_step.h>
#include <viscoplastic_contact/time_stepping/implicit_step.h>
#include <viscoplastic_contact/time_stepping/step_control.h>

namespace Viscoplastic
{
  namespace
  {
    /// Explicit steps up to the stability limit 2/r, implicit ones beyond it.
    template <int dim>
    class ExplicitUpToTheLimit : public StepMethod<dim>
    {
    public:
      ExplicitUpToTheLimit(const Discretization<dim> &discretization,
                           TimerOutput               &timer)
        : explicit_step(discretization, timer)
        , implicit_step(discretization, timer, /* takes_all_steps = */ false)
      {}

      StepSolution<dim>
      advance(const StepProblem<dim> &problem) override
      {
        if (is_stable(*problem.old_rate, problem.time_step.k))
          try
            {
              return explicit_step.advance(problem);
            }
          catch (const StepBeyondStability &)
            {
              // Heun's method checks the end of the step, too.
            }
        return implicit_step.advance(problem);
      }

      StepSolution<dim>
      equilibrate(const StepProblem<dim> &problem) override
      {
        return explicit_step.equilibrate(problem);
      }

      StepSolver<dim> *
      elastic_solver() override
      {
        return explicit_step.elastic_solver();
      }

      // Implicit steps among explicit ones keep no preconditioner.
      std::optional<PreconditionerState>
      preconditioner_state() const override
      {
        return explicit_step.preconditioner_state();
      }

      void
      restore(const EvaluatedState<dim>                &accepted,
              const std::optional<PreconditionerState> &preconditioner) override
      {
        explicit_step.restore(accepted, preconditioner);
      }

      std::string
      solver_name() const override
      {
        return explicit_step.solver_name();
      }

    private:
      ExplicitStep<dim> explicit_step;
      ImplicitStep<dim> implicit_step;
    };
  } // namespace



  template <int dim>
  std::unique_ptr<StepMethod<dim>>
  make_step_method(const Discretization<dim> &discretization,
                   TimerOutput               &timer)
  {
    const Scene<dim> &scene = discretization.scene();
    if (scene.is_implicit())
      return std::make_unique<ImplicitStep<dim>>(discretization, timer);
    if (scene.is_implicit_beyond_the_limit())
      return std::make_unique<ExplicitUpToTheLimit<dim>>(discretization, timer);
    return std::make_unique<ExplicitStep<dim>>(discretization, timer);
  }



  VISCOPLASTIC_INSTANTIATE(make_step_method);
} // namespace Viscoplastic
