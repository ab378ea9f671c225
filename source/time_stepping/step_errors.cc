// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <limits>

// The errors by which a TimeStepper accepts or rejects a step.

namespace Viscoplastic
{
  namespace
  {
    /// The change of a state up to which its space estimate is scaled from an
    /// earlier one. Not round, since equal steps would make ties, which
    /// rounding breaks differently with the number of ranks.
    constexpr double largest_change = 0.0937;



    /// How much a state has ceased in a step to be in proportion to the state
    /// before: the distance of strain or stress from @p growth times those
    /// before, in their energy norms and relative to that, or a part of the
    /// growth, since bounds, gaps and initial stresses do not grow; and the
    /// share of contact points that begin or cease to stick or to touch.
    /// Infinite if strain or stress vanished before. Collective.
    template <int dim>
    double
    change_of_step(const Discretization<dim> &discretization,
                   const double               growth,
                   const EvaluatedState<dim> &accepted,
                   const EvaluatedState<dim> &end)
    {
      const State<dim>  &old = accepted.state, &state = end.state;
      const Forces<dim> &old_forces = accepted.forces, &forces = end.forces;
      // (dz, eps(du)), the number of points that change, and of all points.
      std::vector<double> sums(3, 0.);
      if (forces.irreversible.size() > 0)
        {
          const double *u = forces.u.begin(), *old_u = old_forces.u.begin(),
                       *z     = forces.irreversible.begin(),
                       *old_z = old_forces.irreversible.begin();
          for (unsigned int i = 0; i < forces.u.locally_owned_size(); ++i)
            sums[0] += (u[i] - old_u[i]) * (z[i] - old_z[i]);
        }
      for (unsigned int p = 0; p < state.contact.n_points(); ++p)
        if (const auto &point = discretization.face->layout().points[p];
            old.contact.holds(point, p) != state.contact.holds(point, p))
          ++sums[1];
      sums[2] = state.contact.n_points();
      Utilities::MPI::sum(sums, discretization.space.communicator, sums);
      // |b - g a|^2/|g a|^2 from the squares of b - a, a and b. Rounding may
      // make them negative.
      const auto distance =
        [&](const double change, const double before, const double after) {
          return before > 0. ?
                   (change + (1. - growth) * (after / growth - before)) /
                     (growth * before) :
                   std::numeric_limits<double>::infinity();
        };
      // |sigma|^2 = a(u, u) + 2 (z, eps(u)) + |z|^2.
      const auto square_of_stress = [](const Forces<dim> &of) {
        return 2. * (of.strain_energy + of.irreversible_work +
                     of.irreversible_energy);
      };
      const ErrorEstimate &errors = end.errors;
      const double         strain = state.k * state.k * errors.velocity_square,
                   stress =
                     strain + 2. * sums[0] +
                     errors.irreversible_change * errors.irreversible_change;
      // A quantity feels both more: its dual solution jumps with points.
      const bool   has_dual  = discretization.scene().quantity.has_value();
      const double of_growth = (has_dual ? 1. : 0.25) * (1. - 1. / growth),
                   of_points = has_dual ? 2. : 1.;
      return std::sqrt(std::max({of_growth * of_growth,
                                 distance(strain,
                                          2. * old_forces.strain_energy,
                                          2. * forces.strain_energy),
                                 distance(stress,
                                          square_of_stress(old_forces),
                                          square_of_stress(forces))})) +
             (sums[2] > 0. ? of_points * sums[1] / sums[2] : 0.);
    }



    /// The error in the friction work of a step that is due to bounds that
    /// change in it, since the work is that of the bounds at the end.
    /// Collective.
    double
    work_of_changed_bounds(const ContactLayout &face,
                           const ContactState  &before,
                           const ContactState  &after)
    {
      double work = 0.;
      for (const unsigned int p : face.friction_points())
        if (!after.sticks[p])
          work +=
            0.5 * (after.bound[p] - before.bound[p]) * after.slip[p].norm();
      return std::abs(face.sum(work));
    }



    /// slip_defects() of the step from @p accepted to @p end.
    template <int dim>
    SlipDefects
    slip_defects_of_step(const ContactFace<dim>    &face,
                         const EvaluatedState<dim> &accepted,
                         const EvaluatedState<dim> &end)
    {
      DistributedVector change = end.forces.u;
      change -= accepted.forces.u;
      return slip_defects(face.layout(),
                          accepted.state.contact,
                          end.state.contact,
                          face.slips(change, end.state.contact.foundation_step),
                          end.state.k,
                          accepted.state.k);
    }



    /// Turn errors in the energy norm into those of the quantity of interest,
    /// whose dual solution will reach at least the norm @p later_dual_norm.
    template <int dim>
    void
    make_errors_of_quantity(const Discretization<dim> &discretization,
                            const EvaluatedState<dim> &accepted,
                            const EvaluatedState<dim> &end,
                            const bool                 moves,
                            const double               later_dual_norm,
                            StepErrors                &errors)
    {
      const QuantityEstimate &quantity = end.errors.quantity,
                             &before   = accepted.errors.quantity;
      const bool is_sum = discretization.scene().quantity->is_sum();
      errors.indicator *=
        std::max(quantity.dual_norm, is_sum ? 0. : later_dual_norm);
      if (moves)
        errors.of_events = quantity.friction_indicator;
      if (is_sum && discretization.face)
        errors.of_events +=
          work_of_changed_bounds(discretization.face->layout(),
                                 accepted.state.contact,
                                 end.state.contact);
      // The body may move on while the quantity hardly changes, as after a
      // change of the mesh.
      const double share =
        errors.size > 0. ? std::min(1., errors.change / errors.size) : 0.;
      errors.size = std::abs(quantity.value);
      errors.change =
        std::max(std::abs(quantity.value - before.value), share * errors.size);
      errors.before = before.time + before.friction;
    }
  } // namespace



  template <int dim>
  StepErrors
  TimeStepper<dim>::assess(const EvaluatedState<dim> &accepted,
                           const FlowRate            *old_rate,
                           AcceptedStep<dim>         &step)
  {
    EvaluatedState<dim> &end   = step.end;
    const State<dim>    &state = end.state;
    if (error_estimator == nullptr)
      {
        if (space_estimator)
          {
            TimerOutput::Scope phase(timer, "estimate");
            estimate_step(accepted, {}, step);
          }
        return {};
      }
    std::optional<double> growth;
    {
      // Fields for this estimate are gone before the new rate takes memory.
      TimerOutput::Scope phase(timer, "estimate");
      error_estimator->assess_change(discretization.stress_space,
                                     accepted,
                                     end);
      // While little flows any more, single cells do, and a quantity feels it.
      if (!quantity_estimator || old_rate == nullptr ||
          !quantity_estimator->has_crept_on(accepted, *old_rate))
        growth = growth_since_estimate(accepted, end);
      estimate_step(accepted, growth, step);
    }
    if (scene.has_viscosity() && !end.rate)
      {
        TimerOutput::Scope phase(timer, "rate");
        end.rate = as_part_of_step(state.n, state.t, [&] {
          return evaluate_flow(discretization.laws, state, state.t);
        });
      }
    TimerOutput::Scope         phase(timer, "estimate");
    std::optional<SlipDefects> slip_defects;
    double                     begun = 0., missed_work = 0.;
    // Data that are equal at both ends may vary in between.
    const Swing swing = swing_of_data(discretization, accepted, end);
    if (discretization.face && scene.has_bounds_of_step_before())
      missed_work = discretization.face->missed_bounds(state).work;
    // On a new mesh, slip changes in a step of any size, so that the slip rate
    // of the first step is not comparable with that of the second.
    end.has_slip_rate = accepted.is_solution || accepted.state.k == 0.;
    const bool is_after_kink =
      control.has_kink_within(step.time_step.t_old - accepted.state.k,
                              step.time_step.t_old);
    if (discretization.slipping_face() != nullptr)
      {
        begun = slip_begun(discretization.face->layout(),
                           accepted.state.contact,
                           state.contact);
        if (accepted.state.k > 0. && accepted.is_solution &&
            accepted.has_slip_rate && !is_after_kink)
          slip_defects =
            slip_defects_of_step(*discretization.face, accepted, end);
      }
    error_estimator->assess(discretization.laws,
                            time_defect(step.is_implicit ?
                                          TimeScheme::backward_euler :
                                          scene.parameters.time.scheme),
                            slip_defects ? &*slip_defects : nullptr,
                            begun,
                            missed_work,
                            swing,
                            is_after_kink,
                            accepted,
                            old_rate,
                            end);
    error_estimator->assess_space(accepted.errors, end);
    if (quantity_estimator)
      quantity_estimator->assess(solver_of_elasticity().bulk(),
                                 slip_defects ? &*slip_defects : nullptr,
                                 growth,
                                 accepted,
                                 old_rate,
                                 end);
    const ErrorEstimate &estimate = end.errors;
    StepErrors           errors;
    errors.change =
      std::max(state.k * std::sqrt(std::max(0., estimate.velocity_square)),
               scene.has_viscosity() ? estimate.irreversible_change : 0.);
    // Errors of iterations in both states change G by up to r times as much, in
    // steps of any size. A change of the state that is below them counts as
    // none, and a large indicator in full, so that steps do not depend on how
    // far iterations have gone. A body that flows may end a step where it began
    // at the limit of stability, k r = 2: half the creep path is a change, too.
    // And so is what data do that are the same at both ends.
    const double left = step.report.error + accepted.report.error,
                 flow = estimate.creep_path - accepted.errors.creep_path;
    const bool moves =
      std::max({errors.change, 0.5 * flow, swing.energy_norm}) > left;
    const bool is_of_quantity =
      scene.quantity && scene.parameters.error_control.has_tolerance();
    if (moves)
      {
        const double indicator = is_of_quantity ?
                                   estimate.remembered_indicator :
                                   estimate.time_indicator;
        errors.indicator =
          std::clamp(2. * indicator - step.stiffness() * left, 0., indicator);
      }
    errors.size = estimate.energy_norm;
    if (scene.has_viscosity() &&
        !scene.parameters.error_control.has_tolerance())
      errors.size =
        std::max(errors.size, std::sqrt(2. * end.forces.irreversible_energy));
    errors.before = accepted.errors.time + accepted.errors.friction;
    if (is_of_quantity)
      make_errors_of_quantity(discretization,
                              accepted,
                              end,
                              moves,
                              control.later_dual_norm(state.t),
                              errors);
    else if (moves)
      errors.of_events = estimate.friction - accepted.errors.friction;
    errors.indicator += errors.of_events;
    if (!std::isfinite(errors.indicator + errors.change + errors.size))
      throw StepFailure(state.n, state.t, "the solution is not finite.");
    return errors;
  }



  template <int dim>
  std::optional<double>
  TimeStepper<dim>::growth_since_estimate(const EvaluatedState<dim> &accepted,
                                          EvaluatedState<dim>       &end) const
  {
    // Excluded are sums, which have a new dual problem in each step, rates of
    // nonlinear laws, whose errors add up and are in no proportion, and curved
    // contact, of which checkpoints do not keep all.
    if (error_estimator == nullptr || !accepted.is_solution ||
        accepted.state.k == 0. ||
        (accepted.space_estimate.rate_defect > 0. &&
         !discretization.laws.have_constant_tangents()) ||
        space_estimator->has_curved_contact() ||
        (scene.quantity && scene.quantity->is_sum()))
      return {};
    const double growth = std::sqrt(end.forces.strain_energy /
                                    accepted.forces.strain_energy),
                 since  = accepted.errors.since_estimate +
                         change_of_step(discretization, growth, accepted, end);
    // Without strain there is no growth.
    if (!(since <= largest_change && growth > 0.))
      return {};
    end.errors.since_estimate = since;
    return growth;
  }



  template <int dim>
  void
  TimeStepper<dim>::estimate_step(const EvaluatedState<dim>   &accepted,
                                  const std::optional<double> &growth,
                                  AcceptedStep<dim>           &step) const
  {
    EvaluatedState<dim> &end = step.end;
    if (growth || (step.is_unchanged && estimate_is_of_state_alone))
      end.space_estimate = accepted.space_estimate;
    else
      // The law may have no value at the end of the step.
      end.space_estimate = as_part_of_step(end.state.n, end.state.t, [&] {
        return space_estimator->estimate(end.state, end.forces);
      });
    if (growth)
      end.space_estimate.scale(*growth);
  }



  template <int dim>
  void
  TimeStepper<dim>::estimate(EvaluatedState<dim> &evaluated) const
  {
    if (!space_estimator)
      return;
    TimerOutput::Scope phase(timer, "estimate");
    evaluated.space_estimate =
      space_estimator->estimate(evaluated.state, evaluated.forces);
  }



  template <int dim>
  void
  TimeStepper<dim>::estimate_quantity(EvaluatedState<dim> &initial)
  {
    // A sum over steps has no value before the first one.
    if (!quantity_estimator || !initial.is_solution || scene.quantity->is_sum())
      return;
    TimerOutput::Scope phase(timer, "estimate");
    quantity_estimator->assess(
      solver_of_elasticity().bulk(), nullptr, {}, initial, nullptr, initial);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(TimeStepper, assess);
  VISCOPLASTIC_INSTANTIATE_MEMBER(TimeStepper, growth_since_estimate);
  VISCOPLASTIC_INSTANTIATE_MEMBER(TimeStepper, estimate_step);
  VISCOPLASTIC_INSTANTIATE_MEMBER(TimeStepper, estimate);
  VISCOPLASTIC_INSTANTIATE_MEMBER(TimeStepper, estimate_quantity);
} // namespace Viscoplastic
