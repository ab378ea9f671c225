// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/error_decay.h>
#include <viscoplastic_contact/error/error_estimator.h>

#include <limits>

// Sums of the defects of time steps in z and in history variables.

namespace Viscoplastic
{
  namespace
  {
    /// Return the change of the loads in a step, relative to those at its end;
    /// infinity if given friction bounds or temperatures change. Collective.
    template <int dim>
    double
    change_of_loads(const FlowLaws<dim>       &laws,
                    const EvaluatedState<dim> &old,
                    const EvaluatedState<dim> &end)
    {
      for (const auto &[id, condition] : laws.stress_space.space.scene.boundary)
        if (condition.friction_depends_on_time())
          return std::numeric_limits<double>::infinity();
      if (laws.thermal && laws.thermal->changes(old.state.t, end.state.t))
        return std::numeric_limits<double>::infinity();
      DistributedVector change = end.forces.load.values;
      change -= old.forces.load.values;
      const double size = change.l2_norm();
      return size > 0. ? size / end.forces.load.values.l2_norm() : 0.;
    }



    /// An error of the history variables after a step of backward Euler to a
    /// given stress, and its contribution to z in the step: differences of two
    /// steps.
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



    /// Return G in the middle of a step in which stress and strain are linear.
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
      // All local values, including ghosts.
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



    /// Return the largest entry of @p z at one sample of each cell.
    double
    largest_entry(const IrreversibleStress &z, const unsigned int n_samples)
    {
      // One by one, entries would wait for each other.
      std::array<double, 6> result{};
      for (std::size_t i = 0; i < z.size(); i += n_samples)
        for (unsigned int e = 0; e < 6; ++e)
          result[e] = std::max(result[e], std::fabs(z[i].access_raw_entry(e)));
      return *std::max_element(result.begin(), result.end());
    }



    /// Return the true part of backward Euler's defect k (G_n - G_{n-1})/2 if G
    /// decays exponentially, by its relaxation 1/(1 + x): to 15 %, the exact
    /// part 2 (1 + x) (1 - (1 + x) exp(-x))/x^2.
    ErrorRelaxation
    defect_of_decay(const ErrorRelaxation &relaxation)
    {
      ErrorRelaxation result = relaxation;
      if (relaxation.any)
        {
          const SymmetricTensor<4, 3> one = identity_tensor<3>(),
                                      x   = invert(*relaxation.any) - one;
          result.any = invert(one + 1. / 3. * x + 0.5 * (x * x)) * (one + x);
          return result;
        }
      const auto part = [](const double left) {
        const double x = 1. / left - 1.;
        return (1. + x) / (1. + x / 3. + 0.5 * x * x);
      };
      const double square = relaxation.direction * relaxation.direction;
      result.of_deviators = part(relaxation.of_deviators);
      if (square > 0.)
        result.more_along =
          (part(relaxation.of_deviators + square * relaxation.more_along) -
           result.of_deviators) /
          square;
      return result;
    }



    /// Adds the defect of one step to the fields, and computes its norms.
    template <int dim>
    class DefectOfStep
    {
    public:
      DefectOfStep(const Scene<dim>          &scene,
                   const FlowLaws<dim>       &laws,
                   const TimeDefect          &defect,
                   const bool                 has_slope,
                   const double               onset,
                   const EvaluatedState<dim> &old,
                   const FlowRate            &accepted_rate,
                   EvaluatedState<dim>       &end)
        : stress_space(laws.stress_space)
        , decay(laws, old.state, end)
        , now(decay.now)
        , defect(defect)
        , has_slope(has_slope)
        , onset(onset)
        , is_second(ErrorEstimator<dim>::has_sample_fields(scene)[2])
        , carries(ErrorEstimator<dim>::has_sample_fields(scene)[3])
        , has_predictor(defect.second != 0.)
        , is_measured(scene.parameters.step_control.is_on() ||
                      scene.parameters.error_control.has_tolerance() ||
                      scene.quantity)
        , old(old)
        , accepted(old.state)
        , accepted_rate(accepted_rate)
        , end(end)
        , state(end.state)
        , k(state.k)
        , r(std::max(accepted_rate.relaxation_rate, end.rate->relaxation_rate))
        , of_loads(defect.first < 0. && k * r > resolved ?
                     change_of_loads(laws, old, end) :
                     std::numeric_limits<double>::infinity())
        , fades(std::isfinite(of_loads))
        , strains(stress_space.n_samples)
      {
        // In a long step, a power of a growing stress is not linear in time.
        if (defect.first < 0. && !laws.have_constant_tangents())
          half_way = rate_half_way(laws, accepted, state);
        if (has_predictor && laws.thermal)
          {
            heated = accepted.z;
            laws.thermal->follow(accepted.t, state.t, heated);
          }
      }

      /// Add the defect to the fields of the end of the step. Collective.
      void
      add()
      {
        state.time_error.resize(state.z.size());
        const double largest = Utilities::MPI::max(
          std::max(largest_entry(state.z, stress_space.n_samples),
                   k * largest_entry(end.rate->rate, stress_space.n_samples)),
          stress_space.space.communicator);
        state.time_error_unit =
          largest > 0. ? std::ldexp(1., std::ilogb(largest)) : 1.;
        state.rate_slope    = accepted.rate_slope;
        state.carried_error = accepted.carried_error;
        state.history_error = accepted.history_error;
        state.history_slope = accepted.history_slope;
        std::size_t i       = 0;
        for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
          {
            enter(c);
            for (unsigned int s = 0; s < stress_space.n_samples; ++s, ++i)
              if (is_plain)
                add_plain(s, i);
              else
                add_at(c, s, i);
            add_norms(c);
          }
        Utilities::MPI::sum(sums, stress_space.space.communicator, sums);
        ErrorEstimate &estimate = end.errors;
        estimate.time_indicator = std::sqrt(sums[of_step]);
        estimate.time           = std::sqrt(sums[of_all_steps]);
        const double rate       = std::sqrt(sums[of_rate]);
        estimate.creep_path     = old.errors.creep_path + k * rate;
        estimate.creep_time =
          estimate.creep_path > 0. ? estimate.creep_path / rate : 0.;
        estimate.remembered_indicator = estimate.time_indicator;
      }

    private:
      /// Set the members that all samples of a cell share.
      void
      enter(const std::size_t c)
      {
        decay.enter(c);
        law       = decay.law;
        stiffness = decay.stiffness;
        remembers = law && law->n_history_variables > 0;
        needs_stress =
          law &&
          ((fades && (of_loads > 0. || decay.asks_for_stress)) || remembers);
        is_plain = !remembers && !(fades && law) &&
                   !(onset > 0. && is_second) && !decay.growth &&
                   !has_predictor && half_way.empty();
        if (needs_stress)
          stress_space.strains(c, state.u.begin(), strains.data());
      }

      /// add_at() of a defect of first order of which all counts and stays, by
      /// components: the operators of tensors take three times as long.
      void
      add_plain(const unsigned int s, const std::size_t i)
      {
        const double *const        rate     = end.rate->rate[i].begin_raw(),
                            *const old_rate = accepted_rate.rate[i].begin_raw();
        const float *const         before = accepted.time_error[i].begin_raw();
        double *const step                = steps[s].begin_raw(), *const total =
                                                     totals[s].begin_raw();
        float *const after  = state.time_error[i].begin_raw();
        const double factor = defect.first * k, unit = accepted.time_error_unit,
                     inverse_unit = 1. / state.time_error_unit; // exact
        for (unsigned int e = 0; e < 6; ++e)
          {
            const double of_step = factor * (rate[e] - old_rate[e]),
                         of_all  = unit * before[e] + of_step;
            step[e]              = of_step;
            total[e]             = of_all;
            after[e]             = of_all * inverse_unit;
          }
        if (is_second)
          for (unsigned int e = 0; e < 6; ++e)
            state.rate_slope[i].begin_raw()[e] = (rate[e] - old_rate[e]) / k;
        if (carries)
          for (unsigned int e = 0; e < 6; ++e)
            state.carried_error[i].begin_raw()[e] += step[e];
      }

      void
      add_at(const std::size_t c, const unsigned int s, const std::size_t i)
      {
        const SymmetricTensor<2, 3> &old_z = accepted.z[i], &z = state.z[i];
        SymmetricTensor<2, 3>       &all = steps[s];

        all = defect_of(accepted_rate.rate[i],
                        end.rate->rate[i],
                        z,
                        heated.empty() ? old_z : heated[i],
                        i,
                        accepted.rate_slope,
                        state.rate_slope);
        if (!half_way.empty())
          all -= k / 3. *
                 (accepted_rate.rate[i] + end.rate->rate[i] - 2. * half_way[i]);
        totals[s]           = accepted.time_error_at(i);
        all                 = what_counts(c, s, i, all);
        state.time_error[i] = totals[s] / state.time_error_unit;
        // Without an earlier slope, step control assumes zero.
        if (!has_slope)
          all +=
            defect.second * k * (end.rate->rate[i] - accepted_rate.rate[i]);
      }

      /// Return the part of the defect @p all of a sample that counts; add it
      /// to the fields, and evolve their earlier errors.
      SymmetricTensor<2, 3>
      what_counts(const std::size_t            c,
                  const unsigned int           s,
                  const std::size_t            i,
                  const SymmetricTensor<2, 3> &all)
      {
        const SymmetricTensor<2, 3> change =
          end.rate->rate[i] - accepted_rate.rate[i];
        SymmetricTensor<2, 3> step = all, local = all;
        CarriedError          carried;
        if (needs_stress)
          {
            stress = stiffness->stress(strains[s]) + state.z[i];
            strain = now.mechanical(strains[s], c, s);
            point  = now.point(c, s);
          }
        if (remembers)
          carried = carry_history(i);
        if (fades && law)
          {
            // Changes of G by history variables and by loads do not relax.
            const SymmetricTensor<2, 3> of_history =
              remembers ? change_by_history(i) : SymmetricTensor<2, 3>();
            const double           share = share_of_loads(change);
            const ErrorRelaxation &relaxation =
              decay.relaxation_at(i, stress, strain, point);
            const SymmetricTensor<2, 3> driven =
              share * all + (1. - share) * of_history;
            step = driven + (1. - share) * (relaxation * (all - of_history));
            if (carries)
              local = driven + (1. - share) * (defect_of_decay(relaxation) *
                                               (all - of_history));
          }
        if (onset > 0. && is_second)
          carried.z +=
            onset * accepted.k *
            (accepted.k * accepted.rate_slope[i] - accepted.k / k * change);
        totals[s] += carried.z + step;
        if (carries)
          state.carried_error[i] += carried.z + local;
        if (decay.growth)
          totals[s] = decay.fading * totals[s];
        return step;
      }

      /// Add the squared norms of a cell to the sums.
      void
      add_norms(const std::size_t c)
      {
        const auto add = [&](const Norm norm, const SymmetricTensor<2, 3> *of) {
          sums[norm] += stress_space.complementary_square(c, of);
        };
        add(of_step, steps.data());
        add(of_all_steps, totals.data());
        if (is_measured)
          add(of_rate, &end.rate->rate[c * stress_space.n_samples]);
      }

      /// Return the defect of the step in z or history at a sample, to leading
      /// order, for given rates at both ends, and set the slope of the rate.
      DEAL_II_ALWAYS_INLINE inline SymmetricTensor<2, 3>
      defect_of(const SymmetricTensor<2, 3> &old_rate,
                const SymmetricTensor<2, 3> &rate,
                const SymmetricTensor<2, 3> &value,
                const SymmetricTensor<2, 3> &old_value,
                const std::size_t            i,
                const IrreversibleStress    &old_slopes,
                IrreversibleStress          &slopes) const
      {
        const SymmetricTensor<2, 3> change = rate - old_rate;
        SymmetricTensor<2, 3>       step   = defect.first * k * change;
        // Heun's method replaces the rate at the end by that of the predictor.
        // At the limit of stability nothing relaxes, and no rate changes.
        if (has_predictor)
          step += 0.5 * k * (old_rate + rate) - (value - old_value);
        if (is_second)
          slopes[i] = change / k;
        // There is no second derivative before the second step.
        if (has_predictor && has_slope)
          step += defect.second * k * k * k * 2. / (k + accepted.k) *
                  (slopes[i] - old_slopes[i]);
        return step;
      }

      /// Evolve the error of history variables, add their defect, return
      /// CarriedError.
      CarriedError
      carry_history(const std::size_t i)
      {
        const CarriedError carried = carry_history_error(
          *law, state.history_error[i], stress, strain, k, *stiffness, point);
        state.history_error[i] =
          carried.history + defect_of(accepted_rate.history_rate[i],
                                      end.rate->history_rate[i],
                                      state.history[i],
                                      accepted.history[i],
                                      i,
                                      accepted.history_slope,
                                      state.history_slope);
        return carried;
      }

      /// Return the part of the defect by the change of history variables.
      SymmetricTensor<2, 3>
      change_by_history(const std::size_t i) const
      {
        LawPoint after = point;
        after.history  = &state.history[i];
        return defect.first * k *
               (law->rate(stress, strain, *stiffness, after) -
                law->rate(stress, strain, *stiffness, point));
      }

      /// Return the share of the change of G that loads explain: at most r
      /// times the change of the stress.
      double
      share_of_loads(const SymmetricTensor<2, 3> &change) const
      {
        if (of_loads == 0.)
          return 0.;
        const double most = of_loads * r *
                            std::sqrt(stiffness->complementary_square(stress)),
                     size = std::sqrt(stiffness->complementary_square(change));
        return most < size ? most / size : 1.;
      }

      // In steps with k r below this, relaxation is resolved.
      static constexpr double resolved = 0.1;

      const StressSpace<dim>               &stress_space;
      ErrorDecay<dim>                       decay;
      const typename FlowLaws<dim>::AtTime &now;
      const TimeDefect                      defect;
      const bool                            has_slope;
      const double                          onset;
      const bool                 is_second, carries, has_predictor, is_measured;
      const EvaluatedState<dim> &old;
      const State<dim>          &accepted;
      const FlowRate            &accepted_rate;
      EvaluatedState<dim>       &end;
      State<dim>                &state;
      const double               k, r, of_loads;
      const bool                 fades;
      IrreversibleStress         half_way, heated;

      // Data of the present cell:
      const ViscoplasticLaw *law       = nullptr;
      const Stiffness       *stiffness = nullptr;
      bool remembers = false, needs_stress = false, is_plain = false;
      std::vector<SymmetricTensor<2, 3>> strains;
      std::array<SymmetricTensor<2, 3>, GeometryInfo<dim>::vertices_per_cell>
        steps, totals; // errors by this step, and by all
      // Data of the present sample:
      SymmetricTensor<2, 3> stress, strain;
      LawPoint              point;

      /// The quantities whose squared norms are summed.
      enum Norm
      {
        of_step,
        of_all_steps,
        of_rate,
        n_norms
      };
      std::vector<double> sums = std::vector<double>(n_norms, 0.);
    };
  } // namespace



  template <int dim>
  void
  ErrorEstimator<dim>::add_defect(const FlowLaws<dim>       &laws,
                                  const TimeDefect          &defect,
                                  const bool                 has_slope,
                                  const double               onset,
                                  const EvaluatedState<dim> &old,
                                  const FlowRate            &accepted_rate,
                                  EvaluatedState<dim>       &end) const
  {
    DefectOfStep<dim>(
      scene, laws, defect, has_slope, onset, old, accepted_rate, end)
      .add();
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(ErrorEstimator, add_defect);
} // namespace Viscoplastic
