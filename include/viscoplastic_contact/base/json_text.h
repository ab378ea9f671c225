// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace Viscoplastic
{
  /**
   * JSON as our files have it: indented, with a newline at the end. Numbers
   * have all their digits, or are null where they are not finite. Texts may
   * hold any bytes, as names of files do: what is no UTF-8 becomes the
   * replacement character.
   */
  std::string
  json_text(const nlohmann::ordered_json &json);
} // namespace Viscoplastic
