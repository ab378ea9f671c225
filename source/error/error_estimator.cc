// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/error_estimator.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    double
    energy_norm(const Forces<dim> &forces)
    {
      return std::sqrt(2. * std::max(0., forces.strain_energy));
    }
  } // namespace



  TimeDefect
  time_defect(const TimeScheme scheme)
  {
    // For Heun's method, the defect of the trapezoidal rule; add_defect() adds
    // the difference between that rule and the method.
    return scheme == TimeScheme::forward_euler  ? TimeDefect{0.5, 0.} :
           scheme == TimeScheme::backward_euler ? TimeDefect{-0.5, 0.} :
                                                  TimeDefect{0., -1. / 12.};
  }



  template <int dim>
  ErrorEstimator<dim>::ErrorEstimator(const Scene<dim> &scene)
    : scene(scene)
    , solver(scene.parameters.solver)
    , algebraic_fraction(scene.parameters.error_control.algebraic_fraction)
  {}



  template <int dim>
  std::array<bool, n_sample_fields>
  ErrorEstimator<dim>::has_sample_fields(const Scene<dim> &scene)
  {
    const bool estimates = scene.parameters.error_control.error_estimator &&
                           scene.has_viscosity(),
               carries =
                 estimates && scene.quantity && !scene.quantity->is_sum(),
               has_slopes =
                 carries ||
                 (estimates &&
                  time_defect(scene.parameters.time.scheme).second != 0.),
               has_history = scene.has_history();
    return {{scene.has_irreversible_stress(),
             estimates,
             has_slopes,
             carries,
             has_history,
             has_history && estimates,
             has_history && has_slopes}};
  }



  template <int dim>
  Vector<double>
  ErrorEstimator<dim>::begin(const StressSpace<dim> &stress_space,
                             EvaluatedState<dim>    &initial) const
  {
    State<dim>    &state = initial.state;
    Vector<double> squared_by_cell;
    initial.errors.initial =
      initial_data_error(stress_space, state, &squared_by_cell);
    const auto has_field = has_sample_fields(scene);
    auto       has       = has_field.begin();
    for_each_sample_field(state, [&](auto &field) {
      if (*has++)
        field.resize(state.z.size());
    });
    return squared_by_cell;
  }



  template <int dim>
  void
  ErrorEstimator<dim>::assess_equilibrium(EvaluatedState<dim> &initial) const
  {
    initial.errors.energy_norm = energy_norm(initial.forces);
    initial.errors.space       = initial.space_estimate.total;
    initial.errors.algebraic   = initial.report.error;
  }



  template <int dim>
  void
  ErrorEstimator<dim>::change_mesh(const AdmissibleSpace<dim> &space,
                                   const DistributedMatrix    &matrix,
                                   const double                memory_loss,
                                   const double                history,
                                   EvaluatedState<dim>        &accepted) const
  {
    DistributedVector velocity = space.owned_vector(), force = velocity;
    space.to_frames(accepted.state.velocity, velocity);
    matrix.vmult(force, velocity);
    accepted.errors.velocity_square = velocity * force;
    accepted.errors.transfer += memory_loss;
    accepted.errors.history =
      std::hypot(accepted.errors.history, std::sqrt(history));
  }



  template <int dim>
  double
  ErrorEstimator<dim>::tolerance(const ErrorEstimate &accepted) const
  {
    const double discretization = accepted.space + accepted.time;
    if (solver.contact_tolerance > 0. || accepted.energy_norm == 0. ||
        discretization == 0.)
      return solver.strict_tolerance();
    double allowed = algebraic_fraction * discretization;
    if (const QuantityEstimate &quantity = accepted.quantity;
        quantity.dual_norm > 0. && quantity.space + quantity.time > 0.)
      allowed = std::min(allowed,
                         algebraic_fraction * (quantity.space + quantity.time) /
                           quantity.dual_norm);
    return std::clamp(allowed / accepted.energy_norm,
                      least_tolerance,
                      largest_tolerance);
  }



  template <int dim>
  void
  ErrorEstimator<dim>::assess_change(const StressSpace<dim>    &stress_space,
                                     const EvaluatedState<dim> &accepted,
                                     EvaluatedState<dim>       &end) const
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const Forces<dim> &forces = end.forces, &old_forces = accepted.forces;
    ErrorEstimate     &estimate = end.errors;
    estimate.energy_norm        = energy_norm(forces);
    estimate.algebraic          = end.report.error;
    // a(d, d), a(d, v) below, and the square of the change of z.
    std::vector<double>       products(3, 0.);
    const IrreversibleStress &z = end.state.z, &old_z = accepted.state.z;
    std::vector<SymmetricTensor<2, 3>> of_cell(stress_space.n_samples);
    for (std::size_t c = 0, i = 0; i < z.size(); ++c)
      {
        for (unsigned int s = 0; s < of_cell.size(); ++s, ++i)
          for (unsigned int e = 0; e < 6; ++e)
            of_cell[s].begin_raw()[e] =
              z[i].begin_raw()[e] - old_z[i].begin_raw()[e];
        products[2] += stress_space.complementary_square(c, of_cell.data());
      }
    // With d = u_n - u_{n-1} and v = du_{n-1}, from a(u, .) of both states:
    // |d/k - v|^2 = a(d, d)/k^2 - 2 a(d, v)/k + a(v, v).
    const double      k        = end.state.k;
    DistributedVector velocity = space.owned_vector();
    space.to_frames(accepted.state.velocity, velocity);
    const bool has_z = forces.irreversible.size() > 0;
    for (unsigned int i = 0; i < velocity.locally_owned_size(); ++i)
      {
        // Of a(u, .).
        const auto at = [i](const DistributedVector &v) {
          return v.begin()[i];
        };
        const double change =
          has_z ? (at(forces.internal) - at(forces.irreversible)) -
                    (at(old_forces.internal) - at(old_forces.irreversible)) :
                  at(forces.internal) - at(old_forces.internal);
        products[0] += change * (at(forces.u) - at(old_forces.u));
        products[1] += change * at(velocity);
      }
    Utilities::MPI::sum(products, space.communicator, products);
    estimate.irreversible_change = std::sqrt(products[2]);
    estimate.velocity_square     = products[0] / (k * k);
    const double jump = estimate.velocity_square - 2. / k * products[1] +
                        accepted.errors.velocity_square;
    // A smaller jump is rounding.
    const bool is_jump = jump > 1e-12 * (estimate.velocity_square +
                                         accepted.errors.velocity_square);
    estimate.velocity_variation =
      std::sqrt(Utilities::fixed_power<2>(accepted.errors.velocity_variation) +
                (is_jump ? k / 3. * jump : 0.));
  }



  template <int dim>
  void
  ErrorEstimator<dim>::assess(const FlowLaws<dim>       &laws,
                              const TimeDefect          &defect,
                              const SlipDefects         *slip_defects,
                              const double               slip_begun,
                              const double               missed_work,
                              const Swing               &swing,
                              const bool                 is_fresh,
                              const EvaluatedState<dim> &accepted,
                              const FlowRate            *accepted_rate,
                              EvaluatedState<dim>       &end) const
  {
    const ErrorEstimate &before   = accepted.errors;
    ErrorEstimate       &estimate = end.errors;
    estimate.initial              = before.initial;
    estimate.transfer             = before.transfer;
    estimate.history_adds         = !scene.keeps_history_at_points();
    estimate.friction =
      std::sqrt(Utilities::fixed_power<2>(before.friction) +
                Utilities::fixed_power<2>(friction_calibration) *
                  (slip_defects != nullptr ? slip_defects->work : 0.) +
                2. * missed_work);
    estimate.creep_path = before.creep_path;
    estimate.slip_begun = slip_begun;
    if (scene.has_viscosity())
      {
        Assert(accepted_rate != nullptr && end.rate,
               ExcMessage("The rates have not been evaluated."));
        // G has grown only before slip began, the part of the step without
        // slip.
        const double onset =
          slip_defects != nullptr ?
            0.5 *
              std::max(0., before.slip_begun + slip_defects->rate_before - 1.) :
            0.;
        add_defect(laws,
                   defect,
                   /* has_slope = */ accepted.state.k > 0. && !is_fresh &&
                     before.slip_begun < 0.5,
                   onset,
                   accepted,
                   *accepted_rate,
                   end);
      }
    estimate.swing       = std::hypot(before.swing, swing.energy_norm);
    estimate.swing_share = std::hypot(before.swing_share, swing.share);
    estimate.time        = std::hypot(estimate.time, estimate.swing);
    estimate.time_indicator =
      std::hypot(estimate.time_indicator, swing.energy_norm);
  }



  template <int dim>
  void
  ErrorEstimator<dim>::assess_space(const ErrorEstimate &before,
                                    EvaluatedState<dim> &end) const
  {
    end.errors.history =
      before.history + end.state.k * end.space_estimate.rate_defect;
    end.errors.space = end.space_estimate.total;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ErrorEstimator);
} // namespace Viscoplastic
