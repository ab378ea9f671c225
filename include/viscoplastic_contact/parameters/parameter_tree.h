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

  /// Return all declarations of a handler in their order: a node with a leaf
  /// `value' is an entry, with the leaves `default_value', `documentation' and
  /// `pattern_description'; other nodes are subsections.
  boost::property_tree::ptree
  declared_entries(const ParameterHandler &handler);

  bool
  is_entry(const boost::property_tree::ptree &node);

  /// Return paths `Section/Entry' and values of all entries below a node in the
  /// order of declaration; @p path is that of the node, with a slash.
  std::vector<std::pair<std::string, std::string>>
  values_of(const boost::property_tree::ptree &node,
            const std::string                 &path = "");
} // namespace Viscoplastic
