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

  void
  TableRow::require_finite() const
  {
    for (const Entry &entry : entries)
      for (std::size_t i = 0; i < entry.values.size(); ++i)
        {
          const std::string column = entry.column(i);
          const double      value  = entry.values[i];
          // The stability limit is infinite where nothing flows.
          const bool is_limit = column == "step_limit" && value > 0.;
          // NaN between the times of a reference solution.
          const bool is_unknown =
            column.rfind("error_", 0) == 0 || column.rfind("exact_", 0) == 0 ||
            column == "estimate_recovery" ||
            // NaN at a point in an absent material.
            (column.rfind("point", 0) == 0 && std::isnan(value));
          if (!std::isfinite(value) && !is_limit && !is_unknown)
            refuse("In step " + as_text(entries[0].values[0]) + ", '" + column +
                   "' is " + as_text(value) +
                   "; it must be finite: the numbers of this scene leave the "
                   "range of floating-point numbers, choose other units or "
                   "look for a datum that is too large or too small.");
        }
  }



  TableFile::TableFile(const std::string                 &name,
                       const Units                       &units,
                       const unsigned int                 dim,
                       const std::optional<unsigned int> &last_step,
                       const std::size_t                  least_rows)
    : name(name)
    , units(units)
    , dim(dim)
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
            for (const std::string &column : Utilities::split_string_list(line))
              columns.push_back(without_label(column));
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
  TableFile::write(const TableRow &row)
  {
    const bool               is_first = columns.empty();
    std::vector<std::string> names;
    std::ostringstream       header, text;
    text << std::setprecision(12);
    for (const TableRow::Entry &entry : row.entries)
      for (std::size_t i = 0; i < entry.values.size(); ++i)
        {
          const char *separator = names.empty() ? "" : ",";
          names.push_back(entry.column(i));
          text << separator << entry.values[i];
          if (is_first)
            header << separator << names.back()
                   << units.label(entry.quantity, dim);
        }
    if (is_first)
      {
        columns = names;
        file << header.str() << '\n';
      }
    if (columns != names)
      refuse("The columns of '" + name +
             "' are not those of this run, which cannot go on with it.");
    file << text.str() << '\n';
  }



  void
  TableFile::flush()
  {
    if (!file.flush())
      refuse("Writing to '" + name + "' failed; is the disk full?");
  }



  void
  TableFile::synchronize() const
  {
    // The stream has been flushed.
    Viscoplastic::synchronize(name);
  }
} // namespace Viscoplastic
