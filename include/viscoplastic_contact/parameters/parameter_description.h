// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace Viscoplastic
{
  /**
   * A parameter file with every entry: meaning, unit, default and allowed
   * values in comments, and `Boundary 0' and `Material 1' in the place of all
   * ids. It is itself a scene.
   */
  std::string
  describe_parameters();

  /// The same as a chapter of the manual, doc/parameters.md.
  std::string
  describe_parameters_as_markdown();
} // namespace Viscoplastic
