// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// One phase of `Time/Phases': its end as the scene gives it, and its steps.
  struct StepsUntil
  {
    std::string  end;
    unsigned int n_steps;
  };

  /// The phases of a text that TimeSchedule accepts.
  std::vector<StepsUntil>
  read_phases(const std::string &phases);

  /// Every phase with @p factor times its steps, rounded up.
  std::vector<StepsUntil>
  scale_phases(std::vector<StepsUntil> phases, const double factor);

  /// The phases as `Time/Phases' has them.
  std::string
  write_phases(const std::vector<StepsUntil> &phases);

  /// The steps of all phases together.
  unsigned int
  n_steps(const std::vector<StepsUntil> &phases);
} // namespace Viscoplastic
