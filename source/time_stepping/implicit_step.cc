// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/time_stepping/implicit_step.h>

namespace Viscoplastic
{
  template <int dim>
  ImplicitStep<dim>::ImplicitStep(const Discretization<dim> &discretization,
                                  TimerOutput               &timer,
                                  const bool                 takes_all_steps)
    : discretization(discretization)
    , timer(timer)
    , takes_all_steps(takes_all_steps)
    , tangent(discretization.laws, discretization.matrix)
    , solver(discretization)
  {}



  template <int dim>
  std::optional<StepSolution<dim>>
  ImplicitStep<dim>::rest(const StepProblem<dim> &problem) const
  {
    const Discretization<dim> &d   = discretization;
    const State<dim>          &old = problem.old.state;
    // Bodies with constant tangents flow under any stress, so that the test
    // would be in vain. A source on one side of t is not that of the step.
    if (!problem.data_are_unchanged || tangent.is_constant ||
        d.laws.source_solution)
      return {};
    if (d.laws.thermal && d.laws.thermal->changes(old.t, problem.time_step.t))
      return {};
    const auto is_zero = [&](const FlowRate &rate) {
      bool all_zero = true;
      for (const IrreversibleStress *field : {&rate.rate, &rate.history_rate})
        all_zero = all_zero &&
                   std::all_of(field->begin(), field->end(), [](const auto &G) {
                     return G == SymmetricTensor<2, 3>();
                   });
      return Utilities::MPI::min(all_zero ? 1 : 0, d.space.communicator) == 1;
    };
    StepSolution<dim> solution(problem);
    if (problem.old_rate != nullptr && d.laws.are_autonomous())
      solution.end_rate = *problem.old_rate;
    else
      {
        TimerOutput::Scope phase(timer, "rate");
        solution.end_rate = evaluate_flow(d.laws, old, problem.time_step.t);
      }
    if (!is_zero(*solution.end_rate))
      return {};
    solution.state.z = old.z;
    solution.stay(problem, d.space, d.face.get());
    solution.is_implicit = true;
    solution.note(*solution.end_rate);
    return solution;
  }



  template <int dim>
  StepSolution<dim>
  ImplicitStep<dim>::equilibrate(const StepProblem<dim> &problem)
  {
    // z is given: nothing flows.
    solver.set_matrix(discretization.matrix,
                      discretization.moduli.max_poissons_ratio());
    StepSolution<dim> solution(problem);
    State<dim>       &state = solution.state;
    state.z                 = problem.old.state.z;
    DistributedVector right_side(problem.load.values);
    add_irreversible_load(discretization.stress_space, state.z, right_side);
    DistributedVector u =
      solver.initial_guess(problem, problem.old.state, state.contact);
    solution.report =
      solver.solve(problem, right_side, problem.tolerance, u, state.contact);
    solver.set_displacement(problem, u, state);
    return solution;
  }



  template <int dim>
  void
  ImplicitStep<dim>::linearize(const DistributedVector              &ghosted_u,
                               const IrreversibleStress             &z,
                               const typename FlowLaws<dim>::AtTime &laws,
                               const double                          k)
  {
    TimerOutput::Scope phase(timer, "tangent");
    const bool         is_new = tangent.linearize(ghosted_u, z, laws, k);
    // A preconditioner that has adapted to earlier solves is not a function of
    // the arguments. Keep it from step to step only for constant tangents, and
    // if no steps of other schemes are in between.
    const bool stays = tangent.is_constant && takes_all_steps;
    if (is_new || !solver.is_ready() || !(stays || solver.bulk().is_exact()))
      solver.set_matrix(tangent.matrix(), tangent.max_poissons_ratio());
  }



  template <int dim>
  std::optional<PreconditionerState>
  ImplicitStep<dim>::preconditioner_state() const
  {
    // If each step makes its own matrix, there is nothing to keep.
    if (!solver.is_ready() || !tangent.is_constant || !takes_all_steps)
      return {};
    return solver.bulk().preconditioner_state();
  }



  template <int dim>
  void
  ImplicitStep<dim>::restore(
    const EvaluatedState<dim>                &accepted,
    const std::optional<PreconditionerState> &preconditioner)
  {
    if (!tangent.is_constant)
      return;
    if (preconditioner)
      {
        const State<dim> &state = accepted.state;
        linearize(state.u,
                  state.z,
                  discretization.laws.at(state.t, state.history),
                  state.k);
        solver.bulk().restore(preconditioner);
      }
    // An exact solver has no such state and keeps its last factor.
    else if (solver.is_ready() && !solver.bulk().is_exact())
      solver.clear();
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ImplicitStep);
} // namespace Viscoplastic
