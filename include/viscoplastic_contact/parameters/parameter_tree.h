// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <boost/property_tree/ptree.hpp>

#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// Everything that is declared, in the order of declaration: a node with a
  /// leaf `value' is an entry, with the leaves `default_value', `documentation'
  /// and `pattern_description'; others are subsections.
  boost::property_tree::ptree
  declared_entries(const ParameterHandler &handler);

  std::string
  as_json(const boost::property_tree::ptree &tree);

  bool
  is_entry(const boost::property_tree::ptree &node);

  /// Paths `Section/Entry' and values of the entries below a node of it, in the
  /// order of declaration; @p path: that of the node, and a slash.
  std::vector<std::pair<std::string, std::string>>
  values_of(const boost::property_tree::ptree &node,
            const std::string                 &path = "");
} // namespace Viscoplastic
