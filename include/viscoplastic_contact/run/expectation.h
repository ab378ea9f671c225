// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <string>

namespace Viscoplastic
{
  /// What a run to a tolerance has to know before its first step.
  struct Expectation
  {
    /// About how large the solution becomes, in the energy norm or by its
    /// quantity of interest. Zero, and @p failure says why, if nobody knows.
    double      size = 0.;
    std::string failure;
  };

  /// Finds that out. Collective.
  using PilotRun = std::function<Expectation()>;
} // namespace Viscoplastic
