// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/error_estimator.h>
#include <viscoplastic_contact/laws/backward_euler.h>

#include <limits>

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



    /// How much loads change in a step, relative to those at its end. Friction
    /// bounds that are given count as loads, and change without limit.
    /// Collective.
    template <int dim>
    double
    change_of_loads(const FlowLaws<dim>       &laws,
                    const EvaluatedState<dim> &old,
                    const EvaluatedState<dim> &end)
    {
      const Scene<dim> &scene   = laws.stress_space.space.scene;
      const auto        changes = [](const auto &datum) {
        return datum && datum->depends_on_time();
      };
      for (const auto &[id, condition] : scene.boundary)
        if (changes(condition.friction_bound) ||
            changes(condition.friction_coefficient) ||
            changes(condition.normal_stress))
          return std::numeric_limits<double>::infinity();
      // So does a temperature.
      if (laws.thermal && laws.thermal->changes(old.state.t, end.state.t))
        return std::numeric_limits<double>::infinity();
      DistributedVector change = end.forces.load.values;
      change -= old.forces.load.values;
      const double size = change.l2_norm();
      return size > 0. ? size / end.forces.load.values.l2_norm() : 0.;
    }



    /// What becomes of an error of the history variables of @p point in a step
    /// of backward Euler to this stress, and what it adds to z meanwhile: the
    /// difference of two steps.
    struct CarriedError
    {
      SymmetricTensor<2, 3> history, z;
    };

    CarriedError
    carry_history_error(const ViscoplasticLaw       &law,
                        const SymmetricTensor<2, 3> &error,
                        const SymmetricTensor<2, 3> &stress,
                        const SymmetricTensor<2, 3> &strain,
                        const double                 k,
                        const Stiffness             &stiffness,
                        LawPoint                     point)
    {
      CarriedError                result;
      const SymmetricTensor<2, 3> start = *point.history;
      for (const double with : {1., -1.})
        {
          const SymmetricTensor<2, 3> from = with > 0. ? start + error : start;
          point.history                    = &from;
          const SymmetricTensor<2, 3> history =
            law.history_after_step(stress, strain, k, stiffness, point);
          point.history = &history;
          result.history += with * history;
          result.z += with * k * law.rate(stress, strain, stiffness, point);
        }
      return result;
    }



    /// (1 + k dG/deps E^-1)^-1, what a step leaves of an error of z that makes
    /// no stress, since strains make up for it: of linear laws that depend on
    /// the strain. None of others, whose strain stays.
    std::optional<SymmetricTensor<4, 3>>
    fading_with_strain(const ViscoplasticLaw &law,
                       const double           k,
                       const Stiffness       &stiffness,
                       const LawPoint        &point)
    {
      if (!law.has_constant_tangents() || law.radial_flow(0., point))
        return {};
      const auto tangents = law.tangents({}, {}, stiffness, point);
      return invert(identity_tensor<3>() +
                    k * tangents.strain * invert(stiffness.tensor()));
    }



    /// G half-way through a step of which stress and strain are linear.
    template <int dim>
    IrreversibleStress
    rate_half_way(const FlowLaws<dim> &laws,
                  const State<dim>    &old,
                  const State<dim>    &end)
    {
      State<dim> middle;
      middle.u       = end.u;
      middle.z       = end.z;
      middle.history = end.history;
      // Local values, those of ghosts included.
      const std::size_t n_values =
        laws.stress_space.space.relevant.n_elements();
      for (std::size_t i = 0; i < n_values; ++i)
        middle.u.begin()[i] = 0.5 * (old.u.begin()[i] + end.u.begin()[i]);
      for (std::size_t i = 0; i < end.z.size(); ++i)
        middle.z[i] = 0.5 * (old.z[i] + end.z[i]);
      for (std::size_t i = 0; i < end.history.size(); ++i)
        middle.history[i] = 0.5 * (old.history[i] + end.history[i]);
      return evaluate_flow(laws, middle, end.t - 0.5 * end.k).rate;
    }
  } // namespace



  TimeDefect
  time_defect(const TimeScheme scheme)
  {
    // Of Heun's that of the trapezoidal rule; add_defect() knows what it has
    // integrated instead of that.
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
  std::array<bool, 7>
  ErrorEstimator<dim>::has_sample_fields(const Scene<dim> &scene)
  {
    const bool estimates = scene.parameters.error_control.error_estimator &&
                           scene.has_viscosity(),
               remembers =
                 estimates && scene.quantity && scene.quantity->is_force(),
               has_slopes =
                 remembers ||
                 (estimates &&
                  time_defect(scene.parameters.time.scheme).second != 0.),
               has_history = scene.has_history();
    return {{scene.has_irreversible_stress(),
             estimates,
             has_slopes,
             remembers,
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
    for (unsigned int f = 0; f < has_field.size(); ++f)
      if (has_field[f])
        sample_fields(state)[f]->resize(state.z.size());
    return squared_by_cell;
  }



  template <int dim>
  void
  ErrorEstimator<dim>::assess_equilibrium(const ContactReport &report,
                                          EvaluatedState<dim> &initial) const
  {
    initial.errors.energy_norm = energy_norm(initial.forces);
    initial.errors.space       = initial.space_estimate.total;
    initial.errors.algebraic   = report.error;
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
  ErrorEstimator<dim>::add_defect(const FlowLaws<dim>       &laws,
                                  const TimeDefect          &defect,
                                  const bool                 has_slope,
                                  const EvaluatedState<dim> &old,
                                  const FlowRate            &accepted_rate,
                                  EvaluatedState<dim>       &end) const
  {
    const State<dim>       &accepted     = old.state;
    const StressSpace<dim> &stress_space = laws.stress_space;
    const auto              now       = laws.at(end.state.t, accepted.history);
    State<dim>             &state     = end.state;
    ErrorEstimate          &estimate  = end.errors;
    const auto              has_field = has_sample_fields(scene);
    const bool              is_second = has_field[2], relaxes = has_field[3];
    const bool is_measured = scene.parameters.step_control.is_on() ||
                             scene.parameters.error_control.has_tolerance() ||
                             scene.quantity;
    const double k = state.k;
    // What relaxes by itself does so in a time 1/r, however long the step.
    constexpr double resolved = 0.1;
    const double     r =
      std::max(accepted_rate.relaxation_rate, end.rate->relaxation_rate);
    const double of_loads = defect.first < 0. && k * r > resolved ?
                              change_of_loads(laws, old, end) :
                              std::numeric_limits<double>::infinity();
    const bool   fades    = std::isfinite(of_loads);
    // A power of a stress that grows is not linear in a long step.
    IrreversibleStress half_way;
    if (defect.first < 0. && !laws.have_constant_tangents())
      half_way = rate_half_way(laws, accepted, state);
    state.time_error = accepted.time_error;
    if (is_second)
      state.rate_slope.resize(accepted.rate_slope.size());
    state.remembered_error = accepted.remembered_error;
    state.history_error    = accepted.history_error;
    state.history_slope.resize(accepted.history_slope.size());
    // What a step has left out of z or history, to leading order, whose rates
    // at both ends are given; and the slope of that.
    const bool         has_predictor = defect.second != 0.;
    IrreversibleStress unflowed;
    if (has_predictor)
      {
        unflowed = accepted.z;
        if (laws.thermal)
          laws.thermal->follow(accepted.t, state.t, unflowed);
      }
    const auto defect_of = [&](const SymmetricTensor<2, 3> &old_rate,
                               const SymmetricTensor<2, 3> &rate,
                               const SymmetricTensor<2, 3> &increment,
                               const std::size_t            i,
                               const IrreversibleStress    &old_slopes,
                               IrreversibleStress          &slopes) {
      const SymmetricTensor<2, 3> change = rate - old_rate;
      SymmetricTensor<2, 3>       step   = defect.first * k * change;
      // Heun's method takes the rate of its prediction for that of the end. At
      // the limit of stability nothing relaxes, and no rate changes.
      if (has_predictor)
        step += 0.5 * k * (old_rate + rate) - increment;
      if (is_second)
        slopes[i] = change / k;
      // There is no second derivative before the second step.
      if (is_second && has_slope)
        step += defect.second * k * k * k * 2. / (k + accepted.k) *
                (slopes[i] - old_slopes[i]);
      return step;
    };
    std::vector<double>                  sums(8, 0.);
    std::vector<SymmetricTensor<2, 3>>   strains(stress_space.n_samples);
    std::optional<SymmetricTensor<4, 3>> fading;
    SymmetricTensor<4, 3>                relaxation;
    SymmetricTensor<2, 3>                stress, strain;
    LawPoint                             point;
    bool                                 is_uniform     = false;
    const ViscoplasticLaw               *last_law       = nullptr;
    const Stiffness                     *last_stiffness = nullptr;
    std::size_t                          i              = 0;
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      {
        const Stiffness       &stiffness = stress_space.moduli(c);
        const ViscoplasticLaw *law       = now.law(c);
        // The same in all cells of most bodies.
        if (c == 0 || law != last_law || &stiffness != last_stiffness ||
            (law && now.varies_in_space(c)))
          {
            fading = law ?
                       fading_with_strain(*law, k, stiffness, now.point(c, 0)) :
                       std::nullopt;
            is_uniform =
              law && law->has_constant_tangents() && !now.varies_in_space(c);
            if (law == nullptr)
              relaxation = identity_tensor<3>();
            else if (is_uniform && (relaxes || fades))
              relaxation =
                error_relaxation(*law, {}, {}, k, stiffness, now.point(c, 0));
          }
        last_law             = law;
        last_stiffness       = &stiffness;
        const bool remembers = law && law->n_history_variables > 0;
        const bool needs_stress =
          law && ((fades && of_loads > 0.) ||
                  ((relaxes || fades) && !is_uniform) || remembers);
        if (needs_stress)
          stress_space.strains(c, state.u.begin(), strains.data());
        for (unsigned int s = 0; s < stress_space.n_samples; ++s, ++i)
          {
            const double                weight = stress_space.weight(c, s);
            const SymmetricTensor<2, 3> change =
              end.rate->rate[i] - accepted_rate.rate[i];
            SymmetricTensor<2, 3> all =
              defect_of(accepted_rate.rate[i],
                        end.rate->rate[i],
                        has_predictor ? state.z[i] - unflowed[i] :
                                        SymmetricTensor<2, 3>(),
                        i,
                        accepted.rate_slope,
                        state.rate_slope);
            if (!half_way.empty())
              all -=
                k / 3. *
                (accepted_rate.rate[i] + end.rate->rate[i] - 2. * half_way[i]);
            SymmetricTensor<2, 3> step = all, of_history;
            CarriedError          carried;
            if (needs_stress)
              {
                stress = stiffness.stress(strains[s]) + state.z[i];
                strain = now.mechanical(strains[s], c, s);
                point  = now.point(c, s);
              }
            if (law && (relaxes || fades) && !is_uniform)
              relaxation =
                error_relaxation(*law, stress, strain, k, stiffness, point);
            if (remembers)
              {
                carried = carry_history_error(*law,
                                              state.history_error[i],
                                              stress,
                                              strain,
                                              k,
                                              stiffness,
                                              point);
                state.history_error[i] =
                  carried.history +
                  defect_of(accepted_rate.history_rate[i],
                            end.rate->history_rate[i],
                            state.history[i] - accepted.history[i],
                            i,
                            accepted.history_slope,
                            state.history_slope);
                LawPoint after = point;
                after.history  = &state.history[i];
                if (fades)
                  of_history = defect.first * k *
                               (law->rate(stress, strain, stiffness, after) -
                                law->rate(stress, strain, stiffness, point));
              }
            if (fades)
              {
                // The loads have changed G by no more than r times the change
                // of the stress.
                double share = 0.;
                if (of_loads > 0.)
                  {
                    const double most =
                      of_loads * r *
                      std::sqrt(stiffness.complementary_square(stress));
                    const double size =
                      std::sqrt(stiffness.complementary_square(change));
                    share = most < size ? most / size : 1.;
                  }
                // Nor is what the history has changed relaxation of stress.
                step =
                  share * all +
                  (1. - share) * (of_history + relaxation * (all - of_history));
              }
            state.time_error[i] += carried.z + step;
            if (relaxes)
              state.remembered_error[i] += carried.z;
            if (fading)
              state.time_error[i] = *fading * state.time_error[i];
            // Steps are chosen with the slope as the change of slope there.
            if (!has_slope)
              step += defect.second * k * change;
            if (relaxes)
              {
                const SymmetricTensor<2, 3> left =
                  relaxation * (fades ? all : step);
                const SymmetricTensor<2, 3> relaxed =
                  relaxation * state.remembered_error[i];
                sums[4] += weight * stiffness.complementary_square(left);
                sums[6] += weight * stiffness.complementary_square(
                                      state.remembered_error[i]);
                sums[7] +=
                  weight * stiffness.complementary_square(
                             fading ? state.remembered_error[i] : relaxed);
                state.remembered_error[i] = relaxed + left;
              }
            sums[0] += weight * stiffness.complementary_square(step);
            sums[1] +=
              weight * stiffness.complementary_square(state.time_error[i]);
            if (is_measured)
              {
                sums[2] += weight * stiffness.complementary_square(state.z[i]);
                sums[3] += weight * stiffness.complementary_square(
                                      state.z[i] - accepted.z[i]);
                sums[5] +=
                  weight * stiffness.complementary_square(end.rate->rate[i]);
              }
          }
      }
    Utilities::MPI::sum(sums, stress_space.space.communicator, sums);
    estimate.time_indicator      = std::sqrt(sums[0]);
    estimate.time                = std::sqrt(sums[1]);
    estimate.irreversible_norm   = std::sqrt(sums[2]);
    estimate.irreversible_change = std::sqrt(sums[3]);
    estimate.creep_path = old.errors.creep_path + k * std::sqrt(sums[5]);
    estimate.creep_time =
      estimate.creep_path > 0. ? estimate.creep_path / std::sqrt(sums[5]) : 0.;
    estimate.remembered_share =
      sums[6] > 0. ? std::sqrt(sums[7] / sums[6]) : 1.;
    estimate.remembered_indicator =
      relaxes ? std::sqrt(sums[4]) : estimate.time_indicator;
  }



  template <int dim>
  void
  ErrorEstimator<dim>::assess(const FlowLaws<dim>       &laws,
                              const TimeDefect          &defect,
                              const ContactReport       &report,
                              const double               turning,
                              const double               missed_work,
                              const Swing               &swing,
                              const bool                 is_fresh,
                              const EvaluatedState<dim> &accepted,
                              const FlowRate            *accepted_rate,
                              EvaluatedState<dim>       &end) const
  {
    const AdmissibleSpace<dim> &space    = laws.stress_space.space;
    const Forces<dim>          &forces   = end.forces;
    const ErrorEstimate        &before   = accepted.errors;
    ErrorEstimate              &estimate = end.errors;
    estimate.initial                     = before.initial;
    estimate.transfer                    = before.transfer;
    estimate.history =
      before.history + end.state.k * end.space_estimate.rate_defect;
    estimate.history_adds = !scene.keeps_history_at_points();
    estimate.friction =
      std::sqrt(Utilities::fixed_power<2>(before.friction) +
                Utilities::fixed_power<2>(friction_calibration) * turning +
                2. * missed_work);
    estimate.energy_norm = energy_norm(forces);
    estimate.space       = end.space_estimate.total;
    estimate.algebraic   = report.error;

    estimate.creep_path = before.creep_path;
    if (scene.has_viscosity())
      {
        Assert(accepted_rate != nullptr && end.rate,
               ExcMessage("The rates have not been evaluated."));
        add_defect(laws,
                   defect,
                   /* has_slope = */ accepted.state.k > 0. && !is_fresh,
                   accepted,
                   *accepted_rate,
                   end);
      }
    estimate.swing       = std::hypot(before.swing, swing.energy_norm);
    estimate.swing_share = std::hypot(before.swing_share, swing.share);
    estimate.time        = std::hypot(estimate.time, estimate.swing);
    estimate.time_indicator =
      std::hypot(estimate.time_indicator, swing.energy_norm);

    // With d = u_n - u_{n-1} and v = du_{n-1}, from a(u, .) of both states:
    // |d/k - v|^2 = a(d, d)/k^2 - 2 a(d, v)/k + a(v, v).
    const double      k = end.state.k;
    DistributedVector change(forces.u), velocity(forces.u),
      elastic(forces.elastic);
    change -= accepted.forces.u;
    elastic -= accepted.forces.elastic;
    space.to_frames(accepted.state.velocity, velocity);
    estimate.velocity_square = (elastic * change) / (k * k);
    const double jump        = estimate.velocity_square -
                        2. / k * (elastic * velocity) + before.velocity_square;
    // Below this it is rounding.
    const bool is_jump =
      jump > 1e-12 * (estimate.velocity_square + before.velocity_square);
    estimate.velocity_variation =
      std::sqrt(Utilities::fixed_power<2>(before.velocity_variation) +
                (is_jump ? k / 3. * jump : 0.));
  }



  template class ErrorEstimator<2>;
  template class ErrorEstimator<3>;
} // namespace Viscoplastic
