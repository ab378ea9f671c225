// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  /**
   * A table written row by row as comma separated values: the first row fixes
   * the columns. Each row is flushed, so a run that is killed leaves what it
   * has computed. The first line has the names of the columns, with labels of
   * units such as ` [MPa]' behind them where the scene declares units.
   */
  class Statistics
  {
  public:
    /// What stands behind the name of a column in the first line.
    using Label = std::function<std::string(const std::string &column)>;

    /// Throws ExcMessage if @p file cannot be written.
    Statistics(const std::string &file, const Label &label);

    /**
     * Go on after the row of step @p last_step of a file, whose first column
     * counts steps from 0; drops the rows after it. Throws ExcMessage if a row
     * up to it is missing, before anything changes.
     */
    Statistics(const std::string &file, const unsigned int last_step);

    /// Append a value to the present row; integers print as such.
    void
    add(const std::string &column, const double value);

    /// Append a vector as column_x, column_y (, column_z).
    template <typename VectorType>
    void
    add_vector(const std::string &column,
               const VectorType  &value,
               const unsigned int dim)
    {
      for (unsigned int d = 0; d < dim; ++d)
        add(column + "_" + "xyz"[d], value[d]);
    }

    /// Write the row. Throws ExcMessage if that fails, e.g. on a full disk, or
    /// if the columns are not those of the rows before.
    void
    end_row();

    /// Put all rows to disk. Throws ExcMessage.
    void
    synchronize();

  private:
    std::string                                 name;
    Label                                       label;
    std::ofstream                               file;
    std::vector<std::string>                    columns;
    std::vector<std::pair<std::string, double>> row;
  };
} // namespace Viscoplastic
