// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>

#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The record of a step: for each quantity its name, unit and value, and
  /// whether it is printed at the end of a run. statistics.csv, its unit labels
  /// and the final output are made from it; Recorder::row() alone defines the
  /// quantities.
  class StatisticsRow
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

    std::vector<Entry> entries;
  };



  /// A file of rows that begin with the number of a step, the first line
  /// excepted. Rows are flushed, so that those of a run that is killed remain.
  /// Throws ExcMessage if the file cannot be written.
  class TableFile
  {
  public:
    /// Begin a file anew, or continue it after step @p last_step, dropping
    /// later rows; throws, before anything is changed, if there are fewer than
    /// @p least_rows up to that step.
    explicit TableFile(const std::string                 &name,
                       const std::optional<unsigned int> &last_step  = {},
                       const std::size_t                  least_rows = 1);

    void
    write(const std::string &rows);

    /// Flush all rows to disk.
    void
    synchronize() const;

    const std::string name;
    /// The first line of a file that is continued.
    std::string header;

  private:
    std::ofstream file;
  };


  /// A table of comma separated values. The first row defines the columns. The
  /// first line has the names of the columns, followed by a blank and unit
  /// labels such as [MPa] if the scene declares units.
  class Statistics
  {
  public:
    /// Begin a table of a scene with these @p units in @p dim dimensions.
    /// Throws ExcMessage if @p file cannot be written.
    Statistics(const std::string &file,
               const Units       &units,
               const unsigned int dim);

    /// Continue a file after the row of step @p last_step, whose first column
    /// counts steps from 0; drops later rows. Throws ExcMessage if a row up to
    /// that step is missing, before anything is changed.
    Statistics(const std::string &file, const unsigned int last_step);

    /// Write a row; integers print as such. Throws ExcMessage if writing fails,
    /// if the columns differ from earlier ones, or if a value is not finite.
    void
    write(const StatisticsRow &row);

    /// Flush all rows to disk. Throws ExcMessage.
    void
    synchronize() const
    {
      file.synchronize();
    }

  private:
    TableFile                file;
    Units                    units;
    unsigned int             dim = 0;
    std::vector<std::string> columns;
  };
} // namespace Viscoplastic
