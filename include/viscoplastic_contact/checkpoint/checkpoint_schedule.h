// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  /// Decides when checkpoints are due without a signal, and when the wall time
  /// limit is reached. Clocks of ranks differ, so that one rank has to decide
  /// for all. Times are seconds since the start of the process.
  class CheckpointSchedule
  {
  public:
    explicit CheckpointSchedule(const CheckpointParameters &wanted)
      : wanted(wanted)
    {}

    /// Start the clocks before the first step of this process.
    void
    begin_steps(const double now)
    {
      last_checkpoint = last_step = now;
    }

    struct Decision
    {
      /// Whether a checkpoint is due by number of steps or wall time.
      bool is_due = false;
      /// Whether another step as long as the last one would exceed the limit.
      bool is_late = false;
    };

    /// Return the decision after step @p n. Regular checkpoints are also due
    /// after the last step, for runs that are continued by another phase.
    Decision
    after_step(const unsigned int n, const bool is_last_step, const double now)
    {
      Decision decision;
      decision.is_due =
        (wanted.every_n_steps > 0 && n % wanted.every_n_steps == 0) ||
        (wanted.wall_time_interval > 0. &&
         now - last_checkpoint >= wanted.wall_time_interval) ||
        (is_last_step && is_regular());
      decision.is_late = wanted.wall_time_limit > 0. &&
                         now + (now - last_step) >= wanted.wall_time_limit;
      last_step = now;
      return decision;
    }

    /// Restart the clock after a checkpoint has been written.
    void
    restart_clock(const double now)
    {
      last_checkpoint = now;
    }

    /// Whether the scene asks for checkpoints by steps or wall time.
    bool
    is_regular() const
    {
      return wanted.every_n_steps > 0 || wanted.wall_time_interval > 0.;
    }

  private:
    const CheckpointParameters wanted;
    double                     last_checkpoint = 0., last_step = 0.;
  };
} // namespace Viscoplastic
