// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace Viscoplastic
{
  /// Ids of boundaries and materials go up to this in mesh files, parameter
  /// files and expressions.
  constexpr unsigned int largest_id = 999999999;
} // namespace Viscoplastic
