// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/time_stepping/explicit_step.h>
#include <viscoplastic_contact/time_stepping/step_control.h>

#include <sstream>

namespace Viscoplastic
{
  template <int dim>
  void
  check_stability(const Parameters &parameters,
                  const FlowRate   &rate,
                  const TimeStep   &time_step)
  {
    if (is_stable(rate, time_step.k))
      return;
    std::ostringstream message;
    message << "the time step " << time_step.k
            << " exceeds the stability limit 2/r = "
            << 2. / rate.relaxation_rate << " of "
            << name_of(parameters.time.scheme)
            << ", which is that of the cell at x = (";
    for (unsigned int d = 0; d < dim; ++d)
      message << (d > 0 ? ", " : "") << rate.critical_position[d];
    message << "); take more steps in 'Time/Phases', or set 'Time/Stiffness "
               "policy' or 'Time/Scheme' = backward Euler.";
    throw StepBeyondStability(time_step.n, time_step.t, message.str());
  }



  template <int dim>
  ExplicitStep<dim>::ExplicitStep(const Discretization<dim> &discretization,
                                  TimerOutput               &timer)
    : discretization(discretization)
    , is_heun(discretization.scene().has_viscosity() &&
              discretization.scene().parameters.time.scheme == TimeScheme::heun)
    , timer(timer)
    , solver(discretization)
  {
    solver.set_matrix(discretization.matrix,
                      discretization.moduli.max_poissons_ratio());
  }



  template <int dim>
  StepSolution<dim>
  ExplicitStep<dim>::advance(const StepProblem<dim> &problem)
  {
    const Scene<dim>   &scene = discretization.scene();
    const TimeStep     &step  = problem.time_step;
    const State<dim>   &old   = problem.old.state;
    StepSolution<dim>   solution(problem);
    IrreversibleStress &z = solution.state.z, &history = solution.state.history;
    const auto          use = [&](const FlowRate &rate) {
      check_stability<dim>(scene.parameters, rate, step);
      solution.note(rate);
    };

    IrreversibleStress followed;
    const auto        &thermal = discretization.laws.thermal;
    if (thermal)
      {
        followed = old.z;
        thermal->follow(old.t, step.t, followed);
      }
    // z at the end of the step without any flow.
    const IrreversibleStress &carried = thermal ? followed : old.z;
    if (!scene.has_viscosity())
      z = carried;
    else
      {
        // (3.19): z_n = z_{n-1} + k G(t_{n-1}, sigma_{n-1}, eps_{n-1}).
        TimerOutput::Scope phase(timer, "rate");
        use(*problem.old_rate);
        z.reserve(carried.size());
        for (std::size_t i = 0; i < carried.size(); ++i)
          z.push_back(carried[i] + step.k * problem.old_rate->rate[i]);
        for (std::size_t i = 0; i < history.size(); ++i)
          history[i] += step.k * problem.old_rate->history_rate[i];
      }
    solve(problem, old, solution);
    if (is_heun)
      {
        // z_{n-1} + k (G_{n-1} + G*)/2 with G* at the state just predicted.
        const State<dim> predicted = solution.state;
        {
          TimerOutput::Scope phase(timer, "rate");
          const FlowRate     end =
            solution.is_unchanged && discretization.laws.are_autonomous() ?
                  *problem.old_rate :
                  evaluate_flow(discretization.laws,
                            predicted,
                            step.t,
                            ExactSolution<dim>::Side::before);
          use(end);
          for (std::size_t i = 0; i < z.size(); ++i)
            z[i] = 0.5 * (carried[i] + predicted.z[i] + step.k * end.rate[i]);
          for (std::size_t i = 0; i < history.size(); ++i)
            history[i] = 0.5 * (old.history[i] + predicted.history[i] +
                                step.k * end.history_rate[i]);
        }
        solve(problem, predicted, solution);
      }
    return solution;
  }



  template <int dim>
  StepSolution<dim>
  ExplicitStep<dim>::equilibrate(const StepProblem<dim> &problem)
  {
    StepSolution<dim> solution(problem);
    solution.state.z = problem.old.state.z;
    solve(problem, problem.old.state, solution);
    return solution;
  }



  template <int dim>
  bool
  ExplicitStep<dim>::nothing_has_changed(const StepProblem<dim> &problem,
                                         const State<dim>       &state) const
  {
    if (!problem.data_are_unchanged)
      return false;
    // z is the same if rates vanish, or are below rounding, and temperatures
    // stay constant.
    return !discretization.scene().has_irreversible_stress() ||
           Utilities::MPI::min(state.z == problem.old.state.z &&
                                   state.history == problem.old.state.history ?
                                 1 :
                                 0,
                               discretization.space.communicator) == 1;
  }



  template <int dim>
  void
  ExplicitStep<dim>::solve(const StepProblem<dim> &problem,
                           const State<dim>       &guess,
                           StepSolution<dim>      &solution)
  {
    TimerOutput::Scope         phase(timer, "contact");
    const Discretization<dim> &d     = discretization;
    State<dim>                &state = solution.state;
    // A body does not move unless its data or its z change.
    if (nothing_has_changed(problem, state))
      {
        // The report may contain a solve of Heun's predictor.
        const ContactReport earlier = solution.report;
        solution.stay(problem, d.space, d.face.get());
        solution.irreversible = problem.old.forces.irreversible;
        solution.report.add_earlier(earlier);
        solution.is_unchanged = earlier.linear_iterations == 0;
        return;
      }
    solution.is_unchanged = false;
    DistributedVector right_side(problem.load.values);
    if (d.scene().has_irreversible_stress()) // collective, also without cells
      {
        solution.irreversible = irreversible_forces(d.stress_space, state.z);
        right_side -= solution.irreversible;
      }

    // (3.20): u_n for the z_n that (3.19) has given.
    DistributedVector u = solver.initial_guess(problem, guess, state.contact);
    ContactReport     report =
      solver.solve(problem, right_side, problem.tolerance, u, state.contact);
    report.add_earlier(solution.report);
    solution.report = report;
    solver.set_displacement(problem, u, state);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ExplicitStep);
  VISCOPLASTIC_INSTANTIATE(check_stability);
} // namespace Viscoplastic
