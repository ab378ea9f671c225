// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mu_parser_internal.h>
#include <deal.II/base/numbers.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table.h>

#include <muParser.h>

#include <cmath>

namespace Viscoplastic
{
  using namespace dealii;

  /// A muParser function with the constants and functions of deal.II's
  /// FunctionParser that can also call columns of tables, which that class does
  /// not let users add. Evaluation costs half of that in deal.II, which looks
  /// up the parser of the thread; this class is not thread-safe.
  class ParserWithTables
  {
  public:
    /// Throws ExcMessage with the words of muParser if the text is wrong.
    ParserWithTables(const std::string &text, const std::string &names)
      : variables(Utilities::split_string_list(names).size())
    {
      namespace Functions = internal::FunctionParser;
      std::size_t n       = 0;
      for (const std::string &name : Utilities::split_string_list(names))
        parser.DefineVar(name, &variables[n++]);
      for (const auto &column : columns_in(text))
        calls.push_back({column, *this});
      try
        {
          for (const char *name : {"pi", "Pi"})
            parser.DefineConst(name, numbers::PI);
          parser.DefineFun("if", Functions::mu_if, true);
          parser.DefineOprt("|", Functions::mu_or, 1);
          parser.DefineOprt("&", Functions::mu_and, 2);
          parser.DefineFun("int", Functions::mu_int, true);
          parser.DefineFun("ceil", Functions::mu_ceil, true);
          parser.DefineFun("cot", Functions::mu_cot, true);
          parser.DefineFun("csc", Functions::mu_csc, true);
          parser.DefineFun("floor", Functions::mu_floor, true);
          parser.DefineFun("sec", Functions::mu_sec, true);
          parser.DefineFun("log", Functions::mu_log, true);
          parser.DefineFun("pow", Functions::mu_pow, true);
          parser.DefineFun("erf", Functions::mu_erf, true);
          parser.DefineFun("erfc", Functions::mu_erfc, true);
          for (Call &call : calls)
            parser.DefineFunUserData(call.column->name,
                                     &evaluate,
                                     &call,
                                     false);
          // muParser accepts no blank between a function and its parenthesis.
          std::string without_blanks;
          for (const char c : text)
            {
              if (c == '(')
                without_blanks.erase(without_blanks.find_last_not_of(" \t") +
                                     1);
              without_blanks += c;
            }
          parser.SetExpr(without_blanks);
          value(); // muParser parses at the first evaluation
        }
      catch (const mu::ParserError &error) // not derived from std::exception
        {
          refuse(error.GetMsg());
        }
    }

    ParserWithTables(const ParserWithTables &) = delete;
    ParserWithTables &
    operator=(const ParserWithTables &) = delete;

    /// Return the value for the present `variables`.
    double
    value() const
    {
      gap.clear();
      try
        {
          return parser.Eval();
        }
      catch (const mu::ParserError &error)
        {
          refuse(error.GetMsg());
        }
    }

    bool
    has_tables() const
    {
      return !calls.empty();
    }

    bool
    may_jump() const
    {
      for (const Call &call : calls)
        if (call.column->may_jump())
          return true;
      return false;
    }

    /// Why a table had no value in the last evaluation; empty if all had one.
    const std::string &
    last_gap() const
    {
      return gap;
    }

    std::vector<double> variables; // zero at first

  private:
    struct Call
    {
      std::shared_ptr<const DataTable::Column> column;
      const ParserWithTables                  &caller;
    };

    static double
    evaluate(void *data, const double argument)
    {
      const Call  &call   = *static_cast<const Call *>(data);
      const double result = call.column->value(argument);
      if (std::isnan(result) && !std::isnan(argument))
        call.caller.gap = call.column->explain_gap(argument);
      return result;
    }

    mu::Parser          parser;
    mutable std::string gap;
    std::vector<Call>   calls;
  };
} // namespace Viscoplastic
