// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/patterns.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/parameter_file.h>

#include <fstream>
#include <regex>

namespace Viscoplastic
{
  void
  Parameters::declare()
  {
    const auto in_subsection = [this](const std::string &name, auto &struct_) {
      handler.enter_subsection(name);
      struct_.declare(handler);
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
    for (auto &[id, boundary] : boundaries)
      in_subsection("Boundary " + std::to_string(id), boundary);
    in_subsection("Time", time);
    in_subsection("Solver", solver);
    in_subsection("Mesh refinement", refinement);
    in_subsection("Output", output);
  }



  void
  Parameters::find_numbered_subsections(const std::string &name,
                                        const unsigned int depth)
  {
    AssertThrow(depth < 10,
                ExcMessage("The parameter file '" + file +
                           "' includes itself, or files too deep."));
    std::ifstream input(name);
    AssertThrow(input,
                ExcMessage("The parameter file '" + name +
                           "' cannot be opened."));
    const std::regex numbered(
      "^\\s*subsection\\s+(Boundary|Material)\\s+(\\d{1,9})\\s*(#.*)?$");
    const std::regex include("^\\s*include\\s+([^#]*[^#\\s])\\s*(#.*)?$");
    std::string      line;
    std::smatch      match;
    while (std::getline(input, line))
      if (std::regex_match(line, match, numbered))
        {
          const unsigned int id = std::stoul(match[2]);
          if (match[1] == "Boundary")
            boundaries[id];
          else
            materials[id];
        }
      else if (std::regex_match(line, match, include))
        find_numbered_subsections(match[1], depth + 1);
  }



  Parameters::Parameters(const std::string &file)
    : file(file)
  {
    find_numbered_subsections(file, 0);
    declare();
    handler.parse_input(file);
    refinement.check();
  }
} // namespace Viscoplastic
