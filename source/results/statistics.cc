// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/statistics.h>

#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  TableFile::TableFile(const std::string                 &name,
                       const std::optional<unsigned int> &last_step,
                       const std::size_t                  least_rows)
    : name(name)
  {
    require_writable_file(name);
    std::error_code error;
    if (last_step)
      {
        std::ifstream  earlier(name, std::ios::binary);
        std::uintmax_t size   = 0; // in bytes
        std::size_t    n_rows = 0;
        // An incomplete last line, without its end, is dropped.
        for (std::string line; std::getline(earlier, line) && !earlier.eof();
             size += line.size() + 1)
          if (size == 0)
            header = line;
          else if (std::strtoul(line.c_str(), nullptr, 10) <= *last_step)
            ++n_rows;
          else
            break;
        if (n_rows < least_rows)
          refuse("The rows up to step " + std::to_string(*last_step) +
                 ", with which the run would go on, are not in '" + name +
                 "'.");
        std::filesystem::resize_file(name, size, error);
      }
    file.open(name, last_step ? std::ios::app : std::ios::out);
    if (error || !file)
      refuse("The file '" + name + "' cannot be written.");
  }



  void
  TableFile::write(const std::string &rows)
  {
    file << rows << std::flush;
    if (!file)
      refuse("Writing to '" + name + "' failed; is the disk full?");
  }



  void
  TableFile::synchronize() const
  {
    // The stream has been flushed by write().
    Viscoplastic::synchronize(name);
  }



  Statistics::Statistics(const std::string &file_name,
                         const Units       &units,
                         const unsigned int dim)
    : file(file_name)
    , units(units)
    , dim(dim)
  {}



  Statistics::Statistics(const std::string &file_name,
                         const unsigned int last_step)
    : file(file_name, last_step, last_step + 1)
  {
    for (const std::string &column : Utilities::split_string_list(file.header))
      columns.push_back(without_label(column));
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
          if (columns.empty())
            header += (header.empty() ? "" : ",") + names.back() +
                      units.label(entry.quantity, dim);
        }
    if (columns.empty())
      {
        columns = names;
        file.write(header + '\n');
      }
    if (columns != names)
      refuse("The columns of '" + file.name +
             "' are not those of this run, which cannot go on with it.");
    // Refuse values that are not finite. The stability limit is infinite where
    // nothing flows.
    for (std::size_t i = 0; i < values.size(); ++i)
      {
        const std::string &column   = columns[i];
        const double       value    = values[i];
        const bool         is_limit = column == "step_limit" && value > 0.;
        // NaN between the times of a reference solution.
        const bool is_unknown =
          column.rfind("error_", 0) == 0 || column.rfind("exact_", 0) == 0 ||
          column == "estimate_recovery" ||
          // NaN at a point in an absent material.
          (column.rfind("point", 0) == 0 && std::isnan(value));
        if (!std::isfinite(value) && !is_limit && !is_unknown)
          refuse("In step " + as_text(values[0]) + ", '" + column + "' is " +
                 as_text(value) +
                 "; it must be finite: the numbers of this scene leave the "
                 "range of floating-point numbers, choose other units or look "
                 "for a datum that is too large or too small.");
      }
    std::ostringstream text;
    text << std::setprecision(12);
    for (std::size_t i = 0; i < values.size(); ++i)
      text << (i == 0 ? "" : ",") << values[i];
    file.write(text.str() + '\n');
  }
} // namespace Viscoplastic
