// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <boost/property_tree/ptree_fwd.hpp>

#include <string>

namespace Viscoplastic
{
  struct ParameterLine;

  // Messages about wrong lines of a parameter file, and what would be right. @p
  // declared are the declared_entries() of the handler.

  /// Return a sentence that there is no such entry or subsection, and what may
  /// have been meant.
  std::string
  unknown_name(const ParameterLine               &line,
               const boost::property_tree::ptree &declared);

  /// Return a sentence with the values that the entry of the line allows.
  std::string
  wrong_value(const ParameterLine               &line,
              const boost::property_tree::ptree &declared);

  /// Return the values that a pattern of ParameterHandler allows, in words:
  /// "one of a, b".
  std::string
  allowed_values(const std::string &pattern_description);
} // namespace Viscoplastic
