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



  /// What a TimeStepper keeps of steps before the last one, so that a run that
  /// is resumed from a checkpoint gives the same bits.
  template <int dim>
  struct StepperMemory
  {
    /// Preconditioner states: of the solver of steps, of a(.,.), and of the
    /// tangents of a quantity; absent where there is nothing to remember.
    std::array<std::optional<PreconditionerState>, 3> preconditioners;
    typename QuantityEstimator<dim>::Memory           quantity;
  };



  /// Makes the steps of a run on one mesh: proposes a step, solves it,
  /// estimates its error, and tries shorter ones until one is accepted. A trial
  /// changes neither the state that it starts from nor the stepper; changes of
  /// an iterative linear solver are undone if it is rejected.
  template <int dim>
  class TimeStepper
  {
  public:
    /// Keeps references to all arguments. @p error_estimator may be null.
    TimeStepper(const Discretization<dim> &discretization,
                const ErrorEstimator<dim> *error_estimator,
                StepControl               &control,
                TimerOutput               &timer);

    /// Make the next step from a state. Throws StepFailure if none is accepted.
    /// Collective.
    AcceptedStep<dim>
    next(const EvaluatedState<dim> &accepted);

    /// Make a step of given size without estimating its error. @p old_rate is G
    /// at the start, or null where needs_rate() is false. Throws StepFailure.
    /// Collective.
    AcceptedStep<dim>
    try_step(const EvaluatedState<dim> &accepted,
             const FlowRate            *old_rate,
             const TimeStep            &time_step);

    /// Bring an initial state into equilibrium with the loads at t = 0, and set
    /// its forces and its report. Collective.
    void
    equilibrate(EvaluatedState<dim> &initial);

    /// Bring a state that came from another mesh into equilibrium with the
    /// loads at its time; points with friction stay where they are, and the
    /// next step lets them slip. Without this, the unbalanced stresses of an
    /// interpolated displacement would cause flow and store energy. Collective.
    void
    settle(EvaluatedState<dim> &carried);

    /// Complete the space estimate of a state. Collective.
    void
    estimate(EvaluatedState<dim> &evaluated) const;

    /// The quantity of interest of initial data in equilibrium, and its error;
    /// turns the indicators into those of the quantity. Collective.
    void
    estimate_quantity(EvaluatedState<dim> &initial);

    /// The part of a checkpoint besides the accepted state. Collective.
    StepperMemory<dim>
    memory() const;

    /// Restore the stepper as it was at the state @p accepted on this mesh,
    /// when it had this memory. Collective. Throws ExcMessage.
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
    /// Return the errors that decide whether a step is accepted, and set those
    /// of its end state. Throws StepFailure.
    StepErrors
    assess(const EvaluatedState<dim> &accepted,
           const FlowRate            *old_rate,
           AcceptedStep<dim>         &step);

    /// Compute the space estimate of the end of a step, or take that of the
    /// state before times @p growth. Throws StepFailure. Collective.
    void
    estimate_step(const EvaluatedState<dim>   &accepted,
                  const std::optional<double> &growth,
                  AcceptedStep<dim>           &step) const;

    /// The ratio of the energy norms at the end of a step and before it, by
    /// which the old space estimate is scaled if the state has hardly moved
    /// since an estimate was computed; otherwise nothing. The time errors of
    /// the step must be set. Collective.
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

    /// The solver of a tangent; @p is_new: whether it has changed. Collective.
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
    /// Whether no load or bound in the space estimate depends on time.
    const bool                       estimate_is_of_state_alone;
    std::unique_ptr<StepMethod<dim>> step_method;
    /// Null where a scene asks for no quantity.
    std::unique_ptr<QuantityEstimator<dim>> quantity_estimator;
    /// The solver of a(.,.) where steps have other matrices; made on demand.
    std::unique_ptr<StepSolver<dim>> elastic_solver;
    /// The solver of the tangents of a quantity's dual problem.
    std::unique_ptr<StepSolver<dim>> tangent_solver;
  };
} // namespace Viscoplastic
