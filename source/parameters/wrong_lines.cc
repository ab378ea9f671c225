// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/parameter_text.h>
#include <viscoplastic_contact/parameters/parameter_tree.h>
#include <viscoplastic_contact/parameters/wrong_lines.h>

#include <boost/property_tree/ptree.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <regex>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  namespace
  {
    using Tree  = boost::property_tree::ptree;
    using Names = std::vector<std::string>;
    /// Paths `Section/Entry' and values, in the order of declaration.
    using NamedValues = std::vector<std::pair<std::string, std::string>>;



    bool
    contains(const Names &names, const std::string &name)
    {
      return std::find(names.begin(), names.end(), name) != names.end();
    }



    /// Return the names of the entries in @p section, or of its subsections.
    Names
    names_in(const std::string &section,
             const NamedValues &entries,
             const bool         of_subsections)
    {
      Names names;
      for (const auto &[path, value] : entries)
        if (path.compare(0, section.size(), section) == 0)
          {
            const std::string below = path.substr(section.size());
            const std::string name  = below.substr(0, below.find('/'));
            if ((name != below) == of_subsections && !contains(names, name))
              names.push_back(name);
          }
      return names;
    }
  } // namespace



  std::string
  unknown_name(const ParameterLine &line, const Tree &declared)
  {
    const NamedValues entries = values_of(declared);
    const bool        opens   = line.is_opening;
    const std::string what    = opens ? "subsection" : "entry";
    const std::string parent  = line.section.substr(0, line.section.rfind('/'));
    const std::string said =
      (parent.empty() ? "there is no " + what :
                        "'" + excerpt(parent) + "' has no " + what) +
      " '" + excerpt(line.name) + "'" +
      (parent.empty() && !opens ? " outside of subsections" : "");

    Names outermost = names_in("", entries, opens);
    if (opens)
      {
        if (line.name == "Boundary")
          return said + "; a boundary needs its id, as in `Boundary 0'.";
        if (line.name == "Table")
          return said + "; a table needs a number, as in `Table 1'.";
        // Numbered subsections are valid with any number.
        const std::size_t id = line.name.find_last_not_of("0123456789") + 1;
        for (const std::string kind : {"Boundary ", "Material ", "Table "})
          if (id < line.name.size())
            outermost.push_back(kind + line.name.substr(id));
        if (!parent.empty() && contains(outermost, line.name))
          return said +
                 ", which stands outside of others; is there no `end' to '" +
                 excerpt(parent) + "'?";
      }
    else
      {
        if (contains(names_in(line.section, entries, true), line.name))
          return said + "; that is the name of a subsection.";
        if (contains(outermost, line.name))
          return said + "; it belongs outside of all subsections.";
        Names owners;
        for (const auto &[path, value] : entries)
          {
            const std::size_t slash = path.rfind('/');
            if (slash != std::string::npos &&
                path.substr(slash + 1) == line.name)
              owners.push_back("'" + path.substr(0, slash) + "'");
          }
        if (!owners.empty())
          return said + "; '" + line.name + "' belongs to " +
                 enumeration(owners, 6) + ".";
      }

    Names candidates =
      parent.empty() ? outermost : names_in(line.section, entries, opens);
    const std::string several   = opens ? "subsections" : "entries",
                      otherwise = candidates.empty() ?
                                    "; it has no " + several + "." :
                                    "; its " + several +
                                      " are: " + enumeration(candidates, 30) +
                                      ".";
    // Whole paths are written in the wrong way, as `Time.Phases'.
    if (!opens)
      for (const auto &[path, value] : entries)
        candidates.push_back(path);
    return said + did_you_mean(line.name, candidates, otherwise);
  }



  std::string
  allowed_values(const std::string &pattern_description)
  {
    static const std::regex selection("\\[Selection (.*) \\]"),
      range("\\[(Integer range|Double) (.*)\\.\\.\\.(.*) \\(inclusive\\)\\]"),
      items("\\[List of <(.*)> of length (.*)\\.\\.\\.(.*) \\(inclusive\\)\\]");
    static const std::map<std::string, std::string> others{
      {"[Integer]", "a whole number"},
      {"[Bool]", "true or false"},
      {"[Anything]", "any text"}};

    std::smatch part;
    if (std::regex_match(pattern_description, part, selection))
      {
        std::vector<std::string> values =
          Utilities::split_string_list(part[1], '|');
        // The default "not given" cannot be chosen.
        values.erase(std::remove(values.begin(), values.end(), "not given"),
                     values.end());
        return "one of " + enumeration(values, 50);
      }
    if (std::regex_match(pattern_description, part, range))
      {
        const auto bound = [&part](const int i, const int none) {
          return part[i] == "-MAX_DOUBLE" || part[i] == "MAX_DOUBLE" ||
                     part[i] == std::to_string(none) ?
                   "" :
                   part.str(i);
        };
        const std::string lower = bound(2, std::numeric_limits<int>::min());
        const std::string upper = bound(3, std::numeric_limits<int>::max());
        return (part[1] == "Double" ? "a number" : "a whole number") +
               (!lower.empty() && !upper.empty() ?
                  " from " + lower + " to " + upper :
                !lower.empty() ? " of at least " + lower :
                !upper.empty() ? " of at most " + upper :
                                 "");
      }
    if (std::regex_match(pattern_description, part, items))
      {
        const bool has_any_length =
          part[2] == "0" &&
          part[3] == std::to_string(std::numeric_limits<unsigned int>::max());
        const std::string each = allowed_values(part[1]);
        if (has_any_length && each.compare(0, 7, "one of ") == 0)
          return "names separated by commas, each " + each;
        return (part[2] == part[3] ? "a list of " + part.str(2) + " items" :
                                     "a list") +
               " separated by commas, each " + each;
      }
    const auto other = others.find(pattern_description);
    return other != others.end() ?
             other->second :
             Patterns::pattern_factory(pattern_description)
               ->description(Patterns::PatternBase::Text);
  }



  std::string
  wrong_value(const ParameterLine &line, const Tree &declared)
  {
    const std::string path    = line.path();
    const auto        pattern = declared.get<std::string>(
      Tree::path_type(path + "/pattern_description", '/'));
    const Names choices =
      pattern.compare(0, 11, "[Selection ") == 0 ?
        Utilities::split_string_list(pattern.substr(11,
                                                    pattern.rfind(' ') - 11),
                                     '|') :
        Names();
    return "'" + path + "' is '" + excerpt(line.value) + "'; it must be " +
           allowed_values(pattern) + did_you_mean(line.value, choices);
  }
} // namespace Viscoplastic
