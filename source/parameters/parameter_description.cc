// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/parameters/parameter_description.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/parameter_tree.h>
#include <viscoplastic_contact/parameters/wrong_lines.h>

#include <map>
#include <set>
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
                                         "Boundary 3/Role=free",
                                         "Material 1/Law=elastic",
                                         "Table 1/File="};

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



    std::vector<std::string>
    split_paragraphs(const std::string &text)
    {
      std::vector<std::string> paragraphs(1);
      std::istringstream       lines(text);
      std::string              line;
      while (std::getline(lines, line))
        if (line.empty())
          paragraphs.emplace_back();
        else
          paragraphs.back() += (paragraphs.back().empty() ? "" : " ") + line;
      return paragraphs;
    }



    /// Break a text into lines that begin with @p margin.
    std::string
    wrap(const std::string &text, const std::string &margin)
    {
      std::string result;
      for (const std::string &line :
           Utilities::break_text_into_lines(text, 78 - margin.size()))
        result += margin + line + '\n';
      return result;
    }



    /// An entry or subsection with its paragraphs in the manual.
    struct Item
    {
      std::string              name;
      const Tree              *node;
      std::vector<std::string> about;
    };



    /// Return the contents of a subsection, entries first. A paragraph on an
    /// entry that begins with the name of a subsection and a colon is moved to
    /// that subsection; so the texts of laws come to their parameters.
    std::vector<Item>
    items(const Tree &section)
    {
      std::vector<Item> entries, subsections;
      for (const auto &[name, node] : section)
        (is_entry(node) ? entries : subsections).push_back({name, &node, {}});
      for (Item &entry : entries)
        for (const std::string &paragraph :
             split_paragraphs(entry.node->get<std::string>("documentation")))
          {
            std::vector<std::string> *about = &entry.about;
            for (Item &subsection : subsections)
              if (paragraph.compare(0,
                                    subsection.name.size() + 2,
                                    subsection.name + ": ") == 0)
                about = &subsection.about;
            about->push_back(paragraph);
          }
      entries.insert(entries.end(), subsections.begin(), subsections.end());
      return entries;
    }



    /// Which entries of a section are printed: all with comments, those that
    /// differ from their defaults, or all without comments.
    enum class Style
    {
      explained,
      changed,
      all
    };

    /// Print a section in lines that begin with @p margin.
    void
    print_section(std::ostream      &out,
                  const Tree        &section,
                  const std::string &margin,
                  const Style        style)
    {
      const auto comment = [&](const std::string &text) {
        if (style == Style::explained)
          out << wrap(text, margin + "# ");
      };
      bool is_first = true;
      for (const auto &[name, node, about] : items(section))
        {
          const bool begins_with_blank_line =
            style == Style::explained && !(is_first && is_entry(*node));
          if (is_entry(*node))
            {
              const auto value    = node->get<std::string>("value"),
                         standard = node->get<std::string>("default_value");
              const std::string allowed =
                allowed_values(node->get<std::string>("pattern_description"));
              if (style == Style::changed && value == standard)
                continue;
              out << (begins_with_blank_line ? "\n" : "");
              for (const std::string &paragraph : about)
                comment(paragraph);
              // For texts, the description says which are allowed.
              comment(
                "Default: " + (standard.empty() ? "empty" : standard) +
                (allowed == "any text" ? "." : "; allowed: " + allowed + "."));
              out << margin << "set " << name << " ="
                  << (value.empty() ? "" : " ") << value << '\n';
            }
          else if (style != Style::changed)
            {
              out << (begins_with_blank_line ? "\n" : "");
              for (const std::string &paragraph : about)
                comment(paragraph);
              out << margin << "subsection " << name << '\n';
              print_section(out, *node, margin + "  ", style);
              out << margin << "end\n";
            }
          is_first = false;
        }
    }



    /// Return the name of a section without its number.
    std::string
    kind_of(const std::string &name)
    {
      return name.substr(0, name.find_last_not_of("0123456789") + 1);
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
        << wrap(introduction, "# ") << "#\n"
        << wrap("`#' begins a comment, a backslash at the end of a line "
                "continues it, `include other.prm' reads another file. This "
                "file is itself a scene, " +
                  std::string(files.empty() ? "a square at rest" :
                                              "the one that was given") +
                  ": change it, and delete what should keep its default.",
                "# ")
        << '\n';
    const Tree tree = parameters.entries_as_written();
    Tree       top;
    for (const auto &child : tree)
      if (is_entry(child.second))
        top.push_back(child);
    print_section(out, top, "", Style::explained);
    // Without files, only the first section of each numbered kind is explained;
    // the sections of a given scene may have different values.
    std::set<std::string> explained;
    for (const auto &[name, section] : tree)
      {
        if (is_entry(section))
          continue;
        out << '\n';
        const auto about = about_sections.find(name);
        if (about != about_sections.end())
          out << wrap(about->second, "# ");
        if (files.empty() &&
            (name == described_material || name == described_table))
          {
            out << "#\n# subsection " << name << '\n';
            print_section(out, section, "#   ", Style::all);
            out << "# end\n";
            continue;
          }
        out << "subsection " << name << '\n';
        print_section(out,
                      section,
                      "  ",
                      !files.empty() || explained.insert(kind_of(name)).second ?
                        Style::explained :
                        Style::changed);
        out << "end\n";
      }
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
    return as_json(result);
  }
} // namespace Viscoplastic
