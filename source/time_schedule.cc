// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/spelling.h>
#include <viscoplastic_contact/time_schedule.h>

#include <cmath>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// More are a slip of the pen, and would not fit into the type of n.
    constexpr double max_n_steps = 1e9;
  } // namespace



  TimeSchedule::TimeSchedule(const std::string &text)
  {
    double start = 0., n_all_steps = 0.;
    for (const std::string &phase : Utilities::split_string_list(text, ','))
      {
        const auto parts   = Utilities::split_string_list(phase, ':');
        double     end     = 0.;
        int        n_steps = 0;
        try
          {
            if (parts.size() == 2)
              {
                end     = Utilities::string_to_double(parts[0]);
                n_steps = Utilities::string_to_int(parts[1]);
              }
          }
        catch (const std::exception &)
          {
            n_steps = 0; // refused below
          }
        AssertThrow(n_steps > 0,
                    ExcMessage("'Time/Phases': '" + excerpt(phase) +
                               "' is not of the form `end time: number of "
                               "steps' with a positive number of steps."));
        AssertThrow(std::isfinite(end) && end > start,
                    ExcMessage("'Time/Phases': the end time of '" +
                               excerpt(phase) +
                               "' must be finite and lie after " +
                               std::to_string(start) + "."));
        n_all_steps += n_steps;
        AssertThrow(n_all_steps <= max_n_steps,
                    ExcMessage("'Time/Phases' has more than 1e9 steps up to '" +
                               excerpt(phase) + "'; take fewer."));
        phases.push_back({start, end, static_cast<unsigned int>(n_steps)});
        start = end;
      }
    AssertThrow(!phases.empty(),
                ExcMessage("'Time/Phases' is empty; give at least one phase as "
                           "`end time: number of steps'."));
  }



  unsigned int
  TimeSchedule::n_steps() const
  {
    unsigned int n = 0;
    for (const Phase &phase : phases)
      n += phase.n_steps;
    return n;
  }



  TimeStep
  TimeSchedule::step(const unsigned int n) const
  {
    Assert(n >= 1 && n <= n_steps(), ExcIndexRange(n, 1, n_steps() + 1));
    unsigned int i = n; // counted within the phase, from 1
    auto         p = phases.begin();
    for (; i > p->n_steps; ++p)
      i -= p->n_steps;
    const auto time = [&](const unsigned int j) {
      return j == p->n_steps ? p->end :
                               p->start + (p->end - p->start) * j / p->n_steps;
    };
    return {n, time(i - 1), time(i), time(i) - time(i - 1)};
  }



  unsigned int
  TimeSchedule::phase_ending_with(const unsigned int n) const
  {
    unsigned int last = 0;
    for (unsigned int i = 0; i < phases.size(); ++i)
      {
        last += phases[i].n_steps;
        if (n <= last)
          return n == last ? i + 1 : 0;
      }
    return 0;
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
