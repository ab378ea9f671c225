// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/parameters/parameter_description.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/parameter_tree.h>
#include <viscoplastic_contact/parameters/wrong_lines.h>

#include <cctype>
#include <map>
#include <set>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    using Tree = boost::property_tree::ptree;

    // The scene that is described: the default body, held at x = 0.
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



    /// The words of a text in lines of at most @p width characters, the first
    /// of which begins with @p first and the others with @p indent.
    std::string
    wrap(const std::string &text,
         const std::string &first,
         const std::string &indent,
         const std::size_t  width)
    {
      std::istringstream words(text);
      std::string        result, line = first, word;
      bool               is_empty = true;
      while (words >> word)
        {
          if (!is_empty && line.size() + 1 + word.size() > width)
            {
              result += line + '\n';
              line     = indent;
              is_empty = true;
            }
          line += (is_empty ? "" : " ") + word;
          is_empty = false;
        }
      return result + line + '\n';
    }



    /// An entry or subsection with what the manual says of it.
    struct Item
    {
      std::string              name;
      const Tree              *node;
      std::vector<std::string> about;
    };



    /// What is in a subsection, entries first. A paragraph about an entry that
    /// begins with the name of a subsection and a colon is about that
    /// subsection: so the texts of laws come to their parameters.
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



    std::string
    pattern_of(const Item &entry)
    {
      return entry.node->get<std::string>("pattern_description");
    }



    std::string
    default_and_allowed(const Tree &entry, const std::string &quote)
    {
      const std::string value   = entry.get<std::string>("default_value");
      const std::string pattern = entry.get<std::string>("pattern_description");
      // What a text may be is part of its meaning.
      return "Default: " + (value.empty() ? "empty" : quote + value + quote) +
             (pattern == "[Anything]" ?
                "." :
                "; allowed: " + allowed_values(pattern) + ".");
    }



    // ------------------------------------------------------ parameter file

    /// Print a section. With @p explain, every entry and its comments; without,
    /// those that differ from their defaults. Lines begin with @p margin.
    void
    print_section(std::ostream      &out,
                  const Tree        &section,
                  const std::string &margin,
                  const bool         explain)
    {
      const auto comment = [&](const std::string &text) {
        out << wrap(text, margin + "# ", margin + "# ", 78);
      };
      bool is_first = true;
      for (const Item &item : items(section))
        {
          if (is_entry(*item.node))
            {
              const auto value = item.node->get<std::string>("value");
              if (explain)
                {
                  if (!is_first)
                    out << '\n';
                  for (const std::string &paragraph : item.about)
                    comment(paragraph);
                  comment(default_and_allowed(*item.node, ""));
                }
              else if (value == item.node->get<std::string>("default_value"))
                continue;
              out << margin << "set " << item.name << " ="
                  << (value.empty() ? "" : " ") << value << '\n';
            }
          else if (explain)
            {
              out << '\n';
              for (const std::string &paragraph : item.about)
                comment(paragraph);
              out << margin << "subsection " << item.name << '\n';
              print_section(out, *item.node, margin + "  ", true);
              out << margin << "end\n";
            }
          is_first = false;
        }
    }



    /// Print all entries with their defaults, commented out.
    void
    print_template(std::ostream      &out,
                   const Tree        &section,
                   const std::string &margin)
    {
      for (const Item &item : items(section))
        if (is_entry(*item.node))
          {
            const auto value = item.node->get<std::string>("value");
            out << margin << "set " << item.name << " ="
                << (value.empty() ? "" : " ") << value << '\n';
          }
        else
          {
            out << margin << "subsection " << item.name << '\n';
            print_template(out, *item.node, margin + "  ");
            out << margin << "end\n";
          }
    }



    /// The name of a section without its number.
    std::string
    kind_of(const std::string &name)
    {
      return name.substr(0, name.find_last_not_of("0123456789") + 1);
    }



    // ------------------------------------------------------------ markdown

    /// `text' in quotation marks as code, and the rest without markup.
    std::string
    as_markdown(const std::string &text)
    {
      std::string result;
      for (std::size_t i = 0; i < text.size(); ++i)
        {
          if (text[i] == '`')
            {
              // The closing mark is not an apostrophe within a word.
              std::size_t end = i;
              do
                end = text.find('\'', end + 1);
              while (end != std::string::npos && end + 1 < text.size() &&
                     std::isalnum(static_cast<unsigned char>(text[end + 1])) !=
                       0);
              if (end != std::string::npos)
                {
                  result += '`' + text.substr(i + 1, end - i - 1) + '`';
                  i = end;
                  continue;
                }
            }
          if (text[i] == '*' || text[i] == '<' || text[i] == '_' ||
              text[i] == '`')
            result += '\\';
          result += text[i];
        }
      return result;
    }



    /// Whether the manual text of an entry names all values that it may have.
    bool
    names_its_values(const Item &entry, const std::string &pattern)
    {
      const std::string start = "[Selection ", end = " ]";
      if (pattern.compare(0, start.size(), start) != 0)
        return pattern == "[Bool]";
      std::string text;
      for (const std::string &paragraph : entry.about)
        text += paragraph;
      for (const std::string &value : Utilities::split_string_list(
             pattern.substr(start.size(),
                            pattern.size() - start.size() - end.size()),
             '|'))
        if (value != "not given" &&
            text.find('`' + value + '\'') == std::string::npos)
          return false;
      return true;
    }



    /// What the page says of default and values, without what goes without
    /// saying: "" for a text that is empty by default, nothing of values that
    /// the manual text names, of numbers their range, and long lists once in a
    /// section.
    std::string
    default_and_allowed_in_page(const Item              &entry,
                                const std::vector<Item> &section)
    {
      const auto        value   = entry.node->get<std::string>("default_value");
      const std::string pattern = pattern_of(entry);
      const std::size_t long_list = 200;
      for (const Item &other : section)
        if (&other == &entry || pattern.size() < long_list)
          break;
        else if (is_entry(*other.node) && pattern_of(other) == pattern)
          return "Allowed: as of `" + other.name + "`.";
      if (value.empty() && pattern == "[Anything]")
        return "";
      if (names_its_values(entry, pattern))
        return value == "not given" ? "" : "Default: `" + value + "`.";
      // Of a number the default tells whether it is a whole one.
      std::string allowed = allowed_values(pattern);
      for (const std::string start : {"a number", "a whole number"})
        if (allowed.compare(0, start.size(), start) == 0)
          {
            allowed.erase(0, start.size());
            if (allowed.compare(0, 4, " of ") == 0)
              allowed.erase(0, 3);
            return "Default: `" + value + "`" + (allowed.empty() ? "" : ",") +
                   allowed + ".";
          }
      return default_and_allowed(*entry.node, "`");
    }



    void
    print_markdown(std::ostream      &out,
                   const Tree        &section,
                   const std::string &path)
    {
      const std::vector<Item> all = items(section);
      for (const Item &item : all)
        if (is_entry(*item.node))
          {
            std::string first = "- **`" + item.name + "`** ";
            for (const std::string &paragraph : item.about)
              {
                out << wrap(as_markdown(paragraph), first, "  ", 80);
                out << (&paragraph == &item.about.back() ? "" : "\n");
                first = "  ";
              }
            const std::string values = default_and_allowed_in_page(item, all);
            if (!values.empty())
              out << wrap(values, "  ", "  ", 80);
          }
        else
          {
            const std::string name  = path + item.name;
            std::string       title = name;
            if (name == described_boundary || name == described_material ||
                name == described_table)
              title = name.substr(0, name.find(' ')) + " <id>";
            out << "\n## " << as_markdown(title) << "\n\n";
            const auto about = about_sections.find(name);
            if (about != about_sections.end())
              out << wrap(as_markdown(about->second), "", "", 80) << '\n';
            for (const std::string &paragraph : item.about)
              out << wrap(as_markdown(paragraph), "", "", 80) << '\n';
            if (name == described_material)
              out << wrap("Its entries and laws are those of `Material` but "
                          "`Volumetric integration` and `Stress history`, "
                          "which hold for all materials.",
                          "",
                          "",
                          80);
            else
              print_markdown(out, *item.node, name + '/');
          }
    }
  } // namespace



  std::string
  describe_parameters(const std::vector<std::string> &files,
                      const std::vector<std::string> &overrides)
  {
    const Parameters   parameters(files, files.empty() ? scene : overrides);
    std::ostringstream out;
    out << "# All parameters of viscoplastic_contact "
        << VISCOPLASTIC_CONTACT_VERSION << "\n#\n"
        << wrap(introduction, "# ", "# ", 78) << "#\n"
        << wrap("`#' begins a comment, a backslash at the end of a line "
                "continues it, `include other.prm' reads another file. This "
                "file is itself a scene, " +
                  std::string(files.empty() ? "a square at rest" :
                                              "the one that was given") +
                  ": change it, and delete what should keep its default.",
                "# ",
                "# ",
                78)
        << '\n';
    const Tree tree = parameters.entries_as_written();
    Tree       top;
    for (const auto &child : tree)
      if (is_entry(child.second))
        top.push_back(child);
    print_section(out, top, "", true);
    // One of each kind of numbered sections; of a scene, whose values may
    // differ in each, all of them.
    std::set<std::string> explained;
    for (const auto &[name, section] : tree)
      {
        if (is_entry(section))
          continue;
        out << '\n';
        const auto about = about_sections.find(name);
        if (about != about_sections.end())
          out << wrap(about->second, "# ", "# ", 78);
        if (files.empty() &&
            (name == described_material || name == described_table))
          {
            out << "#\n# subsection " << name << '\n';
            print_template(out, section, "#   ");
            out << "# end\n";
            continue;
          }
        out << "subsection " << name << '\n';
        print_section(out,
                      section,
                      "  ",
                      !files.empty() || explained.insert(kind_of(name)).second);
        out << "end\n";
      }
    return out.str();
  }



  std::string
  describe_parameters_as_markdown(const std::vector<std::string> &files,
                                  const std::vector<std::string> &overrides)
  {
    std::vector<std::string> described{described_boundary + "/Role=not given",
                                       described_material + "/Law=elastic",
                                       described_table + "/File="};
    const std::string        libraries = "Additional shared libraries";
    if (!files.empty())
      described.push_back(libraries + "=" +
                          Parameters(files, overrides).handler.get(libraries));
    const Parameters   parameters({}, described);
    std::ostringstream out;
    out << "<!-- Made by `viscoplastic_contact --describe=markdown`; do not "
           "edit. -->\n\n# Parameters\n\n"
        << wrap("Every entry of a parameter file, as `viscoplastic_contact "
                "--describe` prints them; what is said without a default is a "
                "text, empty by default. How to write a scene with them is in "
                "[scene.md](scene.md).",
                "",
                "",
                80)
        << '\n'
        << wrap(as_markdown(introduction), "", "", 80) << '\n';
    print_markdown(out, declared_entries(parameters.handler), "");
    return out.str();
  }
} // namespace Viscoplastic
