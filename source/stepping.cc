// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact_event.h>
#include <viscoplastic_contact/messages.h>
#include <viscoplastic_contact/viscoplastic_contact.h>

#include <cmath>
#include <limits>

namespace Viscoplastic
{
  template <int dim>
  TimeStep
  ViscoplasticContact<dim>::make_step()
  {
    const unsigned int every_n_steps = parameters.refinement.every_n_steps;
    if (scene.is_adaptive() && state.n > 0 && state.n % every_n_steps == 0)
      adapt_mesh();
    TimeStep time_step;
    Step     step = try_steps(time_step);
    if (error_bar)
      error_bar->accept(step.errors, step.state.t);
    record(state, step, time_step);
    state  = std::move(step.state);
    forces = std::move(step.forces);
    rate.reset();
    return time_step;
  }



  template <int dim>
  typename ViscoplasticContact<dim>::Step
  ViscoplasticContact<dim>::try_steps(TimeStep &time_step)
  {
    const bool        may_reject = control.may_reject();
    const SolverState before     = may_reject ? solver_state() : SolverState();
    for (unsigned int n_rejections = 0;; ++n_rejections)
      {
        double limit = std::numeric_limits<double>::infinity();
        if (control.needs_limit() && scene.has_viscosity() && !is_implicit())
          {
            TimerOutput::Scope phase(timer, "rate");
            if (const double r = accepted_rate().relaxation_rate; r > 0.)
              limit = 2. / r;
          }
        time_step = control.propose(state.n, state.t, limit);
        try
          {
            Step             step   = advance(state, forces, time_step);
            const StepErrors errors = assess(step);
            const bool       has_event =
              control.is_on && discretisation->face &&
              has_contact_event(step.bounds,
                                state.friction,
                                step.state.friction,
                                control.is_kink(time_step.t_old));
            if (control.accepts(time_step, errors, has_event))
              {
                step.n_rejections = n_rejections;
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
        restore(before);
      }
  }



  template <int dim>
  StepErrors
  ViscoplasticContact<dim>::assess(Step &step)
  {
    const double residual = estimate(step.state);
    if (!error_bar)
      return {};
    if (scene.has_viscosity())
      try
        {
          TimerOutput::Scope phase(timer, "rate");
          error_bar->evaluate_rate(discretisation->laws, state, step.state);
        }
      catch (const std::exception &exception)
        {
          // The step has gone where the law has no value.
          throw StepFailure(step.state.n, step.state.t, reason(exception));
        }
    TimerOutput::Scope phase(timer, "estimate");
    step.errors =
      error_bar->assess(discretisation->sampling,
                        time_defect(step.is_implicit ? "backward Euler" :
                                                       parameters.time.scheme),
                        state,
                        forces,
                        step.forces,
                        step.report,
                        residual,
                        step.state);
    const ErrorLedger &ledger = step.errors;
    StepErrors         errors;
    errors.indicator = ledger.time_indicator;
    errors.change =
      std::max(step.state.k * std::sqrt(std::max(0., ledger.velocity_square)),
               ledger.irreversible_change);
    errors.size = std::max(ledger.energy_norm, ledger.irreversible_norm);
    if (!std::isfinite(errors.indicator + errors.change + errors.size))
      throw StepFailure(step.state.n,
                        step.state.t,
                        "the solution is not finite.");
    return errors;
  }



  template <int dim>
  typename ViscoplasticContact<dim>::SolverState
  ViscoplasticContact<dim>::solver_state()
  {
    Discretisation &d = *discretisation;
    if (changes_scheme())
      d.use_solver_of_tangent(false);
    SolverState result{is_solved_on_mesh, {}};
    if (d.solver)
      result.memory = d.solver->memory();
    return result;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::restore(const SolverState &before)
  {
    Discretisation &d = *discretisation;
    is_solved_on_mesh = before.is_solved_on_mesh;
    if (changes_scheme())
      d.use_solver_of_tangent(false);
    // An exact solver has the factor of the last matrix, and no memory.
    if (!d.solver || d.solver->is_exact())
      return;
    if (is_implicit())
      {
        // Other tangents are taken in each step; constant ones depend on its
        // size.
        if (!d.tangent->is_constant)
          return;
        if (state.k == 0.)
          {
            d.solver.reset();
            return;
          }
        linearise(state.u, state.z, state.t, state.k);
      }
    d.solver->recall(before.memory);
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
