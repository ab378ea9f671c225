// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/json_text.h>

#include <nlohmann/json.hpp>

namespace Viscoplastic
{
  std::string
  json_text(const nlohmann::ordered_json &json)
  {
    return json.dump(2,
                     ' ',
                     /* ensure_ascii = */ false,
                     nlohmann::ordered_json::error_handler_t::replace) +
           '\n';
  }
} // namespace Viscoplastic
