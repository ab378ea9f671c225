// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <exception>
#include <set>
#include <string>

namespace Viscoplastic
{
  /**
   * What an exception says to the user as one line, without the place in the
   * code where it was thrown.
   */
  std::string
  reason(const std::exception &exception);


  /// Ids of boundaries or materials, separated by commas.
  std::string
  list(const std::set<unsigned int> &ids);
} // namespace Viscoplastic
