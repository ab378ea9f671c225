// SPDX-License-Identifier: LGPL-2.1-or-later
// Boost's JSON parser uses placeholders that boost says are deprecated.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS

#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/ids.h>
#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/parameters/parameter_file.h>

#include <boost/property_tree/json_parser.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    using Tree = boost::property_tree::ptree;



    /// Names of the children of a node that are entries, or subsections.
    std::vector<std::string>
    names(const Tree &node, const bool entries)
    {
      std::vector<std::string> result;
      for (const auto &[name, child] : node)
        if (is_entry(child) == entries)
          result.push_back(name);
      return result;
    }



    /// The child of exactly this name, or null. A ptree's own search takes
    /// dots for separators.
    const Tree *
    child(const Tree &node, const std::string &name)
    {
      const auto position = node.find(name);
      return position == node.not_found() ? nullptr : &position->second;
    }



    /// The subsections that have an entry of this name.
    void
    find_owners(const Tree               &node,
                const std::string        &path,
                const std::string        &entry,
                std::vector<std::string> &owners)
    {
      for (const auto &[name, below] : node)
        if (!is_entry(below))
          {
            const Tree *found = child(below, entry);
            if (found != nullptr && is_entry(*found))
              owners.push_back("'" + path + name + "'");
            find_owners(below, path + name + '/', entry, owners);
          }
    }



    /// "; the nearest is 'a'" or "; there are a, b, c".
    std::string
    suggestion(const std::string              &name,
               const std::vector<std::string> &candidates,
               const std::string              &what)
    {
      const std::string nearest = nearest_name(name, candidates);
      if (!nearest.empty())
        return "; did you mean '" + nearest + "'?";
      if (candidates.empty())
        return "; it has no " + what + ".";
      return "; its " + what + " are: " + enumeration(candidates, 30) + ".";
    }



    /// `boundary3' as the `Boundary 3' that it should be, or nothing.
    std::string
    numbered_subsection(const std::string &name)
    {
      for (const std::string kind : {"Boundary", "Material"})
        if (name.size() > kind.size() &&
            std::equal(
              kind.begin(), kind.end(), name.begin(), [](char a, char b) {
                return std::tolower(static_cast<unsigned char>(a)) ==
                       std::tolower(static_cast<unsigned char>(b));
              }))
          {
            const std::string id = Utilities::trim(name.substr(kind.size()));
            if (id.size() < 10 &&
                id.find_first_not_of("0123456789") == std::string::npos)
              return kind + ' ' + id;
          }
      return "";
    }



    std::string
    unknown_section(const ParameterStatement &statement,
                    const std::size_t         depth,
                    const Tree               &parent,
                    const Tree               &root)
    {
      const auto       &section = statement.sections[depth];
      const std::string name    = excerpt(section.name);
      if (depth == 0)
        {
          const std::string message =
            statement.origin() + ": there is no subsection '" + name + "'";
          if (name == "Boundary")
            return message + "; a boundary needs its id, as in `Boundary 0'.";
          const std::string numbered = numbered_subsection(section.name);
          if (!numbered.empty())
            return message + "; did you mean '" + numbered + "'?";
          return message +
                 suggestion(section.name, names(parent, false), "subsections");
        }
      const auto       &outer   = statement.sections[depth - 1];
      const std::string message = statement.origin() + ": '" +
                                  excerpt(outer.name) +
                                  "' has no subsection '" + name + "'";
      if (section.line > 0 && (child(root, section.name) != nullptr ||
                               !numbered_subsection(section.name).empty()))
        return message +
               ", which stands outside of others; is there no `end' "
               "to the one that begins in line " +
               std::to_string(outer.line) + "?";
      return message +
             suggestion(section.name, names(parent, false), "subsections");
    }



    std::string
    unknown_entry(const ParameterStatement &statement,
                  const Tree               &section,
                  const Tree               &root)
    {
      const std::string &entry   = statement.entry;
      std::string        message = statement.origin() + ": ";
      if (statement.sections.empty())
        message +=
          "there is no entry '" + excerpt(entry) + "' outside of subsections";
      else
        message +=
          "'" +
          excerpt(
            ParameterStatement{"", 0, statement.sections, "", ""}.path()) +
          "' has no entry '" + excerpt(entry) + "'";
      if (child(section, entry) != nullptr)
        return message + "; that is the name of a subsection.";
      std::vector<std::string> owners;
      if (child(root, entry) != nullptr && is_entry(*child(root, entry)))
        return message + "; it belongs outside of all subsections.";
      find_owners(root, "", entry, owners);
      if (!owners.empty())
        return message + "; '" + entry + "' belongs to " +
               enumeration(owners, 6) + ".";
      return message + suggestion(entry, names(section, true), "entries");
    }
  } // namespace



  Tree
  declared_entries(const ParameterHandler &handler)
  {
    std::stringstream json;
    handler.print_parameters(json,
                             ParameterHandler::JSON |
                               ParameterHandler::KeepDeclarationOrder);
    Tree tree;
    boost::property_tree::read_json(json, tree);
    return tree;
  }



  bool
  is_entry(const Tree &node)
  {
    const auto value = node.find("value");
    return value != node.not_found() && value->second.empty();
  }



  std::string
  allowed_values(const std::string &pattern_description)
  {
    const std::string &text = pattern_description;
    // What stands between a prefix and a suffix, if they are there.
    const auto inside = [&text](const std::string &prefix,
                                const std::string &suffix,
                                std::string       &found) {
      if (text.compare(0, prefix.size(), prefix) != 0)
        return false;
      const std::size_t end = text.rfind(suffix);
      if (end == std::string::npos || end < prefix.size())
        return false;
      found = text.substr(prefix.size(), end - prefix.size());
      return true;
    };
    // "a...b" with what stands for no bounds.
    const auto range = [](const std::string &bounds,
                          const std::string &lowest,
                          const std::string &highest,
                          const std::string &what) {
      const std::size_t dots  = bounds.find("...");
      const std::string lower = bounds.substr(0, dots),
                        upper = bounds.substr(dots + 3);
      if (lower != lowest && upper != highest)
        return what + " from " + lower + " to " + upper;
      if (lower != lowest)
        return what + " of at least " + lower;
      return upper != highest ? what + " of at most " + upper : what;
    };

    std::string found;
    if (inside("[Selection ", " ]", found))
      {
        std::vector<std::string> values =
          Utilities::split_string_list(found, '|');
        // A default that stands for nothing is no choice.
        values.erase(std::remove(values.begin(), values.end(), "not given"),
                     values.end());
        return "one of " + enumeration(values, 50);
      }
    if (inside("[Integer range ", " (inclusive)]", found))
      return range(found,
                   std::to_string(std::numeric_limits<int>::min()),
                   std::to_string(std::numeric_limits<int>::max()),
                   "a whole number");
    if (text == "[Integer]")
      return "a whole number";
    if (inside("[Double ", " (inclusive)]", found))
      return range(found, "-MAX_DOUBLE", "MAX_DOUBLE", "a number");
    if (text == "[Bool]")
      return "true or false";
    if (text == "[Anything]")
      return "any text";
    if (inside("[List of <", "> of length", found))
      {
        std::string length;
        inside("[List of <" + found + "> of length ", " (inclusive)]", length);
        const std::size_t dots  = length.find("...");
        const std::string lower = length.substr(0, dots),
                          upper = length.substr(dots + 3);
        return (lower == upper ? "a list of " + lower + " items" : "a list") +
               " separated by commas, each " + allowed_values(found);
      }
    std::string words =
      Patterns::pattern_factory(text)->description(Patterns::PatternBase::Text);
    words[0] =
      static_cast<char>(std::tolower(static_cast<unsigned char>(words[0])));
    return words;
  }



  void
  Parameters::declare()
  {
    const auto in_subsection = [this](const std::string &name, auto &entries) {
      handler.enter_subsection(name);
      entries.declare(handler);
      handler.leave_subsection();
    };
    handler.add_parameter("Dimension",
                          dimension,
                          "2 (plane strain) or 3.",
                          Patterns::Integer(2, 3));
    in_subsection("Geometry", geometry);
    in_subsection("Material", material);
    in_subsection("Material", stress);
    for (auto &[id, numbered] : materials)
      in_subsection("Material " + std::to_string(id), numbered);
    in_subsection("Loads", loads);
    in_subsection("Initial state", initial_state);
    in_subsection("Exact solution", exact_solution);
    for (auto &[id, boundary] : boundaries)
      in_subsection("Boundary " + std::to_string(id), boundary);
    in_subsection("Time", time);
    in_subsection("Step control", step_control);
    in_subsection("Solver", solver);
    in_subsection("Error control", error_control);
    in_subsection("Mesh refinement", refinement);
    in_subsection("Output", output);
    in_subsection("Checkpoint", checkpoint);
    in_subsection("Study", study);
  }



  void
  Parameters::find_numbered_subsections(
    const std::vector<ParameterStatement> &statements)
  {
    for (const ParameterStatement &statement : statements)
      {
        if (statement.sections.empty())
          continue;
        const std::string &name  = statement.sections[0].name;
        const std::size_t  blank = name.find(' ');
        const std::string  kind  = name.substr(0, blank);
        if (blank == std::string::npos ||
            (kind != "Boundary" && kind != "Material"))
          continue;
        const std::string digits = name.substr(blank + 1);
        const bool        is_id =
          digits.size() <= 10 &&
          digits.find_first_not_of("0123456789") == std::string::npos &&
          std::stoull(digits) <= largest_id;
        AssertThrow(is_id,
                    ExcMessage(statement.origin() + ": '" + excerpt(digits) +
                               "' in the subsection '" + excerpt(name) +
                               "' is no id; it must be a whole number from 0 "
                               "to " +
                               std::to_string(largest_id) + "."));
        const auto id = static_cast<unsigned int>(std::stoul(digits));
        if (kind == "Boundary")
          boundaries[id];
        else
          materials[id];
      }
  }



  void
  Parameters::apply(const ParameterStatement &statement, const Tree &declared)
  {
    const Tree *section = &declared;
    for (std::size_t depth = 0; depth < statement.sections.size(); ++depth)
      {
        const Tree *inner = child(*section, statement.sections[depth].name);
        AssertThrow(inner != nullptr && !is_entry(*inner),
                    ExcMessage(
                      unknown_section(statement, depth, *section, declared)));
        section = inner;
      }
    if (statement.entry.empty())
      return;
    const Tree *entry = child(*section, statement.entry);
    AssertThrow(entry != nullptr && is_entry(*entry),
                ExcMessage(unknown_entry(statement, *section, declared)));

    const std::string pattern = entry->get<std::string>("pattern_description");
    if (!Patterns::pattern_factory(pattern)->match(statement.value))
      {
        std::string              near;
        std::vector<std::string> values;
        if (pattern.compare(0, 11, "[Selection ") == 0)
          near =
            nearest_name(statement.value,
                         Utilities::split_string_list(
                           pattern.substr(11, pattern.rfind(' ') - 11), '|'));
        AssertThrow(false,
                    ExcMessage(
                      statement.origin() + ": '" + statement.path() + "' is '" +
                      excerpt(statement.value) + "'; it must be " +
                      allowed_values(pattern) +
                      (near.empty() ? "." : "; did you mean '" + near + "'?")));
      }

    // Numbered materials replace the one for all cells. The record of a run
    // has its entries nevertheless, with their defaults.
    const std::string &top =
      statement.sections.empty() ? "" : statement.sections[0].name;
    if (top == "Material" && !materials.empty() &&
        statement.entry != "Volumetric integration" &&
        statement.entry != "Stress history")
      AssertThrow(statement.value == entry->get<std::string>("default_value"),
                  ExcMessage(statement.origin() + ": '" + statement.path() +
                             "' cannot be set beside 'Material " +
                             std::to_string(materials.begin()->first) +
                             "'; where materials have numbers, each is "
                             "described in its own subsection, and 'Material' "
                             "has only 'Volumetric integration' and 'Stress "
                             "history'."));

    for (const auto &open : statement.sections)
      handler.enter_subsection(open.name);
    handler.set(statement.entry, statement.value);
    for (std::size_t depth = 0; depth < statement.sections.size(); ++depth)
      handler.leave_subsection();
  }



  void
  Parameters::locate_mesh_file(const ParameterStatement &statement)
  {
    namespace fs = std::filesystem;
    const fs::path  given(geometry.file);
    std::error_code error;
    const fs::path  beside = given.is_absolute() || statement.file.empty() ?
                               given :
                               fs::path(statement.file).parent_path() / given;
    const fs::path  found  = fs::exists(beside, error) ? beside : given;
    AssertThrow(fs::exists(found, error),
                ExcMessage(
                  statement.origin() + ": 'Geometry/File' is '" +
                  excerpt(geometry.file) + "', but there is no such file" +
                  (beside == given ? "." :
                                     ", neither beside '" + statement.file +
                                       "' nor in the working directory.")));
    handler.enter_subsection("Geometry");
    handler.set("File", fs::absolute(found).lexically_normal().string());
    handler.leave_subsection();
  }



  Parameters::Parameters(const std::vector<std::string> &files,
                         const std::vector<std::string> &overrides)
    : file(files.empty() ? "" : files[0])
  {
    std::vector<ParameterStatement> statements;
    for (const std::string &name : files)
      for (ParameterStatement &statement : read_parameter_text(name))
        statements.push_back(std::move(statement));
    for (const std::string &text : overrides)
      statements.push_back(read_override(text));

    find_numbered_subsections(statements);
    declare();
    const Tree                declared  = declared_entries(handler);
    const ParameterStatement *mesh_file = nullptr;
    for (const ParameterStatement &statement : statements)
      {
        apply(statement, declared);
        if (statement.path() == "Geometry/File")
          mesh_file = &statement;
      }
    if (!geometry.file.empty())
      locate_mesh_file(*mesh_file);
    refinement.check();
    std::ostringstream message;
    message << "'Solver/Contact tolerance' = " << solver.contact_tolerance
            << " is below rounding; it must be 0 or lie between 1e-14 and 0.1.";
    AssertThrow(solver.contact_tolerance == 0. ||
                  solver.contact_tolerance >= 1e-14,
                ExcMessage(message.str()));
  }



  std::map<std::string, std::string>
  Parameters::values() const
  {
    std::map<std::string, std::string>                           result;
    const std::function<void(const Tree &, const std::string &)> collect =
      [&](const Tree &node, const std::string &path) {
        for (const auto &[name, below] : node)
          if (is_entry(below))
            result[path + name] = below.get<std::string>("value");
          else
            collect(below, path + name + '/');
      };
    collect(declared_entries(handler), "");
    return result;
  }



  Parameters::Parameters(const std::string &file)
    : Parameters(std::vector<std::string>{file})
  {}
} // namespace Viscoplastic
