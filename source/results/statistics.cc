// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/results/statistics.h>

#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  Statistics::Statistics(const std::string &file_name,
                         const Units       &units,
                         const unsigned int dim)
    : name(file_name)
    , units(units)
    , dim(dim)
  {
    require_writable_file(name);
    file.open(name);
    AssertThrow(file, ExcMessage("The file '" + name + "' cannot be written."));
  }



  Statistics::Statistics(const std::string &file_name,
                         const unsigned int last_step)
    : name(file_name)
  {
    require_writable_file(name);
    std::ifstream  old_file(name, std::ios::binary);
    std::string    line;
    std::uintmax_t size     = 0;
    const auto     get_line = [&]() {
      // A line without its end is unfinished.
      if (!std::getline(old_file, line) || old_file.eof())
        return false;
      size += line.size() + 1;
      return true;
    };
    unsigned int n_rows = 0;
    if (get_line())
      {
        std::istringstream header(line);
        std::string        column;
        while (std::getline(header, column, ','))
          columns.push_back(without_label(column));
        while (n_rows <= last_step && get_line() &&
               line.compare(0, line.find(','), std::to_string(n_rows)) == 0)
          ++n_rows;
      }
    AssertThrow(n_rows == last_step + 1,
                ExcMessage("The rows up to step " + std::to_string(last_step) +
                           ", with which the run would go on, are not in '" +
                           name + "'."));
    old_file.close();
    std::error_code error;
    std::filesystem::resize_file(name, size, error);
    file.open(name, std::ios::app);
    AssertThrow(!error && file,
                ExcMessage("The file '" + name + "' cannot be written."));
  }



  void
  Statistics::write(const StatisticsRow &row)
  {
    std::vector<std::string> names;
    std::vector<double>      values;
    std::string              header;
    for (const StatisticsRow::Entry &entry : row.entries)
      for (std::size_t i = 0; i < entry.values.size(); ++i)
        {
          names.push_back(entry.column(i));
          values.push_back(entry.values[i]);
          header += (header.empty() ? "" : ",") + names.back() +
                    units.label(entry.quantity, dim);
        }
    if (columns.empty())
      {
        columns = names;
        file << header << '\n';
      }
    AssertThrow(columns == names,
                ExcMessage("The columns of '" + name +
                           "' are not those of this run, which cannot go on "
                           "with it."));
    // A result that is none must not pass for one. No limit is imposed where
    // nothing flows.
    for (std::size_t i = 0; i < values.size(); ++i)
      {
        const std::string &column   = columns[i];
        const double       value    = values[i];
        const bool         is_limit = column == "step_limit" && value > 0.;
        // Not known between the times of a reference.
        const bool is_unknown =
          column.rfind("error_", 0) == 0 || column.rfind("exact_", 0) == 0 ||
          column == "estimate_recovery" ||
          // Of a point in an absent material.
          (column.rfind("point", 0) == 0 && std::isnan(value));
        if (std::isfinite(value) || is_limit || is_unknown)
          continue;
        std::ostringstream message;
        message << "In step " << values[0] << ", '" << column << "' is "
                << value
                << "; it must be finite: the numbers of this scene leave the "
                   "range of floating-point numbers, choose other units or "
                   "look for a datum that is too large or too small.";
        AssertThrow(false, ExcMessage(message.str()));
      }
    file << std::setprecision(12);
    for (std::size_t i = 0; i < values.size(); ++i)
      file << (i == 0 ? "" : ",") << values[i];
    file << std::endl;
    AssertThrow(file,
                ExcMessage("Writing to '" + name +
                           "' failed; is the disk full?"));
  }



  void
  Statistics::synchronize()
  {
    // The stream has no buffer left: write() flushes.
    Viscoplastic::synchronize(name);
  }
} // namespace Viscoplastic
