// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <boost/property_tree/ptree_fwd.hpp>

#include <string>

namespace Viscoplastic
{
  struct ParameterLine;

  // What is wrong with a line of a parameter file, and what would be right.
  // @p declared: declared_entries() of the handler.

  /// A sentence that there is no such entry or subsection, and what may have
  /// been meant.
  std::string
  unknown_name(const ParameterLine               &line,
               const boost::property_tree::ptree &declared);

  /// A sentence about a line that ParameterHandler does not understand.
  std::string
  no_statement(const std::string &text);

  /// A sentence that names the values that the entry of the line allows.
  std::string
  wrong_value(const ParameterLine               &line,
              const boost::property_tree::ptree &declared);

  /// The values that a pattern of ParameterHandler allows, in words: "one of a,
  /// b".
  std::string
  allowed_values(const std::string &pattern_description);
} // namespace Viscoplastic
