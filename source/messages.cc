// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/messages.h>

#include <regex>
#include <sstream>

namespace Viscoplastic
{
  std::string
  reason(const std::exception &exception)
  {
    std::ostringstream message;
    if (const auto *e = dynamic_cast<const dealii::ExceptionBase *>(&exception))
      e->print_info(message);
    else
      message << exception.what();
    return dealii::Utilities::trim(
      std::regex_replace(message.str(), std::regex("\\s+"), " "));
  }
} // namespace Viscoplastic
