// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>

#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// A row of a table: for each quantity its name, unit and value, and whether
  /// it is printed at the end of a run. statistics.csv, its unit labels and the
  /// final output are made from those of Recorder::row().
  class TableRow
  {
  public:
    /// For add(): the value at the end of a run is printed.
    static constexpr bool printed = true;

    /// A number, or the components of a vector.
    struct Entry
    {
      std::string         name;
      Quantity            quantity;
      std::vector<double> values;
      bool                is_vector;
      bool                is_printed;

      /// The name of the column of a component: name_x, name_y (, name_z) for
      /// vectors.
      std::string
      column(const std::size_t value) const
      {
        return is_vector ? name + '_' + "xyz"[value] : name;
      }
    };

    void
    add(const std::string &name,
        const double       value,
        const Quantity     quantity   = Quantity::pure_number,
        const bool         is_printed = false)
    {
      entries.push_back({name, quantity, {value}, false, is_printed});
    }

    template <typename VectorType>
    void
    add_vector(const std::string &name,
               const VectorType  &value,
               const unsigned int dim,
               const Quantity     quantity,
               const bool         is_printed = false)
    {
      entries.push_back({name, quantity, {}, true, is_printed});
      for (unsigned int d = 0; d < dim; ++d)
        entries.back().values.push_back(value[d]);
    }

    /// Throw ExcMessage if a value is neither finite nor NaN for what is not
    /// known.
    void
    require_finite() const;

    std::vector<Entry> entries;
  };



  /// A file of comma separated values with rows that begin with the number of a
  /// step. The first row defines the columns, whose names are the first line,
  /// followed by unit labels such as [MPa] if the scene declares units. Throws
  /// ExcMessage if the file cannot be written.
  class TableFile
  {
  public:
    /// Begin a file of a scene with these @p units in @p dim dimensions, or
    /// continue it after step @p last_step, dropping later rows; throws, before
    /// anything is changed, if there are fewer than @p least_rows up to that
    /// step.
    TableFile(const std::string                 &name,
              const Units                       &units,
              const unsigned int                 dim,
              const std::optional<unsigned int> &last_step  = {},
              const std::size_t                  least_rows = 1);

    /// Write a row; integers print as such. Throws ExcMessage if the columns
    /// differ from earlier ones.
    void
    write(const TableRow &row);

    /// Hand all rows to the system, so that those of a run that is killed
    /// remain. Throws ExcMessage if writing has failed.
    void
    flush();

    /// Force the rows that have been flushed to disk. Throws ExcMessage.
    void
    synchronize() const;

  private:
    const std::string        name;
    const Units              units;
    const unsigned int       dim;
    std::ofstream            file;
    std::vector<std::string> columns;
  };
} // namespace Viscoplastic
