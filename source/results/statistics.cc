// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/statistics.h>

#include <cmath>
#include <filesystem>
#include <iomanip>

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
    if (!file)
      refuse("The file '" + name + "' cannot be written.");
  }



  TableBeginning
  beginning_of_table(const std::string &name, const unsigned int last_step)
  {
    require_writable_file(name);
    std::ifstream  file(name, std::ios::binary);
    TableBeginning result;
    std::string    line;
    // An incomplete last line, without its end, is dropped.
    for (; std::getline(file, line) && !file.eof();
         result.size += line.size() + 1)
      if (result.size == 0)
        result.header = line;
      else if (std::strtoul(line.c_str(), nullptr, 10) <= last_step)
        ++result.n_rows;
      else
        break;
    if (result.n_rows == 0)
      refuse("The rows up to step " + std::to_string(last_step) +
             ", with which the run would go on, are not in '" + name + "'.");
    return result;
  }



  std::ofstream
  append_to_table(const std::string &name, const TableBeginning &beginning)
  {
    std::error_code error;
    std::filesystem::resize_file(name, beginning.size, error);
    std::ofstream file(name, std::ios::app);
    if (error || !file)
      refuse("The file '" + name + "' cannot be written.");
    return file;
  }



  Statistics::Statistics(const std::string &file_name,
                         const unsigned int last_step)
    : name(file_name)
  {
    const TableBeginning beginning = beginning_of_table(name, last_step);
    if (beginning.n_rows != last_step + 1)
      refuse("The rows up to step " + std::to_string(last_step) +
             ", with which the run would go on, are not in '" + name + "'.");
    for (const std::string &column :
         Utilities::split_string_list(beginning.header))
      columns.push_back(without_label(column));
    file = append_to_table(name, beginning);
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
        file << header << '\n';
      }
    if (columns != names)
      refuse("The columns of '" + name +
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
    file << std::setprecision(12);
    for (std::size_t i = 0; i < values.size(); ++i)
      file << (i == 0 ? "" : ",") << values[i];
    file << std::endl;
    if (!file)
      refuse("Writing to '" + name + "' failed; is the disk full?");
  }



  void
  Statistics::synchronize()
  {
    // The stream has been flushed by write().
    Viscoplastic::synchronize(name);
  }
} // namespace Viscoplastic
