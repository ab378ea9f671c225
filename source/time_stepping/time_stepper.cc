// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/time_stepping/time_stepper.h>

namespace Viscoplastic
{
  template <int dim>
  TimeStepper<dim>::TimeStepper(const Discretization<dim> &discretization,
                                const ErrorEstimator<dim> *error_estimator,
                                StepControl               &control,
                                TimerOutput               &timer)
    : discretization(discretization)
    , scene(discretization.scene())
    , solver_parameters(scene.parameters.solver)
    , error_estimator(error_estimator)
    , control(control)
    , timer(timer)
    , space_estimator(SpaceEstimator<dim>::is_needed(scene) ?
                        std::make_unique<SpaceEstimator<dim>>(discretization) :
                        nullptr)
    , estimate_is_of_state_alone(scene.has_constant_loads_and_bounds() &&
                                 !scene.quantity)
    , step_method(make_step_method(discretization, timer))
    , quantity_estimator(scene.quantity ?
                           std::make_unique<QuantityEstimator<dim>>(
                             discretization,
                             *space_estimator,
                             [this](const TangentMatrix<dim> &tangent,
                                    const bool is_new) -> BulkSolver & {
                               return solver_of(tangent, is_new);
                             }) :
                           nullptr)
  {}



  namespace
  {
    /// Add the friction work of a step per area to that of the steps before.
    template <int dim>
    void
    add_friction_work(const Discretization<dim> &discretization,
                      const State<dim>          &old,
                      State<dim>                &state)
    {
      const ContactFace<dim> &face    = *discretization.face;
      const ContactState     &contact = state.contact;
      std::vector<double>     work(contact.n_points());
      for (const unsigned int p : face.layout().friction_points())
        if (face.weights()[p] > 0.)
          work[p] = contact.multiplier[p] * contact.slip[p] / face.weights()[p];
      state.friction_work = face.nodal_field(work);
      if (old.friction_work.size() > 0)
        for (std::size_t i = 0; i < discretization.space.relevant.n_elements();
             ++i)
          state.friction_work.begin()[i] += old.friction_work.begin()[i];
    }



    /// Whether any friction bound follows from the pressures of a state.
    /// Collective.
    template <int dim>
    bool
    has_computed_bounds(const Discretization<dim> &d,
                        const ContactState        &state,
                        const double               t,
                        const std::vector<double> &slip_rates)
    {
      std::vector<double> bounds(d.face->layout().points.size(), 0.);
      d.face->add_computed_bounds(t, state, bounds, slip_rates);
      return d.face->layout().any(
        std::any_of(bounds.begin(), bounds.end(), [](const double bound) {
          return bound > 0.;
        }));
    }
  } // namespace



  template <int dim>
  AcceptedStep<dim>
  TimeStepper<dim>::next(const EvaluatedState<dim> &accepted)
  {
    // This solver has served to settle the state on a new mesh.
    if (!quantity_estimator)
      elastic_solver.reset();
    const State<dim>       &state = accepted.state;
    std::optional<FlowRate> evaluated;
    const FlowRate         *rate = accepted.rate ? &*accepted.rate : nullptr;
    if (needs_rate() && rate == nullptr)
      {
        TimerOutput::Scope phase(timer, "rate");
        evaluated = as_part_of_step(state.n + 1, state.t, [&] {
          return evaluate_flow(discretization.laws, state, state.t);
        });
        rate      = &*evaluated;
      }
    // r is the constant of (2.8), or the larger of its parts.
    double limit = std::numeric_limits<double>::infinity();
    if (rate != nullptr && rate->relaxation_rate > 0. && !scene.is_implicit())
      limit = 2. / rate->relaxation_rate;

    const auto preconditioner = control.may_reject() ?
                                  step_method->preconditioner_state() :
                                  std::optional<PreconditionerState>();
    for (unsigned int n_rejections = 0;; ++n_rejections)
      {
        const TimeStep time_step = control.propose(state.n, state.t, limit);
        try
          {
            AcceptedStep<dim> step   = try_step(accepted, rate, time_step);
            const StepErrors  errors = assess(accepted, rate, step);
            const bool        has_event =
              control.is_on && discretization.face &&
              has_contact_event(discretization.face->layout(),
                                state.contact,
                                step.end.state.contact,
                                control.is_kink(time_step.t_old) ||
                                  !accepted.is_solution);
            if (control.accepts(time_step, errors, has_event))
              {
                step.n_rejections = n_rejections;
                if (discretization.face && scene.keeps_friction_work())
                  add_friction_work(discretization, state, step.end.state);
                return step;
              }
          }
        catch (const StepFailure &failure)
          {
            const bool for_stability =
              dynamic_cast<const StepBeyondStability *>(&failure) != nullptr;
            if (!control.retries(time_step, for_stability))
              throw;
          }
        step_method->restore(accepted, preconditioner);
      }
  }



  template <int dim>
  StepProblem<dim>
  TimeStepper<dim>::make_problem(const EvaluatedState<dim> &accepted,
                                 const FlowRate            *old_rate,
                                 const TimeStep            &time_step) const
  {
    TimerOutput::Scope         phase(timer, "load");
    const Discretization<dim> &d = discretization;
    StepProblem<dim>           problem{time_step,
                             d.loads.assemble(time_step.t),
                             {},
                             {},
                             tolerance(accepted),
                             solver_parameters,
                             accepted,
                             old_rate};
    if (d.face)
      {
        problem.foundation_step =
          d.face->foundation_step(time_step.t_old, time_step.t);
        DistributedVector u;
        if (d.face->has_obstacles())
          {
            u = d.space.owned_vector();
            d.space.to_frames(accepted.state.u, u);
            d.space.set_prescribed(time_step.t, u);
          }
        const State<dim> &state = accepted.state;
        problem.slip_rates =
          d.face->slip_rates(state.velocity, state.t - state.k, state.t);
        problem.bounds =
          d.face->step_bounds(time_step.t, u, problem.slip_rates);
        if (d.face->has_computed_pressure() &&
            solver_parameters.coulomb_pressure != CoulombPressure::lagged)
          {
            problem.bounds_follow_pressure = true;
            problem.given_bounds           = problem.bounds;
          }
        // Without an old pressure, the solve starts from stick; for a body that
        // only contact holds, from bounds_that_hold(), since a moving
        // foundation would carry off a body that nothing presses.
        const ContactState &old = accepted.state.contact;
        if (problem.bounds_follow_pressure && !d.space.is_held_by_contact() &&
            !has_computed_bounds(d, old, time_step.t, problem.slip_rates))
          {
            // Not where pieces meet: one may push where another one holds.
            ContactState         pressed(problem.bounds);
            const ContactLayout &face = d.face->layout();
            for (unsigned int p = 0; p < pressed.n_points(); ++p)
              if (face.has_plain_friction(face.points[p].node))
                pressed.multiplier[p][0] =
                  std::numeric_limits<double>::infinity();
            d.face->add_computed_bounds(time_step.t,
                                        pressed,
                                        problem.bounds,
                                        problem.slip_rates);
          }
        else
          d.face->add_computed_bounds(time_step.t,
                                      old,
                                      problem.bounds,
                                      problem.slip_rates);
      }
    return problem;
  }



  template <int dim>
  AcceptedStep<dim>
  TimeStepper<dim>::try_step(const EvaluatedState<dim> &accepted,
                             const FlowRate            *old_rate,
                             const TimeStep            &time_step)
  {
    StepProblem<dim>  problem  = make_problem(accepted, old_rate, time_step);
    StepSolution<dim> solution = as_part_of_step(time_step.n, time_step.t, [&] {
      problem.data_are_unchanged = data_are_unchanged(discretization, problem);
      return step_method->advance(problem);
    });

    TimerOutput::Scope phase(timer, "balance");
    AcceptedStep<dim>  step;
    static_cast<StepOutcome &>(step) = solution;
    step.time_step                   = time_step;
    step.end.state                   = std::move(solution.state);
    if (step.is_unchanged)
      {
        step.end.forces      = accepted.forces;
        step.end.forces.load = std::move(problem.load);
      }
    else
      step.end.forces = evaluate_forces(discretization.stress_space,
                                        discretization.matrix,
                                        std::move(problem.load),
                                        step.end.state,
                                        std::move(solution.irreversible));
    step.end.is_solution = true;
    step.end.report      = step.report;
    // G at the end of this step is that at the start of the next one.
    if (needs_rate() && solver_parameters.reuse_unchanged)
      {
        if (step.is_unchanged && discretization.laws.are_autonomous())
          step.end.rate = *old_rate;
        else if (!scene.has_source()) // which jumps between steps
          step.end.rate = std::move(solution.end_rate);
      }
    return step;
  }



  template <int dim>
  BulkSolver &
  TimeStepper<dim>::solver_of(const TangentMatrix<dim> &tangent,
                              const bool                is_new)
  {
    if (!tangent_solver)
      tangent_solver = std::make_unique<StepSolver<dim>>(discretization);
    if (is_new || !tangent_solver->is_ready())
      tangent_solver->set_matrix(tangent.matrix(),
                                 tangent.max_poissons_ratio());
    return tangent_solver->bulk();
  }



  template <int dim>
  StepperMemory<dim>
  TimeStepper<dim>::memory() const
  {
    StepperMemory<dim> result;
    result.preconditioners[0] = step_method->preconditioner_state();
    if (!quantity_estimator)
      return result;
    if (elastic_solver)
      result.preconditioners[1] = elastic_solver->bulk().preconditioner_state();
    if (tangent_solver)
      result.preconditioners[2] = tangent_solver->bulk().preconditioner_state();
    result.quantity = quantity_estimator->memory();
    return result;
  }



  template <int dim>
  void
  TimeStepper<dim>::restore(const EvaluatedState<dim> &accepted,
                            const StepperMemory<dim>  &memory)
  {
    const auto &[of_steps, elastic, of_tangents] = memory.preconditioners;
    step_method->restore(accepted, of_steps);
    if (elastic)
      solver_of_elasticity().bulk().restore(elastic);
    if (!quantity_estimator)
      return;
    quantity_estimator->restore(accepted.state, memory.quantity);
    if (tangent_solver)
      tangent_solver->bulk().restore(of_tangents);
  }



  template <int dim>
  StepSolver<dim> &
  TimeStepper<dim>::solver_of_elasticity()
  {
    if (StepSolver<dim> *of_steps = step_method->elastic_solver())
      return *of_steps;
    if (!elastic_solver)
      {
        elastic_solver = std::make_unique<StepSolver<dim>>(discretization);
        elastic_solver->set_matrix(discretization.matrix,
                                   discretization.moduli.max_poissons_ratio());
      }
    return *elastic_solver;
  }



  template <int dim>
  void
  TimeStepper<dim>::equilibrate(EvaluatedState<dim> &initial)
  {
    const Discretization<dim> &d = discretization;
    if (d.face)
      initial.state.contact = ContactState(d.face->bounds(0.));
    const StepProblem<dim> problem =
      make_problem(initial, nullptr, {0, 0., 0., 0.});
    initial.forces =
      evaluate_forces(d.stress_space, d.matrix, problem.load, initial.state);
    StepSolution<dim> solution = step_method->equilibrate(problem);
    initial.state.contact      = std::move(solution.state.contact);
    initial.state.velocity     = std::move(solution.state.velocity);
    initial.state.u            = std::move(solution.state.u);
    initial.state.initial_u    = initial.state.u;
    initial.is_solution        = true;
    initial.report             = solution.report;
    initial.forces =
      evaluate_forces(d.stress_space, d.matrix, problem.load, initial.state);
  }



  template <int dim>
  void
  TimeStepper<dim>::settle(EvaluatedState<dim> &carried)
  {
    const Discretization<dim> &d     = discretization;
    State<dim>                &state = carried.state;
    const Load<dim>            load  = d.loads.assemble(state.t);
    DistributedVector          right_side(load.values), u(load.values);
    if (scene.has_irreversible_stress())
      add_irreversible_load(d.stress_space, state.z, right_side);
    d.space.to_frames(state.u, u);
    d.space.set_prescribed(state.t, u);
    as_part_of_step(state.n + 1, state.t, [&] {
      solver_of_elasticity().solve_with_held_friction(right_side,
                                                      tolerance(carried),
                                                      state.contact,
                                                      u);
      return 0;
    });
    d.space.to_cartesian(u, state.u);
    carried.forces = evaluate_forces(d.stress_space, d.matrix, load, state);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(TimeStepper);
} // namespace Viscoplastic
