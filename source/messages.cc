// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>

#include <viscoplastic_contact/messages.h>

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
    std::istringstream words(message.str());
    std::string        line, word;
    while (words >> word)
      line += (line.empty() ? "" : " ") + word;
    return line;
  }
} // namespace Viscoplastic
