// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/time_stepping/step_control.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    std::string
    sentence_on_step(const unsigned int n,
                     const double       t,
                     const std::string &why)
    {
      std::ostringstream message;
      message << "Step " << n << " (t = " << t << "): " << why;
      return message.str();
    }



    /// The ratio of error and allowed error that the controller aims at, so
    /// that most steps are accepted.
    constexpr double aim = 0.9;
    /// Limits for the ratio of a step to the one before.
    constexpr double largest_growth = 2., growth_after_event = 5.,
                     least_growth = 0.2;
    /// Steps that could grow by less than this factor keep their size, since
    /// backward Euler factors a matrix for each step size.
    constexpr double least_change = 1.2;
    /// Smaller ratios of errors are taken for this one.
    constexpr double least_ratio = 1e-4;
    /// The least value of c (see StepControl), down to which contributions may
    /// cancel, and the least rest of the budget, as a part of it.
    constexpr double least_cancellation = 0.1, least_rest = 0.05;
    /// The part of the rest that a step repeated on a new mesh may use.
    constexpr double most_of_new_mesh = 0.15;
    /// The part of the rest that a step may use for events, whatever it covers
    /// of the remaining time: a body that slows down needs accuracy at events
    /// only. Error bounds for slip are of first order in k, as is the part of
    /// the time, so that otherwise no step would be short enough.
    constexpr double most_of_event = 0.01;
    /// Any step may use least_share of the rest of most_of_beginning of the
    /// budget. Otherwise what is fast but small, such as the beginning of
    /// creep, would take most of the steps for next to none of the error.
    constexpr double least_share = 1e-2, most_of_beginning = 0.5;
    /// Step sizes that are chosen by the error are fractions 2^(-i/n) of the
    /// whole time, so that errors of solvers do not change them, a difference
    /// that would grow from step to step.
    constexpr double n_sizes_per_octave = 16.;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    /// More stable steps than this up to a time of the phases are refused,
    /// since the scene is stiff.
    constexpr double most_divisions = 1e7;



    /// The next smaller of these fractions, or @p k itself up to rounding.
    double
    chosen_step_size(const double k, const double whole_time)
    {
      return whole_time * std::exp2(std::floor(n_sizes_per_octave *
                                                 std::log2(k / whole_time) +
                                               1e-6) /
                                    n_sizes_per_octave);
    }



    std::vector<double>
    read_times(const std::string &text, const double end_time)
    {
      std::vector<double> times;
      for (const std::string &entry : Utilities::split_string_list(text, ','))
        {
          double time = 0.;
          try
            {
              time = Utilities::string_to_double(entry);
            }
          catch (const std::exception &)
            {
              time = -1.; // refused below
            }
          if (!(time > 0.) || !(time <= end_time))
            refuse("'Step control/Landing times': '" + excerpt(entry) +
                   "' is not a time between 0 and " + as_text(end_time) + ".");
          times.push_back(time);
        }
      std::sort(times.begin(), times.end());
      return times;
    }
  } // namespace



  StepFailure::StepFailure(const unsigned int n,
                           const double       t,
                           const std::string &why)
    : std::runtime_error(sentence_on_step(n, t, why))
  {}



  StepControl::StepControl(const Parameters   &parameters,
                           const TimeSchedule &schedule,
                           const ErrorBudget  *budget)
    : StepControl(parameters.step_control,
                  parameters.time.stiffness_policy,
                  schedule,
                  order_of(parameters.time.scheme),
                  parameters.output.fields_interval,
                  budget != nullptr ? budget->time_tolerance() : 0.)
  {}



  StepControl::StepControl(const StepControlParameters &parameters,
                           const StiffnessPolicy        stiffness_policy,
                           const TimeSchedule          &schedule,
                           const unsigned int           order,
                           const double                 output_interval,
                           const double                 tolerance_of_run)
    : is_on(parameters.is_on() || tolerance_of_run > 0.)
    , subdivides(stiffness_policy == StiffnessPolicy::subdivide)
    , passes_limit(stiffness_policy == StiffnessPolicy::backward_euler)
    , parameters(parameters)
    , schedule(schedule)
    , order(order)
    , output_interval(is_on ? output_interval : 0.)
    , tolerance_of_run(tolerance_of_run)
    , landing_times(read_times(parameters.landing_times, schedule.end_time()))
  {
    if (!is_on && !landing_times.empty())
      refuse("'Step control/Landing times' are given, but the steps are those "
             "of 'Time/Phases'; give 'Step control/Tolerance' or 'Error "
             "control/Tolerance', or put the times into the phases.");
    if (parameters.largest_step != 0. &&
        !(parameters.smallest_step <= parameters.largest_step))
      refuse(
        "'Step control/Smallest step' = " + as_text(parameters.smallest_step) +
        " is larger than 'Step control/Largest step' = " +
        as_text(parameters.largest_step) + ".");
  }



  void
  StepControl::land_on(const std::vector<double> &kinks,
                       const std::vector<double> &jumps)
  {
    const auto add = [&](const double t) {
      if (t <= 0. || t >= schedule.end_time())
        return;
      data_kinks.push_back(t);
      if (!is_on)
        return;
      // Skip times that only rounding separates from another one.
      const TimeSchedule::Phase &phase = schedule.phase_at(t);
      const double               near  = 1e-9 * (phase.end - phase.start);
      bool is_new = t - phase.start > near && phase.end - t > near;
      for (const double other : landing_times)
        is_new &= std::fabs(t - other) > near;
      if (is_new)
        landing_times.push_back(t);
    };
    for (const double t : kinks)
      add(t);
    for (const double t : jumps)
      if (t < schedule.end_time())
        {
          // The values at t may be those before the jump or those after it.
          const TimeSchedule::Phase &phase = schedule.phase_at(t);
          const double               k     = 1e-6 * (phase.end - phase.start);
          add(t - 0.5 * k);
          add(t + 0.5 * k);
          // If fields are written at t, a step ends there, too.
          data_kinks.push_back(t);
        }
    std::sort(landing_times.begin(), landing_times.end());
    std::sort(data_kinks.begin(), data_kinks.end());
  }



  double
  StepControl::next_target(const double t) const
  {
    if (!is_on)
      return schedule.next_time(t);
    double     target = schedule.phase_at(t).end;
    const auto later =
      std::upper_bound(landing_times.begin(), landing_times.end(), t);
    if (later != landing_times.end())
      target = std::min(target, *later);
    if (output_interval > 0.)
      {
        double next = (std::floor(t / output_interval) + 1.) * output_interval;
        // Skip the multiple that is t itself up to rounding.
        if (next - t <= 1e-9 * output_interval)
          next += output_interval;
        // A multiple that is another target up to rounding is that target.
        if (next < target - 1e-9 * output_interval)
          target = next;
      }
    return target;
  }



  double
  StepControl::later_dual_norm(const double t) const
  {
    double largest = 0.;
    for (std::size_t i = 0; i < dual_times.size(); ++i)
      if (dual_times[i] >= t)
        largest = std::max(largest, dual_norms[i]);
    return largest;
  }



  TimeStep
  StepControl::propose(const unsigned int n,
                       const double       t,
                       const double       limit) const
  {
    const double target   = next_target(t);
    const double distance = target - t;
    double       k        = distance;
    if (present.wanted > 0.)
      k = present.wanted;
    else if (is_on)
      k = std::min(schedule.phase_at(t).step_size(), largest(t));
    if (needs_limit())
      {
        if (!(distance <= most_divisions * limit))
          refuse("The stability limit 2/r = " + as_text(limit) + " at t = " +
                 as_text(t) + " would take " + as_text(distance / limit) +
                 " steps until t = " + as_text(target) +
                 "; set 'Time/Scheme' = backward Euler.");
        k = std::min(k, limit);
      }
    // Take equal steps up to the target where few are left, to avoid a tiny
    // last one.
    const double divisions = std::ceil(distance / k * (1. - 1e-10));
    if (divisions <= 1.)
      return {n + 1, t, target, distance};
    if (!is_on || divisions <= 2.)
      k = distance / divisions;
    const double end = t + k;
    if (!(end > t))
      refuse("The time step " + as_text(k) +
             " is too small to change the time " + as_text(t) + ".");
    return {n + 1, t, end, end - t};
  }



  double
  StepControl::allowed_error(const TimeStep   &step,
                             const StepErrors &errors,
                             const double      size) const
  {
    const double T = schedule.end_time();
    if (tolerance_of_run == 0.)
      return parameters.tolerance * std::max(size * step.k / T, errors.change);
    const double all = tolerance_of_run * size;
    // The less of the budget is left, the less rely on cancellation.
    double cancellation = 1.;
    if (present.unsigned_sum > 0. && all > 0.)
      cancellation =
        std::clamp(errors.before / std::min(present.unsigned_sum, all),
                   least_cancellation,
                   1.);
    const double share = std::max(step.k / (T - step.t_old),
                                  size > 0. ? errors.change / size : 0.);
    return std::max(std::max(all - errors.before, least_rest * all) *
                      std::min(1., share / cancellation),
                    least_share / cancellation *
                      (most_of_beginning * all - errors.before));
  }



  double
  StepControl::growth_allowed_by(const double ratio)
  {
    if (!(ratio > 0.))
      return largest_growth;
    const double measured = std::max(ratio, least_ratio);
    const double best     = std::pow(aim / measured, 1. / order);
    double       factor   = std::pow(aim / measured, 0.3 / order);
    if (before.last_ratio > 0.)
      factor *= std::pow(before.last_ratio / measured, 0.4 / order);
    if (best >= 1. && best < least_change)
      factor = 1.;
    present.last_ratio = measured;
    return factor;
  }



  bool
  StepControl::accepts(const TimeStep   &step,
                       const StepErrors &errors,
                       const bool        has_event)
  {
    if (!is_on)
      {
        // After a failed step, try the step size of the phase again.
        present.wanted = 0.;
        return true;
      }
    const double new_size = std::max(present.size, errors.size);
    const double all      = tolerance_of_run * new_size;
    // Whether the step was accepted on the mesh before.
    const bool is_repeated = verdict && step.t == verdict->t;
    double     allowed     = allowed_error(step, errors, new_size);
    if (is_repeated)
      allowed = std::max(allowed, most_of_new_mesh * (all - errors.before));
    const double of_events =
      std::max(allowed, most_of_event * (all - errors.before));
    // As long as a quantity is zero, errors relative to it say nothing, and
    // steps stay as they are.
    const double ratio = errors.indicator == 0. ?
                           0. :
                         tolerance_of_run > 0. && new_size == 0. ?
                           aim :
                           (errors.indicator - errors.of_events) / allowed +
                             errors.of_events / of_events;
    const double least = smallest(step.t_old) * (1. + 1e-9);
    const auto  &phase = schedule.phase_at(step.t_old);
    const double event_gap =
      std::max(least, parameters.event_tolerance * (phase.end - phase.start));

    if (!(ratio <= 1.) && step.k > least)
      {
        ++n.rejected;
        present.was_rejected = true;
        present.wanted =
          std::max(smallest(step.t_old),
                   chosen_step_size(
                     step.k *
                       std::clamp(std::pow(aim / ratio, 1. / order), 0.1, 0.9),
                     schedule.end_time()));
        return false;
      }
    if (has_event && parameters.resolve_events != EventResolution::off &&
        step.k > event_gap)
      {
        ++n.events;
        present.was_rejected = true;
        present.event_before = step.t;
        present.wanted       = std::max(smallest(step.t_old), 0.5 * step.k);
        return false;
      }

    if (ratio > 1.)
      ++n.unresolved;
    before = present;
    if (is_repeated)
      present = *verdict;
    verdict.reset();
    present.t            = step.t;
    present.size         = new_size;
    present.unsigned_sum = before.unsigned_sum + errors.indicator;
    if (is_repeated)
      return true;
    double factor = growth_allowed_by(ratio);
    // Steps do not grow before an event, and grow quickly after it.
    if (has_event)
      present.event_before = 0.;
    const bool is_before = step.t < present.event_before;
    factor               = std::clamp(factor,
                        least_growth,
                        is_before || (before.was_rejected && !has_event) ? 1. :
                                      has_event ? growth_after_event :
                                                  largest_growth);
    // A step that a landing time has cut short does not limit the next.
    const double uncut = before.was_rejected ? 0. : before.wanted;
    const double next =
      factor == 1. ? step.k :
                     chosen_step_size(factor * step.k, schedule.end_time());
    present.wanted =
      std::min(std::max(
                 {next, factor >= 1. ? uncut : 0., smallest(step.t_old)}),
               largest(step.t_old));
    present.was_rejected = false;
    if (schedule.phase_ending_at(step.t) > 0)
      {
        // A new phase begins with its own step size.
        present.wanted       = 0.;
        present.last_ratio   = 0.;
        present.event_before = 0.;
      }
    return true;
  }



  bool
  StepControl::retries(const TimeStep &step, const bool for_stability)
  {
    if (!is_on && !(subdivides && for_stability))
      return false;
    const double shorter = (for_stability ? 0.5 : 0.25) * step.k;
    if (shorter < smallest(step.t_old))
      return false;
    ++n.failed;
    present.was_rejected = true;
    present.wanted       = shorter;
    return true;
  }
} // namespace Viscoplastic
