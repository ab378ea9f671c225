// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// What has become of the parameters since a checkpoint.
  struct ParameterChanges
  {
    /// "'Time/Phases' is 2: 20 (was 1: 10)", those that a run may go on with
    /// and those with which it cannot.
    std::vector<std::string> allowed, forbidden;
    /// Whether loads, conditions or laws are among those that are allowed.
    bool of_data = false;
  };

  ParameterChanges
  compare_parameters(const std::map<std::string, std::string> &old_values,
                     const std::map<std::string, std::string> &new_values);
} // namespace Viscoplastic
