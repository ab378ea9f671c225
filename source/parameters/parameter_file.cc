// SPDX-License-Identifier: LGPL-2.1-or-later
// Boost's JSON parser uses placeholders that boost says are deprecated.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS

#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/laws/law_library.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/parameter_text.h>
#include <viscoplastic_contact/parameters/table_sections.h>

#include <boost/property_tree/json_parser.hpp>

#include <algorithm>
#include <limits>
#include <regex>
#include <set>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    using Tree = boost::property_tree::ptree;

    const std::string shared_libraries_entry = "Additional shared libraries";



    using Names = std::vector<std::string>;
    /// Paths `Section/Entry' and values, in the order of declaration.
    using Entries = std::vector<std::pair<std::string, std::string>>;

    Entries
    collect(const Tree &node, const std::string &path = "")
    {
      Entries entries;
      for (const auto &[name, below] : node)
        if (is_entry(below))
          entries.emplace_back(path + name, below.get<std::string>("value"));
        else
          for (auto &entry : collect(below, path + name + '/'))
            entries.push_back(std::move(entry));
      return entries;
    }



    std::string
    comma_separated(const Names &names)
    {
      std::string result;
      for (const std::string &name : names)
        result += (result.empty() ? "" : ", ") + name;
      return result;
    }



    bool
    contains(const Names &names, const std::string &name)
    {
      return std::find(names.begin(), names.end(), name) != names.end();
    }



    /// The names of the entries in @p section, or of its subsections.
    Names
    names_in(const std::string &section,
             const Entries     &entries,
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



    /// The name of a line with `/' for each `.', if that begins with a
    /// subsection; otherwise empty.
    std::string
    with_slashes(const ParameterLine &line, const Entries &entries)
    {
      const std::size_t dot = line.name.find('.');
      if (dot == std::string::npos)
        return "";
      std::string path = line.section + line.name;
      std::replace(path.begin(), path.end(), '.', '/');
      const std::string section = path.substr(0, path.find('/'));
      const std::string kind    = section.substr(0, section.find(' '));
      return contains(names_in("", entries, true), section) ||
                 ((kind == "Boundary" || kind == "Material") &&
                  kind != section) ?
               path :
               "";
    }



    /// That there is no such entry or subsection, and what may have been meant.
    std::string
    unknown_name(const ParameterLine &line, const Tree &declared)
    {
      const Entries     entries = collect(declared);
      const bool        opens   = line.is_opening;
      const std::string what    = opens ? "subsection" : "entry";
      const std::string parent =
        line.section.substr(0, line.section.rfind('/'));
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
          // Any number makes a subsection.
          const std::size_t id = line.name.find_last_not_of("0123456789") + 1;
          for (const std::string kind : {"Boundary ", "Material ", "Table "})
            if (id < line.name.size())
              outermost.push_back(kind + line.name.substr(id));
          if (line.number > 0 && !parent.empty() &&
              contains(outermost, line.name))
            {
              const ParameterLine *around = &line;
              do
                --around;
              while (!around->is_opening ||
                     around->section + around->name != parent);
              return said +
                     ", which stands outside of others; is there no `end' to "
                     "the one that begins in line " +
                     std::to_string(around->number) + "?";
            }
        }
      else
        {
          const std::string path = with_slashes(line, entries);
          if (!path.empty())
            return said + (line.number == 0 ?
                             "; subsections are separated by `/', as in '" +
                               excerpt(path) + "'." :
                             "; it is `set " +
                               excerpt(path.substr(path.rfind('/') + 1)) +
                               "' within `subsection " +
                               excerpt(path.substr(0, path.find('/'))) + "'.");
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

      const Names candidates =
        parent.empty() ? outermost : names_in(line.section, entries, opens);
      const std::string nearest = nearest_name(line.name, candidates);
      const std::string several = opens ? "subsections" : "entries";
      return said + (!nearest.empty()   ? "; did you mean '" + nearest + "'?" :
                     candidates.empty() ? "; it has no " + several + "." :
                                          "; its " + several + " are: " +
                                            enumeration(candidates, 30) + ".");
    }



    /// What is wrong with a line that ParameterHandler does not understand.
    std::string
    no_statement(const std::string &text)
    {
      const std::string word = text.substr(0, text.find(' '));
      const std::string said = "'" + excerpt(text) + "' ";
      if (word == "set")
        return said +
               (text.find('=') == std::string::npos ?
                  "has no `='" :
                  "has no name before `='") +
               "; it must be `set Entry = value'.";
      if (word == "end")
        return "`end' stands alone on its line, but '" +
               excerpt(Utilities::trim(text.substr(3))) + "' follows.";
      if (word == "subsection" || word == "include")
        return "`" + word + "' needs a " +
               (word == "include" ? "file" : "name") + " after it.";
      return said + "is no statement; a line is `set Entry = value', "
                    "`subsection Name', `end', `include file', or a comment "
                    "after `#'.";
    }



    /// What the entry of the line may be instead.
    std::string
    wrong_value(const ParameterLine &line, const Tree &declared)
    {
      const std::string path    = line.section + line.name;
      const auto        pattern = declared.get<std::string>(
        Tree::path_type(path + "/pattern_description", '/'));
      const std::string near =
        pattern.compare(0, 11, "[Selection ") == 0 ?
          nearest_name(line.value,
                       Utilities::split_string_list(
                         pattern.substr(11, pattern.rfind(' ') - 11), '|')) :
          "";
      return "'" + path + "' is '" + excerpt(line.value) + "'; it must be " +
             allowed_values(pattern) +
             (near.empty() ? "." : "; did you mean '" + near + "'?");
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
    static const std::regex selection("\\[Selection (.*) \\]"),
      selections("\\[MultipleSelection (.*) \\]"),
      range("\\[(Integer range|Double) (.*)\\.\\.\\.(.*) \\(inclusive\\)\\]"),
      items("\\[List of <(.*)> of length (.*)\\.\\.\\.(.*) \\(inclusive\\)\\]");
    static const std::map<std::string, std::string> others{
      {"[Integer]", "a whole number"},
      {"[Bool]", "true or false"},
      {"[Anything]", "any text"}};

    std::smatch part;
    if (std::regex_match(pattern_description, part, selections))
      return "names separated by commas, each one of " +
             enumeration(Utilities::split_string_list(part[1], '|'), 50);
    if (std::regex_match(pattern_description, part, selection))
      {
        std::vector<std::string> values =
          Utilities::split_string_list(part[1], '|');
        // A default that stands for nothing is no choice.
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
      return (part[2] == part[3] ? "a list of " + part.str(2) + " items" :
                                   "a list") +
             " separated by commas, each " + allowed_values(part[1]);
    const auto other = others.find(pattern_description);
    return other != others.end() ?
             other->second :
             Patterns::pattern_factory(pattern_description)
               ->description(Patterns::PatternBase::Text);
  }



  void
  Parameters::load_shared_libraries(const std::vector<ParameterLine> &lines)
  {
    const auto line =
      std::find_if(lines.rbegin(), lines.rend(), [](const auto &one) {
        return one.section.empty() && one.name == shared_libraries_entry;
      });
    if (line == lines.rend() || line->value.empty())
      {
        laws = built_in_laws();
        return;
      }
    for (const std::string &library :
         Utilities::split_string_list(line->value, ','))
      {
        AssertThrow(!library.empty(),
                    ExcMessage(line->origin() + ": '" + shared_libraries_entry +
                               "' has an empty name between commas."));
        shared_libraries.push_back(line->locate(library));
      }
    try
      {
        laws = laws_with_libraries(shared_libraries);
      }
    catch (const std::exception &exception)
      {
        AssertThrow(false,
                    ExcMessage(line->origin() + ": " + reason(exception)));
      }
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
    // Independent of the working directory, as the name of the mesh file.
    handler.declare_entry(
      shared_libraries_entry,
      "",
      Patterns::Anything(),
      "Files with laws that are not part of the program, separated by commas; "
      "relative to the parameter file, or to the working directory.");
    in_subsection("Geometry", geometry);
    const auto declare_material = [this](const std::string  &name,
                                         MaterialParameters &entries) {
      handler.enter_subsection(name);
      entries.declare(handler, laws);
      handler.leave_subsection();
    };
    declare_material("Material", material);
    in_subsection("Material", stress);
    for (auto &[id, numbered] : materials)
      declare_material("Material " + std::to_string(id), numbered);
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
  Parameters::read(const std::vector<ParameterLine> &lines)
  {
    // The empty comments: a backslash before one does not continue the line.
    std::string text;
    for (const ParameterLine &line : lines)
      text += line.text + " #\n";
    std::istringstream input(text);
    // The line that has just been read.
    const auto line = [&]() -> const ParameterLine & {
      return lines
        [std::count(text.begin(), text.begin() + input.tellg(), '\n') - 1];
    };
    const auto refuse = [&](const std::string &why) {
      AssertThrow(false, ExcMessage(line().origin() + ": " + why));
    };
    try
      {
        handler.parse_input(input);
      }
    catch (const ParameterHandler::ExcNoSubsection &)
      {
        refuse(unknown_name(line(), declared_entries(handler)));
      }
    catch (const ParameterHandler::ExcInvalidEntryForPattern &)
      {
        refuse(wrong_value(line(), declared_entries(handler)));
      }
    catch (const ParameterHandler::ExcCannotParseLine &)
      {
        refuse(line().name.empty() ?
                 no_statement(line().text) :
                 unknown_name(line(), declared_entries(handler)));
      }
  }



  void
  Parameters::check_material(const std::vector<ParameterLine> &lines) const
  {
    const Tree declared = declared_entries(handler);
    for (const ParameterLine &line : lines)
      if (!line.is_opening && !line.name.empty() &&
          line.section.compare(0, 9, "Material/") == 0 &&
          line.name != "Volumetric integration" &&
          line.name != "Stress history")
        {
          const std::string path = line.section + line.name;
          const Tree &entry = declared.get_child(Tree::path_type(path, '/'));
          // The record of a run has the entries with their defaults.
          AssertThrow(line.value == entry.get<std::string>("default_value"),
                      ExcMessage(
                        line.origin() + ": '" + path +
                        "' cannot be set beside 'Material " +
                        std::to_string(materials.begin()->first) +
                        "'; where materials have numbers, each is described "
                        "in its own subsection, and 'Material' has only "
                        "'Volumetric integration' and 'Stress history'."));
        }
  }



  void
  Parameters::locate_mesh_file(const std::vector<ParameterLine> &lines)
  {
    const auto line =
      std::find_if(lines.rbegin(), lines.rend(), [](const auto &one) {
        return one.section + one.name == "Geometry/File";
      });
    const std::string found = line->locate(geometry.file);
    handler.enter_subsection("Geometry");
    handler.set("File", found);
    handler.leave_subsection();
  }



  void
  Parameters::resolve_automatic_choices()
  {
    const bool has_tolerance = error_control.has_tolerance();
    if (time.scheme == TimeScheme::automatic)
      {
        time.scheme =
          has_tolerance ? TimeScheme::heun : TimeScheme::forward_euler;
        if (has_tolerance)
          time.stiffness_policy = StiffnessPolicy::backward_euler;
      }
    if (step_control.resolve_events == EventResolution::automatic)
      step_control.resolve_events =
        has_tolerance ? EventResolution::off : EventResolution::on;
    if (refinement.strategy == RefinementStrategy::automatic)
      refinement.strategy =
        has_tolerance ? RefinementStrategy::residual : RefinementStrategy::none;
    AssertThrow(error_control.quantity.empty() || error_control.error_estimator,
                ExcMessage("'Error control/Quantity' needs the estimate of the "
                           "error; set 'Error control/Error bar' = true."));
    AssertThrow(error_control.quantity.empty() ||
                  refinement.strategy != RefinementStrategy::kelly,
                ExcMessage("'Error control/Quantity' refines by residuals; set "
                           "'Mesh refinement/Strategy' = residual, or none for "
                           "a fixed mesh."));
    if (!has_tolerance)
      return;
    AssertThrow(error_control.error_estimator,
                ExcMessage("'Error control/Tolerance' needs an estimate of the "
                           "error; set 'Error control/Error bar' = true."));
    AssertThrow(!step_control.is_on(),
                ExcMessage("'Error control/Tolerance' chooses the steps, too; "
                           "set 'Step control/Tolerance' = 0."));
    AssertThrow(refinement.strategy != RefinementStrategy::kelly,
                ExcMessage("'Error control/Tolerance' refines by the estimate "
                           "of the error; set 'Mesh refinement/Strategy' = "
                           "residual, or none for a fixed mesh."));
  }



  Parameters::Parameters(const std::vector<std::string> &files,
                         const std::vector<std::string> &overrides)
    : file(files.empty() ? "" : files[0])
  {
    const std::vector<ParameterLine> lines =
      read_parameter_lines(files, overrides);
    std::set<unsigned int> tables;
    for (const ParameterLine &line : lines)
      if (line.is_opening && line.section.empty())
        {
          const auto id = [&] {
            return static_cast<unsigned int>(std::stoul(line.name.substr(9)));
          };
          if (line.name.compare(0, 9, "Boundary ") == 0)
            boundaries[id()];
          if (line.name.compare(0, 9, "Material ") == 0)
            materials[id()];
          if (line.name.compare(0, 6, "Table ") == 0)
            tables.insert(
              static_cast<unsigned int>(std::stoul(line.name.substr(6))));
        }
    for (const ParameterLine &line : lines)
      if (!line.is_opening && !line.name.empty())
        origins[line.section + line.name] = line.origin();
    load_shared_libraries(lines);
    declare();
    declare_tables(handler, tables);
    read(lines);
    use_tables(read_tables(handler, tables, lines));
    handler.set(shared_libraries_entry, comma_separated(shared_libraries));
    if (!materials.empty())
      check_material(lines);
    if (!geometry.file.empty())
      locate_mesh_file(lines);
    resolve_automatic_choices();
    refinement.check();
    std::ostringstream message;
    message << "'Solver/Contact tolerance' = " << solver.contact_tolerance
            << " is below rounding; it must be 0 or lie between 1e-14 and 0.1.";
    AssertThrow(solver.contact_tolerance == 0. ||
                  solver.contact_tolerance >= 1e-14,
                ExcMessage(message.str()));
  }



  std::string
  Parameters::origin_of(const std::string &path) const
  {
    const auto origin = origins.find(path);
    return origin == origins.end() ? "" : origin->second;
  }



  std::map<std::string, std::string>
  Parameters::values() const
  {
    const Entries entries = collect(declared_entries(handler));
    return {entries.begin(), entries.end()};
  }



  Parameters::Parameters(const std::string &file)
    : Parameters(std::vector<std::string>{file})
  {}
} // namespace Viscoplastic
