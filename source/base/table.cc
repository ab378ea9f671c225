// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mu_parser_internal.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    // A bound on memory; measured curves are shorter.
    const std::size_t most_numbers = 10'000'000;



    std::vector<std::string>
    cells(const std::string &line)
    {
      std::vector<std::string> result;
      std::size_t              begin = 0;
      for (std::size_t end = 0; end != std::string::npos; begin = end + 1)
        {
          end = line.find(',', begin);
          result.push_back(Utilities::trim(line.substr(begin, end - begin)));
        }
      return result;
    }



    // The longest name that muParser accepts.
    const std::size_t longest_name = 100;



    bool
    is_name(const std::string &text)
    {
      return !text.empty() && text.size() <= longest_name && text[0] != '_' &&
             identifier_at(text, 0) == text;
    }



    Tables &
    current_tables()
    {
      static Tables tables;
      return tables;
    }
  } // namespace



  DataTable::DataTable(const std::string  &text,
                       const std::string  &file,
                       const std::string  &section,
                       const Interpolation interpolation,
                       const Outside       outside)
    : file(file)
    , section(section)
    , interpolation(interpolation)
    , outside(outside)
    , checksum(Viscoplastic::checksum(text))
  {
    std::istringstream       input(text);
    std::string              line;
    std::vector<std::string> names;
    unsigned int             n_lines = 0;
    const auto               require = [&](const bool         condition,
                             const std::string &sentence) {
      if (!condition)
        refuse("'" + file + "', line " + std::to_string(n_lines) + ": " +
               sentence);
    };
    while (std::getline(input, line))
      {
        ++n_lines;
        if (n_lines == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0)
          line.erase(0, 3); // a byte order mark
        line = Utilities::trim(line);
        if (line.empty() || line[0] == '#')
          continue;
        const std::vector<std::string> row = cells(line);
        if (names.empty())
          {
            names = row;
            for (const std::string &name : names)
              require(is_name(name),
                      "'" + excerpt(name) +
                        "' is no name of a column; the first line of a table "
                        "has names of at most " +
                        std::to_string(longest_name) +
                        " letters, digits and underscores, separated by "
                        "commas.");
            require(names.size() > 1,
                    "there is one column; a table needs that of the argument "
                    "and others after it.");
            values.resize(names.size() - 1);
            continue;
          }
        require(row.size() == names.size(),
                "there are " + std::to_string(row.size()) +
                  " values, but the table has " + std::to_string(names.size()) +
                  " columns.");
        require((arguments.size() + 1) * names.size() <= most_numbers,
                "the table has more than " + std::to_string(most_numbers) +
                  " numbers.");
        for (std::size_t c = 0; c < row.size(); ++c)
          {
            const auto number = number_of(row[c]);
            require(number && std::isfinite(*number),
                    "'" + excerpt(row[c]) + "' in the column '" +
                      excerpt(names[c]) + "' is no finite number.");
            (c == 0 ? arguments : values[c - 1]).push_back(*number);
          }
        const std::size_t n = arguments.size();
        require(n == 1 || arguments[n - 1] > arguments[n - 2],
                "'" + row[0] + "' in the column '" + excerpt(names[0]) +
                  "' is not above the value before it; the first column has "
                  "to ascend.");
      }
    require(arguments.size() >= 2,
            "the table ends with " + std::to_string(arguments.size()) +
              " rows of numbers; it needs two or more.");
    name_of_argument = names[0];
    functions.reserve(values.size());
    for (std::size_t c = 0; c < values.size(); ++c)
      functions.emplace_back(*this, names[c + 1], c);
  }



  double
  DataTable::Column::value(const double argument) const
  {
    const std::vector<double> &x = table.arguments, &y = table.values[number];
    if (table.outside == Outside::refuse &&
        !(argument >= x.front() && argument <= x.back()))
      return std::numeric_limits<double>::quiet_NaN();
    if (std::isnan(argument))
      return argument;
    const std::size_t next =
      std::upper_bound(x.begin(), x.end(), argument) - x.begin();
    if (next == 0)
      return y.front();
    if (next == x.size())
      return y.back();
    if (may_jump())
      return y[next - 1];
    // This form is exact at rows and cannot overflow in y[next] - y[next - 1].
    const double share = (argument - x[next - 1]) / (x[next] - x[next - 1]);
    return (1. - share) * y[next - 1] + share * y[next];
  }



  std::string
  DataTable::Column::explain_gap(const double argument) const
  {
    return "'" + excerpt(name) + "' of '" + table.section +
           "' has no value at " + as_text(argument) + ", since '" +
           excerpt(table.name_of_argument) + "' goes from " +
           as_text(table.arguments.front()) + " to " +
           as_text(table.arguments.back()) + " in '" + table.file + "'";
  }



  void
  use_tables(const Tables &tables)
  {
    // Functions of deal.II and muParser, and variables of expressions.
    std::vector<std::string> taken =
      internal::FunctionParser::get_function_names();
    for (const char *name :
         {"sin",  "cos",   "tan",   "asin",      "acos",     "atan",  "sinh",
          "cosh", "tanh",  "asinh", "acosh",     "log2",     "exp",   "abs",
          "sqrt", "sign",  "rint",  "sum",       "avg",      "min",   "max",
          "ln",   "atan2", "atanh", "log10",     "erf",      "x",     "y",
          "z",    "t",     "id",    "pi",        "Pi",       "_pi",   "_e",
          "p",    "fmod",  "rand",  "rand_seed", "sigma_eq", "eps_eq"})
      taken.emplace_back(name);
    for (const auto &table : tables)
      for (const DataTable::Column &column : table->columns())
        {
          if (std::find(taken.begin(), taken.end(), column.name) != taken.end())
            refuse("'" + table->section + "/File': the column '" +
                   excerpt(column.name) + "' of '" + table->file +
                   "' has a name that expressions know already, as those of "
                   "places, functions and what laws are given (x, t, p, id); "
                   "give it another one.");
          taken.push_back(column.name);
        }
    current_tables() = tables;
  }



  const Tables &
  tables_in_use()
  {
    return current_tables();
  }



  std::vector<std::shared_ptr<const DataTable::Column>>
  columns_in(const std::string &text)
  {
    std::vector<std::shared_ptr<const DataTable::Column>> columns;
    for (const auto &table : current_tables())
      for (const DataTable::Column &column : table->columns())
        if (mentions(text, column.name))
          columns.emplace_back(table, &column); // keeps the table
    return columns;
  }
} // namespace Viscoplastic
