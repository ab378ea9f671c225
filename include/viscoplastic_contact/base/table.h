// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The columns of a CSV file as functions of its first column, the argument:
  /// piecewise linear, or piecewise constant with the value of the last row
  /// that has been reached.
  class DataTable
  {
  public:
    enum class Interpolation
    {
      linear,
      constant
    };

    /// How a table extrapolates before its first row and after its last one.
    enum class Outside
    {
      refuse,  // not there
      constant // those of the nearest row
    };

    /// Read the text of a file. @p section is what the parameter file calls the
    /// table, such as "Table 1"; messages have both names. The text is a line
    /// with the names of the columns, and lines of as many finite numbers each,
    /// the first of which ascend; all separated by commas. Empty lines and
    /// those that begin with `#' do not count. Throws ExcMessage with file and
    /// line.
    DataTable(const std::string  &text,
              const std::string  &file,
              const std::string  &section,
              const Interpolation interpolation,
              const Outside       outside);

    /// A function that expressions may name.
    class Column
    {
    public:
      Column(const DataTable   &table,
             const std::string &name,
             const std::size_t  number)
        : name(name)
        , table(table)
        , number(number)
      {}

      /// The value at a place; not a number where the table has none.
      double
      value(const double argument) const;

      /// Why it has none there, as a sentence without its end.
      std::string
      explain_gap(const double argument) const;

      const std::vector<double> &
      nodes() const
      {
        return table.nodes();
      }

      bool
      may_jump() const
      {
        return table.interpolation == Interpolation::constant;
      }

      const std::string name;

    private:
      const DataTable  &table;
      const std::size_t number;
    };

    DataTable(const DataTable &) = delete;
    DataTable &
    operator=(const DataTable &) = delete;

    /// The arguments of the rows, ascending: where linear functions have kinks
    /// and constant ones jump.
    const std::vector<double> &
    nodes() const
    {
      return arguments;
    }

    const std::vector<Column> &
    columns() const
    {
      return functions;
    }

    const std::string   file, section;
    const Interpolation interpolation;
    const Outside       outside;
    /// The CRC-32 of the text of the file.
    const unsigned int checksum;

  private:
    friend class Column;

    std::string                      name_of_argument;
    std::vector<double>              arguments;
    std::vector<std::vector<double>> values; // by column
    std::vector<Column>              functions;
  };

  using Tables = std::vector<std::shared_ptr<const DataTable>>;

  /// The tables that expressions know which are made from now on: those of the
  /// parameter file that has been read last. Throws ExcMessage if a name is
  /// that of two columns, or of something else that expressions know.
  void
  use_tables(const Tables &tables);

  const Tables &
  tables_in_use();

  /// The columns that a text calls as functions.
  std::vector<std::shared_ptr<const DataTable::Column>>
  columns_in(const std::string &text);
} // namespace Viscoplastic
