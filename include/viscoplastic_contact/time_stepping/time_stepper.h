// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/error/quantity_estimator.h>
#include <viscoplastic_contact/time_stepping/step_control.h>
#include <viscoplastic_contact/time_stepping/step_method.h>
#include <viscoplastic_contact/time_stepping/step_solver.h>

namespace Viscoplastic
{
  template <int dim>
  struct AcceptedStep : public StepOutcome
  {
    TimeStep            time_step;
    EvaluatedState<dim> end;
    /// The number of longer steps that were tried and rejected.
    unsigned int n_rejections = 0;

    /// k r, the step size times the relaxation rate: explicit steps are stable
    /// up to 2.
    double
    stiffness() const
    {
      return 2. * time_step.k / step_limit;
    }

    /// The time to which r belongs: the rate of an explicit step is that of its
    /// beginning.
    double
    time_of_rate() const
    {
      return is_implicit ? time_step.t : time_step.t_old;
    }
  };



  /// What a TimeStepper has kept of steps before the last one, so that a run
  /// that goes on from a checkpoint goes on bit by bit.
  template <int dim>
  struct StepperMemory
  {
    /// Preconditioner states: of the solver of steps, of a(.,.), and of the
    /// tangents of a quantity; absent where there is nothing to remember.
    std::array<std::optional<PreconditionerState>, 3> preconditioners;
    typename QuantityEstimator<dim>::Memory           quantity;
  };



  /// Makes the steps of a run on one mesh: proposes a step, tries it, judges
  /// it, and tries a shorter one until one will do. A step that is tried
  /// changes neither the state that it starts from nor anything here; what it
  /// leaves in an iterative linear solver is undone when it is rejected.
  template <int dim>
  class TimeStepper
  {
  public:
    /// All arguments stay in use. @p error_estimator is null if there is none.
    TimeStepper(const Discretization<dim> &discretization,
                const ErrorEstimator<dim> *error_estimator,
                StepControl               &control,
                TimerOutput               &timer);

    /// The next step from a state. Throws StepFailure if none will do.
    /// Collective.
    AcceptedStep<dim>
    next(const EvaluatedState<dim> &accepted);

    /// A step of given size, not judged yet. @p old_rate is G at the start, or
    /// null where needs_rate() is false. Throws StepFailure. Collective.
    AcceptedStep<dim>
    try_step(const EvaluatedState<dim> &accepted,
             const FlowRate            *old_rate,
             const TimeStep            &time_step);

    /// Bring an initial state into equilibrium with the loads at t = 0; its
    /// forces are those of the equilibrium then. Collective.
    ContactReport
    equilibrate(EvaluatedState<dim> &initial);

    /// Bring a state that came from another mesh into equilibrium with the
    /// loads at its time; points with friction stay where they are, and the
    /// next step lets them slip. A displacement that is only interpolated would
    /// flow, and store energy, by stresses that nothing balances. Collective.
    void
    settle(EvaluatedState<dim> &carried);

    /// Complete the space estimate of a state. Collective.
    void
    estimate(EvaluatedState<dim> &evaluated) const;

    /// The quantity of interest of initial data in equilibrium, and its error;
    /// turns the indicators into those of the quantity. Collective.
    void
    estimate_quantity(EvaluatedState<dim> &initial);

    /// The part of a checkpoint beside the accepted state. Collective.
    StepperMemory<dim>
    memory() const;

    /// Go on from an accepted state on this mesh as the stepper did that had
    /// this memory there. Collective. Throws ExcMessage.
    void
    restore(const EvaluatedState<dim> &accepted,
            const StepperMemory<dim>  &memory);

    /// Whether steps of this scene ask for G at the state that they start from.
    bool
    needs_rate() const
    {
      return scene.has_viscosity() &&
             (!scene.is_implicit() || error_estimator != nullptr);
    }

    /// The error at which the iterations of a step from a state stop, relative
    /// to the solution.
    double
    tolerance(const EvaluatedState<dim> &accepted) const
    {
      return error_estimator ? error_estimator->tolerance(accepted.errors) :
                               solver_parameters.strict_tolerance();
    }

    StepMethod<dim> &
    method()
    {
      return *step_method;
    }

    const StepMethod<dim> &
    method() const
    {
      return *step_method;
    }

  private:
    /// What a step is judged by; its errors are known then. Throws StepFailure.
    StepErrors
    assess(const EvaluatedState<dim> &accepted,
           const FlowRate            *old_rate,
           AcceptedStep<dim>         &step);

    /// Make the space estimate of the end of a step, or take that of the state
    /// before times @p growth. Throws StepFailure. Collective.
    void
    estimate_step(const EvaluatedState<dim>   &accepted,
                  const std::optional<double> &growth,
                  AcceptedStep<dim>           &step) const;

    /// The energy norm at the end of a step over that before it, in which
    /// proportion its space estimate is that of the state before: of states
    /// that have hardly moved since one has been made. The time errors of the
    /// step are known. Collective.
    std::optional<double>
    growth_since_estimate(const EvaluatedState<dim> &accepted,
                          EvaluatedState<dim>       &end) const;

    /// The data of a step. Collective.
    StepProblem<dim>
    make_problem(const EvaluatedState<dim> &accepted,
                 const FlowRate            *old_rate,
                 const TimeStep            &time_step) const;

    /// The solver for the matrix of a(.,.). Collective.
    StepSolver<dim> &
    solver_of_elasticity();

    /// The solver of a tangent; @p is_new: another one than last. Collective.
    BulkSolver &
    solver_of(const TangentMatrix<dim> &tangent, const bool is_new);

    const Discretization<dim> &discretization;
    const Scene<dim>          &scene;
    const SolverParameters    &solver_parameters;
    const ErrorEstimator<dim> *error_estimator;
    StepControl               &control;
    TimerOutput               &timer;
    /// The estimator; null where a scene asks for no estimate.
    std::unique_ptr<SpaceEstimator<dim>> space_estimator;
    /// Whether no load that it looks at depends on time.
    const bool                       estimate_is_of_state_alone;
    std::unique_ptr<StepMethod<dim>> step_method;
    /// Null where a scene asks for no quantity.
    std::unique_ptr<QuantityEstimator<dim>> quantity_estimator;
    /// Of a(.,.) where steps have other matrices; made when it is needed.
    std::unique_ptr<StepSolver<dim>> elastic_solver;
    /// The solver of the tangents of a quantity's dual problem.
    std::unique_ptr<StepSolver<dim>> tangent_solver;
  };
} // namespace Viscoplastic
