// SPDX-License-Identifier: LGPL-2.1-or-later
// Boost's JSON parser uses placeholders that boost says are deprecated.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS

#include <viscoplastic_contact/parameters/parameter_tree.h>

#include <boost/property_tree/json_parser.hpp>

#include <sstream>

namespace Viscoplastic
{
  boost::property_tree::ptree
  declared_entries(const ParameterHandler &handler)
  {
    std::stringstream json;
    handler.print_parameters(json,
                             ParameterHandler::JSON |
                               ParameterHandler::KeepDeclarationOrder);
    boost::property_tree::ptree tree;
    boost::property_tree::read_json(json, tree);
    return tree;
  }



  bool
  is_entry(const boost::property_tree::ptree &node)
  {
    const auto value = node.find("value");
    return value != node.not_found() && value->second.empty();
  }



  std::vector<std::pair<std::string, std::string>>
  values_of(const boost::property_tree::ptree &node, const std::string &path)
  {
    std::vector<std::pair<std::string, std::string>> entries;
    for (const auto &[name, below] : node)
      if (is_entry(below))
        entries.emplace_back(path + name, below.get<std::string>("value"));
      else
        for (auto &entry : values_of(below, path + name + '/'))
          entries.push_back(std::move(entry));
    return entries;
  }
} // namespace Viscoplastic
