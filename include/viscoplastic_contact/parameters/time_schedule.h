// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// One step of the partition 0 = t_0 < ... < t_N = T.
  struct TimeStep
  {
    /// The number of the step, beginning with 1.
    unsigned int n;
    /// t_{n-1}, t_n and k_n = t_n - t_{n-1}.
    double t_old, t, k;
  };


  /// Phases of equal steps, ending exactly on the listed times.
  struct TimeSchedule
  {
    /// A phase and its number of equal steps.
    struct Phase
    {
      double       start, end;
      unsigned int n_steps;

      double
      step_size() const
      {
        return (end - start) / n_steps;
      }
    };

    /// Parse @p phases `end time: number of steps, ...'; throws ExcMessage.
    explicit TimeSchedule(const std::string &phases);

    unsigned int
    n_steps() const
    {
      unsigned int n = 0;
      for (const Phase &phase : phases)
        n += phase.n_steps;
      return n;
    }

    /// Return step n, 1 <= n <= n_steps().
    TimeStep
    step(const unsigned int n) const;

    unsigned int
    n_phases() const
    {
      return phases.size();
    }

    /// Return the phase, counted from 1, that ends at time t; 0 if none does.
    unsigned int
    phase_ending_at(const double t) const
    {
      for (unsigned int i = 0; i < phases.size(); ++i)
        if (phases[i].end == t)
          return i + 1;
      return 0;
    }

    /// Return the phase with start <= t < end, for 0 <= t < end_time().
    const Phase &
    phase_at(const double t) const;

    /// Return the first end of a step after t, for 0 <= t < end_time().
    double
    next_time(const double t) const;

    /// Return the first step of the phase with the largest steps.
    TimeStep
    largest_step() const;

    double
    end_time() const
    {
      return phases.back().end;
    }

    const std::vector<Phase> phases;
  };
} // namespace Viscoplastic
