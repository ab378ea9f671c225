// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The columns of a CSV file as functions of its first column, the argument:
  /// piecewise linear, or piecewise constant with the value of the last row
  /// whose argument has been reached.
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
      refuse,  // no value
      constant // value of the nearest row
    };

    /// Parse the @p text of @p file; @p section is the name of the table in the
    /// parameter file, such as "Table 1". Messages have both names. The first
    /// line has the names of the columns, each other line as many finite
    /// numbers; all are separated by commas, and the first column ascends.
    /// Empty lines and lines that begin with `#' are skipped. Throws ExcMessage
    /// with file and line.
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

      /// The value at @p argument; NaN where the table has none.
      double
      value(const double argument) const;

      /// Why there is no value at @p argument, as a sentence without full stop.
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

    /// The arguments of the rows in ascending order, at which linear
    /// interpolation has kinks and constant interpolation jumps.
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

  /// Set the tables that are known to expressions created after this call:
  /// those of the parameter file that was read last. Throws ExcMessage if two
  /// columns have the same name, or one that expressions use otherwise.
  void
  use_tables(const Tables &tables);

  const Tables &
  tables_in_use();

  /// Return the columns of the tables in use whose names @p text mentions.
  std::vector<std::shared_ptr<const DataTable::Column>>
  columns_in(const std::string &text);
} // namespace Viscoplastic
