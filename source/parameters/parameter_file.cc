// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/subsection.h>
#include <viscoplastic_contact/laws/law_library.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/parameter_text.h>
#include <viscoplastic_contact/parameters/parameter_tree.h>
#include <viscoplastic_contact/parameters/quantities.h>
#include <viscoplastic_contact/parameters/wrong_lines.h>

#include <filesystem>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    using Tree = boost::property_tree::ptree;

    const std::string shared_libraries_entry = "Additional shared libraries";
  } // namespace



  void
  Parameters::load_shared_libraries(const std::vector<ParameterLine> &lines)
  {
    const ParameterLine *const line = last_line(lines, shared_libraries_entry);
    if (line == nullptr || line->value.empty())
      {
        laws = built_in_laws();
        return;
      }
    for (const std::string &library :
         Utilities::split_string_list(line->value, ','))
      {
        if (library.empty())
          refuse(line->origin() + ": '" + shared_libraries_entry +
                 "' has an empty name between commas.");
        shared_libraries.push_back(line->locate(library));
      }
    try
      {
        laws = laws_with_libraries(shared_libraries);
      }
    catch (...)
      {
        refuse(line->origin() + ": " + reason_of_current_exception());
      }
  }



  void
  Parameters::read(const std::vector<ParameterLine> &lines)
  {
    // An empty comment keeps a backslash at the end from continuing the line.
    std::string text;
    for (const ParameterLine &line : lines)
      text += line.text + " #\n";
    std::istringstream input(text);
    // The line that the handler has just read.
    const auto line = [&]() -> const ParameterLine & {
      return lines
        [std::count(text.begin(), text.begin() + input.tellg(), '\n') - 1];
    };
    const auto refuse_line = [&](const std::string &why) {
      refuse(line().origin() + ": " + why);
    };
    try
      {
        handler.parse_input(input);
      }
    catch (const ParameterHandler::ExcNoSubsection &)
      {
        refuse_line(unknown_name(line(), declared_entries(handler)));
      }
    catch (const ParameterHandler::ExcInvalidEntryForPattern &)
      {
        refuse_line(wrong_value(line(), declared_entries(handler)));
      }
    catch (const ParameterHandler::ExcCannotParseLine &)
      {
        refuse_line(
          line().name.empty() ?
            "'" + excerpt(line().text) +
              "' is no statement; a line is `set Entry = value', `subsection "
              "Name', `end', `include file', or a comment after `#'." :
            unknown_name(line(), declared_entries(handler)));
      }
  }



  std::string
  Parameters::locate_file(const std::string                &section,
                          const std::vector<ParameterLine> &lines)
  {
    const ParameterLine &line = *last_line(lines, section + "/File");
    const std::string    path = line.locate(line.value);
    const Subsection     subsection(handler, section);
    handler.set("File", path);
    return path;
  }



  void
  Parameters::read_tables(const std::vector<ParameterLine> &lines)
  {
    Tables result;
    for (const auto &[number, table] : tables)
      if (!table.file.empty())
        {
          const std::string section = "Table " + std::to_string(number),
                            given   = table.file,
                            file    = locate_file(section, lines);
          try
            {
              std::error_code none;
              const auto      text = std::filesystem::is_directory(file, none) ?
                                       std::nullopt :
                                       read_file_if_any(file);
              if (!text)
                refuse("the table '" + file + "' cannot be read.");
              result.push_back(std::make_shared<const DataTable>(
                *text, given, section, table.interpolation, table.outside));
            }
          catch (const std::exception &exception)
            {
              refuse(origin_of(section + "/File") + ": " + reason(exception));
            }
        }
    use_tables(result);
  }



  void
  Parameters::check_material(const std::vector<ParameterLine> &lines) const
  {
    const Tree declared = declared_entries(handler);
    for (const ParameterLine &line : lines)
      if (line.sets_entry() && line.section.compare(0, 9, "Material/") == 0 &&
          line.name != "Volumetric integration" &&
          line.name != "Stress history")
        {
          const std::string path = line.path();
          const Tree &entry = declared.get_child(Tree::path_type(path, '/'));
          // Defaults are allowed, since the record of a run contains them.
          if (line.value != entry.get<std::string>("default_value"))
            refuse(line.origin() + ": '" + path +
                   "' cannot be set beside 'Material " +
                   std::to_string(materials.begin()->first) +
                   "'; where materials have numbers, each is described in its "
                   "own subsection, and 'Material' has only 'Volumetric "
                   "integration' and 'Stress history'.");
        }
  }



  void
  Parameters::check_defaults_of_materials() const
  {
    const Tree declared = declared_entries(handler);
    const auto check    = [&](const std::string &section,
                           const std::string &name,
                           const Tree        &entry) {
      const std::string path  = section + '/' + name;
      const auto        value = entry.get<std::string>("default_value");
      if (origin_of(path).empty() && !value.empty() && value != "0" &&
          has_unit(entry.get<std::string>("documentation")))
        refuse("'" + path + "' is not given; its default, " + value +
               ", means nothing in the units of the scene.");
    };
    const auto check_section = [&](const std::string        &section,
                                   const MaterialParameters &given) {
      const Tree       &entries = declared.get_child(section);
      const std::string modulus = "Young's modulus";
      if (given.voigt_matrix.empty())
        check(section, modulus, entries.get_child(modulus));
      if (const auto law = entries.get_child_optional(given.law))
        for (const auto &[name, entry] : *law)
          check(section + '/' + given.law, name, entry);
    };
    if (materials.empty())
      check_section("Material", material);
    for (const auto &[id, numbered] : materials)
      check_section("Material " + std::to_string(id), numbered);
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
    if (!error_control.quantity.empty() && !error_control.error_estimator)
      refuse("'Error control/Quantity' needs the estimate of the error; set "
             "'Error control/Error bar' = true.");
    if (!error_control.quantity.empty() &&
        refinement.strategy == RefinementStrategy::kelly)
      refuse("'Error control/Quantity' refines by residuals; set 'Mesh "
             "refinement/Strategy' = residual, or none for a fixed mesh.");
    if (!has_tolerance)
      return;
    if (!(error_control.tolerance < 1.))
      refuse("'Error control/Tolerance' = 1 lets the error be as large as the "
             "solution; 1 % is 0.01.");
    if (!error_control.error_estimator)
      refuse("'Error control/Tolerance' needs an estimate of the error; set "
             "'Error control/Error bar' = true.");
    if (step_control.is_on())
      refuse("'Error control/Tolerance' chooses the steps, too; set 'Step "
             "control/Tolerance' = 0.");
    if (refinement.strategy == RefinementStrategy::kelly)
      refuse(
        "'Error control/Tolerance' refines by the estimate of the error; set "
        "'Mesh refinement/Strategy' = residual, or none for a fixed mesh.");
  }



  Parameters::Parameters(const std::vector<std::string> &files,
                         const std::vector<std::string> &overrides)
    : file(files.empty() ? "" : files[0])
  {
    std::vector<ParameterLine> lines = read_parameter_lines(files, overrides);
    for (const ParameterLine &line : lines)
      if (line.sets_entry())
        origins[line.path()] = line.origin();
      else if (line.is_opening && line.section.empty())
        {
          std::istringstream words(line.name);
          std::string        kind;
          unsigned int       id;
          if (!(words >> kind >> id))
            continue;
          if (kind == "Boundary")
            boundaries[id];
          else if (kind == "Material")
            materials[id];
          else if (kind == "Table")
            tables[id];
        }
    load_shared_libraries(lines);
    declare_scene();
    declare_run();
    units      = declared_units(lines);
    as_written = remove_units(lines, units, handler);
    read(lines);
    read_tables(lines);
    units.are_of_whole_bodies =
      geometry.plane_model == PlaneModel::axisymmetric;
    handler.set(shared_libraries_entry,
                enumeration(shared_libraries, shared_libraries.size()));
    if (!materials.empty())
      check_material(lines);
    if (units.are_declared())
      check_defaults_of_materials();
    if (!geometry.file.empty())
      locate_file("Geometry", lines);
    resolve_automatic_choices();
    refinement.check();
    if (solver.contact_tolerance != 0. && !(solver.contact_tolerance >= 1e-14))
      refuse(
        "'Solver/Contact tolerance' = " + as_text(solver.contact_tolerance) +
        " is below rounding; it must be 0 or lie between 1e-14 and 0.1.");
  }



  Tree
  Parameters::entries_as_written() const
  {
    Tree tree = declared_entries(handler);
    for (const auto &[path, value] : as_written)
      tree.get_child(Tree::path_type(path, '/')).put("value", value);
    return tree;
  }



  std::map<std::string, std::string>
  Parameters::entries_with_units() const
  {
    std::map<std::string, std::string> result = as_written;
    if (result.empty())
      return result;
    const auto all = values();
    for (auto &[path, value] : result)
      value = all.at(path);
    return result;
  }



  std::string
  Parameters::quote_as_written(const std::string &sentence) const
  {
    std::string result = sentence;
    if (as_written.empty())
      return result;
    const auto quoted = [](const std::string &value) {
      return "'" + excerpt(Utilities::trim(value)) + "'";
    };
    const auto replace = [&result](const std::string &old_words,
                                   const std::string &new_words) {
      const std::size_t begin = result.find(old_words);
      if (begin != std::string::npos && old_words != new_words)
        result.replace(begin, old_words.size(), new_words);
    };
    const auto all = values();
    for (const auto &[path, text] : as_written)
      if (sentence.find("'" + path + "'") != std::string::npos)
        {
          const std::string &value = all.at(path);
          replace(quoted(value), quoted(text));
          const auto values = Utilities::split_string_list(value, ';');
          const auto texts  = Utilities::split_string_list(text, ';');
          for (std::size_t i = 0; i < values.size() && i < texts.size(); ++i)
            replace(quoted(values[i]), quoted(texts[i]));
        }
    return result;
  }



  void
  Parameters::print(std::ostream &out, const bool is_explained) const
  {
    if (as_written.empty() && !is_explained)
      {
        handler.print_parameters(out, ParameterHandler::Text);
        return;
      }
    // A handler that accepts any text, such as numbers with units.
    ParameterHandler      record;
    std::set<std::string> kinds; // names of sections without their numbers
    const std::function<void(const Tree &, const bool)> declare_all =
      [&](const Tree &section, const bool with_defaults) {
        for (const auto &[name, node] : section)
          if (is_entry(node))
            {
              const auto value    = node.get<std::string>("value"),
                         standard = node.get<std::string>("default_value");
              auto about          = node.get<std::string>("documentation");
              if (!with_defaults && value == standard)
                continue;
              const std::string allowed =
                allowed_values(node.get<std::string>("pattern_description"));
              if (is_explained) // for texts, it says which are allowed
                about +=
                  "\nDefault: " + (standard.empty() ? "empty" : standard) +
                  (allowed == "any text" ? "." : "; allowed: " + allowed + '.');
              record.declare_entry(name, standard, Patterns::Anything(), about);
              record.set(name, value);
            }
          else
            {
              const Subsection  subsection(record, name);
              const std::string kind =
                name.substr(0, name.find_last_not_of("0123456789") + 1);
              declare_all(node,
                          with_defaults && (!is_explained || !file.empty() ||
                                            kinds.insert(kind).second));
            }
      };
    declare_all(entries_as_written(), true);
    record.print_parameters(out,
                            is_explained ?
                              ParameterHandler::Text |
                                ParameterHandler::KeepDeclarationOrder :
                              ParameterHandler::Text);
  }



  std::map<std::string, std::string>
  Parameters::values() const
  {
    const auto entries = values_of(declared_entries(handler));
    return {entries.begin(), entries.end()};
  }



  Parameters::Parameters(const std::string &file)
    : Parameters(std::vector<std::string>{file})
  {}
} // namespace Viscoplastic
