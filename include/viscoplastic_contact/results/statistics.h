// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// What a step has to record: for each quantity its name, its unit, its value
  /// and whether the closing words of a run have it. Recorder::row() makes it,
  /// and so is the one place that knows them; statistics.csv, its labels of
  /// units and the closing words follow from it.
  class StatisticsRow
  {
  public:
    /// For add(): the closing words have the value at the end of a run.
    static constexpr bool printed = true;

    /// A number, or the components of a vector.
    struct Entry
    {
      std::string         name;
      Quantity            quantity;
      std::vector<double> values;
      bool                is_vector;
      bool                is_printed;

      /// The name of the column of a value: name_x, name_y (, name_z) for
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



  /// The beginning of a table whose rows begin with the number of a step: its
  /// first line, and the rows of steps up to one.
  struct TableBeginning
  {
    std::string    header;
    std::size_t    n_rows = 0;
    std::uintmax_t size   = 0; // in bytes
  };

  TableBeginning
  beginning_of_table(const std::string &file, const unsigned int last_step);

  /// Go on behind the beginning of a table. Throws ExcMessage.
  std::ofstream
  append_to_table(const std::string &file, const TableBeginning &beginning);


  /// A table written row by row as comma separated values: the first row fixes
  /// the columns. Each row is flushed, so a run that is killed leaves what it
  /// has computed. The first line has the names of the columns, with labels of
  /// units such as ` [MPa]' behind them where the scene declares units.
  class Statistics
  {
  public:
    /// Begin a table of a scene with these @p units in @p dim dimensions.
    /// Throws ExcMessage if @p file cannot be written.
    Statistics(const std::string &file,
               const Units       &units,
               const unsigned int dim);

    /// Go on after the row of step @p last_step of a file, whose first column
    /// counts steps from 0; drops the rows after it. Throws ExcMessage if a row
    /// up to it is missing, before anything changes.
    Statistics(const std::string &file, const unsigned int last_step);

    /// Write a row; integers print as such. Throws ExcMessage if that fails,
    /// e.g. on a full disk, or if the columns are not those of the rows before.
    void
    write(const StatisticsRow &row);

    /// Put all rows to disk. Throws ExcMessage.
    void
    synchronize();

  private:
    std::string              name;
    Units                    units;
    unsigned int             dim = 0;
    std::ofstream            file;
    std::vector<std::string> columns;
  };
} // namespace Viscoplastic
