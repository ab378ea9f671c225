// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/parameters/time_schedule.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// More steps are surely a mistake, and would not fit into the type of n.
    constexpr double max_n_steps = 1e9;



    /// Return the end of step j of a phase.
    double
    step_end(const TimeSchedule::Phase &phase, const unsigned int j)
    {
      return j == phase.n_steps ?
               phase.end :
               phase.start + (phase.end - phase.start) * j / phase.n_steps;
    }



    std::vector<TimeSchedule::Phase>
    read_phases(const std::string &text)
    {
      std::vector<TimeSchedule::Phase> phases;
      double                           start = 0., n_all_steps = 0.;
      for (const std::string &phase : Utilities::split_string_list(text, ','))
        {
          const auto parts = Utilities::split_string_list(phase, ':');
          // Read as a double: large numbers would overflow an integer.
          const double n =
            parts.size() == 2 ? number_of(parts[1]).value_or(0.) : 0.;
          if (!(n > 0.) || n != std::floor(n) || !number_of(parts[0]))
            refuse("'Time/Phases': '" + excerpt(phase) +
                   "' is not of the form `end time: number of steps' with a "
                   "positive number of steps.");
          const std::string of_phase = " of '" + excerpt(phase) + "'";
          const double      end      = *number_of(parts[0]);
          const int n_steps = static_cast<int>(std::min(n, 2. * max_n_steps));
          if (!std::isfinite(end) || !(end > start))
            refuse("'Time/Phases': the end time" + of_phase +
                   " must be finite and lie after " + number(start, 15) + ".");
          const double step = (end - start) / n_steps;
          if (!(step > 1e-14 * end))
            refuse("'Time/Phases': the steps" + of_phase +
                   " are shorter than 1e-14 of its end time, which is what "
                   "rounding leaves of times; take fewer steps.");
          require_in_range("'Time/Phases': the end time" + of_phase,
                           end,
                           least_time,
                           largest_time);
          require_in_range("'Time/Phases': the time step" + of_phase,
                           step,
                           least_time,
                           largest_time);
          n_all_steps += n_steps;
          if (!(n_all_steps <= max_n_steps))
            refuse("'Time/Phases' has more than 1e9 steps up to '" +
                   excerpt(phase) + "'; take fewer.");
          phases.push_back({start, end, static_cast<unsigned int>(n_steps)});
          start = end;
        }
      if (phases.empty())
        refuse("'Time/Phases' is empty; give at least one phase as `end time: "
               "number of steps'.");
      return phases;
    }
  } // namespace



  TimeSchedule::TimeSchedule(const std::string &text)
    : phases(read_phases(text))
  {}



  TimeStep
  TimeSchedule::step(const unsigned int n) const
  {
    Assert(n >= 1 && n <= n_steps(), ExcIndexRange(n, 1, n_steps() + 1));
    unsigned int i = n; // counted within the phase, from 1
    auto         p = phases.begin();
    for (; i > p->n_steps; ++p)
      i -= p->n_steps;
    const double t_old = step_end(*p, i - 1), t = step_end(*p, i);
    return {n, t_old, t, t - t_old};
  }



  const TimeSchedule::Phase &
  TimeSchedule::phase_at(const double t) const
  {
    Assert(t >= 0. && t < end_time(), ExcIndexRange(t, 0., end_time()));
    auto p = phases.begin();
    while (t >= p->end)
      ++p;
    return *p;
  }



  double
  TimeSchedule::next_time(const double t) const
  {
    const Phase &phase = phase_at(t);
    // This guess may be off by one due to rounding.
    unsigned int j = static_cast<unsigned int>(
      std::clamp((t - phase.start) / phase.step_size(),
                 1.,
                 static_cast<double>(phase.n_steps)));
    while (j > 1 && step_end(phase, j - 1) > t)
      --j;
    while (step_end(phase, j) <= t)
      ++j;
    return step_end(phase, j);
  }



  TimeStep
  TimeSchedule::largest_step() const
  {
    unsigned int n       = 1;
    TimeStep     largest = step(n);
    for (const Phase &phase : phases)
      {
        if (const TimeStep first = step(n); first.k > largest.k)
          largest = first;
        n += phase.n_steps;
      }
    return largest;
  }
} // namespace Viscoplastic
