// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/number_range.h>

#include <sstream>

namespace Viscoplastic
{
  std::string
  out_of_range(const std::string &what,
               const double       value,
               const double       least,
               const double       largest)
  {
    std::ostringstream message;
    message << what << " is " << value << "; it must lie between " << least
            << " and " << largest
            << ", where squares stay within the range of floating-point "
               "numbers; choose other units or look for a datum that is too "
               "large or too small.";
    return message.str();
  }
} // namespace Viscoplastic
