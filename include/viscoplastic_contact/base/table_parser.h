// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/function_parser.h>
#include <deal.II/base/mu_parser_internal.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/table.h>

#include <muParser.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// A FunctionParser with the same variables, constants and functions as in
  /// deal.II that can also call columns of tables, which deal.II does not let
  /// users add to muParser. One more variable may stand between the coordinates
  /// and time. Evaluation costs half of that in deal.II, which looks up the
  /// parser of the thread; this class is not thread-safe.
  template <int dim>
  class ParserWithTables : public FunctionParser<dim>
  {
  public:
    explicit ParserWithTables(
      const std::vector<std::shared_ptr<const DataTable::Column>> &columns)
      : FunctionParser<dim>(1)
    {
      for (const auto &column : columns)
        calls.push_back({column, *this});
    }

    using FunctionParser<dim>::initialize;

    void
    initialize(const std::string                   &variable_names,
               const std::vector<std::string>      &expressions,
               const std::map<std::string, double> &constants,
               const bool /*time_dependent*/) override
    {
      namespace Functions = internal::FunctionParser;
      const auto names    = Utilities::split_string_list(variable_names, ',');
      variables.resize(names.size());
      for (std::size_t i = 0; i < names.size(); ++i)
        parser.DefineVar(names[i], &variables[i]);
      try
        {
          for (const auto &[name, value] : constants)
            parser.DefineConst(name, value);
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
          std::string text;
          for (const char c : expressions[0])
            {
              if (c == '(')
                text.erase(text.find_last_not_of(" \t") + 1);
              text += c;
            }
          parser.SetExpr(text);
        }
      catch (const mu::ParserError &error) // not derived from std::exception
        {
          AssertThrow(false, ExcMessage(error.GetMsg()));
        }
    }

    double
    value(const Point<dim> &x, const unsigned int /*component*/) const override
    {
      gap.clear();
      for (unsigned int d = 0; d < dim; ++d)
        variables[d] = x[d];
      variables.back() = this->get_time();
      try
        {
          return parser.Eval();
        }
      catch (const mu::ParserError &error)
        {
          AssertThrow(false, ExcMessage(error.GetMsg()));
        }
      return 0.;
    }

    /// Set the variable between the coordinates and time.
    void
    set_additional_variable(const double value) const
    {
      variables[dim] = value;
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

    // Modified by evaluations.
    mutable mu::Parser          parser;
    mutable std::vector<double> variables;
    mutable std::string         gap;
    std::vector<Call>           calls;
  };
} // namespace Viscoplastic
