// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/checkpoint/checkpoint_schedule.h>

namespace Viscoplastic
{
  CheckpointSchedule::Decision
  CheckpointSchedule::after_step(const unsigned int n,
                                 const bool         is_last_step,
                                 const double       now)
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
} // namespace Viscoplastic
