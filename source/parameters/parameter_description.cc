// SPDX-License-Identifier: LGPL-2.1-or-later
// Boost's JSON parser uses placeholders that boost says are deprecated.
#define BOOST_BIND_GLOBAL_PLACEHOLDERS

#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/parameters/parameter_description.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/parameter_tree.h>
#include <viscoplastic_contact/parameters/wrong_lines.h>

#include <boost/property_tree/json_parser.hpp>

#include <map>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    using Tree = boost::property_tree::ptree;

    // The default scene that is described: a body held at x = 0.
    const std::string described_boundary = "Boundary 0";
    const std::string described_material = "Material 1";
    const std::string described_table    = "Table 1";

    const std::vector<std::string> scene{"Boundary 0/Role=clamped",
                                         "Boundary 1/Role=free",
                                         "Boundary 2/Role=free",
                                         "Boundary 3/Role=free"};

    const std::string introduction =
      "Entries that are left out have their defaults. Units are any consistent "
      "ones, or those that the subsection `Units' declares. Expressions are "
      "texts for muParser with the variables x, y (z in 3D) and t, where the "
      "entry may depend on them, and the constant pi: `0.3*min(t, 2 - t)', "
      "`if(x < 1, 0.02, 0.3)'. Components of vectors are separated by "
      "semicolons.";

    const std::map<std::string, std::string> about_sections{
      {described_boundary,
       "What happens on a piece of the boundary. The mesh needs one subsection "
       "`Boundary <id>' for each boundary id that it has, with a role; there "
       "is no default."},
      {described_material,
       "Bodies of several materials have no material in `Material' but one in "
       "a subsection `Material <id>' for each material id of the mesh."},
      {described_table,
       "A table whose columns all expressions may call as functions: with "
       "`File' = load.csv, whose first line is `t, force', `Traction' may be "
       "`2*force(t); 0'. The first column is the argument, a time or whatever "
       "the expression gives; `Interpolation' is linear or constant, `Outside' "
       "of the rows refuse or constant."},
      {"Units",
       "The units of numbers without unit, of what a run prints and of its "
       "results. With them a number may have any unit: `1 year', `25 MPa', "
       "`0.022 MPa/m', `1e-5 MPa^-5/day', also in expressions. Units are nm, "
       "um, mm, cm, m, km; ms, s, min, h, day, year (365.25 days); Pa, kPa, "
       "MPa, GPa, bar; N, kN, MN; J, kJ; kg; K, mol; and products of them."},
      {"Material",
       "The material of all cells, and how stresses are discretized."}};



    /// Break a text into comment lines.
    std::string
    comment(const std::string &text)
    {
      std::string result;
      for (const std::string &line : Utilities::break_text_into_lines(text, 76))
        result += "# " + line + '\n';
      return result;
    }



    /// Add the allowed values in words to each entry.
    void
    add_allowed_values(Tree &section)
    {
      for (auto &[name, node] : section)
        if (is_entry(node))
          node.put("allowed",
                   allowed_values(
                     node.get<std::string>("pattern_description")));
        else
          add_allowed_values(node);
    }
  } // namespace



  std::string
  describe_parameters(const std::vector<std::string> &files,
                      const std::vector<std::string> &overrides)
  {
    const Parameters   parameters(files, files.empty() ? scene : overrides);
    std::ostringstream out;
    out << "# All parameters of viscoplastic_contact " << program_version
        << "\n#\n"
        << comment(introduction) << "#\n"
        << comment("`#' begins a comment, a backslash at the end of a line "
                   "continues it, `include other.prm' reads another file. This "
                   "file is itself a scene, " +
                   std::string(files.empty() ? "a square at rest" :
                                               "the one that was given") +
                   ": change it, and delete what should keep its default.");
    for (const auto &[name, about] : about_sections)
      out << "#\n" << comment('`' + name + "': " + about);
    out << '\n';
    parameters.print(out, /* is_explained = */ true);
    return out.str();
  }



  std::string
  describe_parameters_as_json(const std::vector<std::string> &files,
                              const std::vector<std::string> &overrides)
  {
    std::vector<std::string> described{described_boundary + "/Role=not given",
                                       described_material + "/Law=elastic",
                                       described_table + "/File="};
    const std::string        libraries = "Additional shared libraries";
    if (!files.empty())
      described.push_back(libraries + "=" +
                          Parameters(files, overrides).handler.get(libraries));
    Tree entries = declared_entries(Parameters({}, described).handler),
         sections, result;
    add_allowed_values(entries);
    for (const auto &[name, about] : about_sections)
      sections.push_back({name, Tree(about)});
    result.put("introduction", introduction);
    result.add_child("sections", sections);
    result.add_child("entries", entries);
    std::ostringstream out;
    boost::property_tree::write_json(out, result);
    return out.str();
  }
} // namespace Viscoplastic
