// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/subsection.h>
#include <viscoplastic_contact/parameters/parameter_text.h>
#include <viscoplastic_contact/parameters/table_sections.h>

#include <filesystem>

namespace Viscoplastic
{
  namespace
  {
    std::string
    section_of(const unsigned int number)
    {
      return "Table " + std::to_string(number);
    }
  } // namespace



  void
  declare_tables(ParameterHandler &prm, const std::set<unsigned int> &numbers)
  {
    for (const unsigned int number : numbers)
      {
        const Subsection subsection(prm, section_of(number));
        prm.declare_entry(
          "File",
          "",
          Patterns::Anything(),
          "A CSV file, relative to the parameter file or to the "
          "working directory: names of the columns in the first "
          "line, the argument in the first column, ascending. "
          "Empty: there is no such table.");
        prm.declare_entry("Interpolation",
                          "linear",
                          Patterns::Selection("linear|constant"),
                          "Between two rows: `linear', or `constant' with the "
                          "value of the first of them.");
        prm.declare_entry(
          "Outside",
          "refuse",
          Patterns::Selection("refuse|constant"),
          "Before the first row and after the last one: an "
          "error where a value is needed there, or the value of "
          "the nearest row.");
      }
  }



  Tables
  read_tables(ParameterHandler                 &prm,
              const std::set<unsigned int>     &numbers,
              const std::vector<ParameterLine> &lines)
  {
    Tables tables;
    for (const unsigned int number : numbers)
      {
        const std::string section = section_of(number);
        const Subsection  subsection(prm, section);
        const std::string given = prm.get("File");
        if (given.empty())
          continue;
        const ParameterLine *const line = last_line(lines, section + "/File");
        const std::string          file = line->locate(given);
        prm.set("File", file);
        try
          {
            std::error_code none;
            const auto      text = std::filesystem::is_directory(file, none) ?
                                     std::nullopt :
                                     read_file_if_any(file);
            if (!text)
              refuse("the table '" + file + "' cannot be read.");
            tables.push_back(std::make_shared<const DataTable>(
              *text,
              given,
              section,
              prm.get("Interpolation") == "linear" ?
                DataTable::Interpolation::linear :
                DataTable::Interpolation::constant,
              prm.get("Outside") == "refuse" ? DataTable::Outside::refuse :
                                               DataTable::Outside::constant));
          }
        catch (const std::exception &exception)
          {
            refuse(line->origin() + ": " + reason(exception));
          }
      }
    return tables;
  }
} // namespace Viscoplastic
