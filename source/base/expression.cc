// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table_parser.h>
#include <viscoplastic_contact/base/types.h>

#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// A message of muParser with a full stop, which most of them lack.
    std::string
    as_sentence(const std::string &words)
    {
      return words.empty() || words.back() == '.' ? words : words + '.';
    }



    /// The unknown name of a variable or function of which a message of
    /// muParser complains; empty if it complains of something else.
    std::string
    unknown_name(const std::string &words, const std::string &variables)
    {
      const std::string introduction = "Unexpected token \"";
      if (words.compare(0, introduction.size(), introduction) != 0)
        return "";
      const std::string name = identifier_at(words, introduction.size());
      return name.empty() || mentions(variables, name) ? "" : name;
    }



    /// Turn "x,y,t" into "x, y and t".
    std::string
    list_of(const std::string &variables)
    {
      std::string result = Utilities::replace_in_string(variables, ",", ", ");
      return result.replace(result.rfind(", "), 2, " and ");
    }



    /// Refuse likely mistakes that muParser accepts: a list `0,5', of which it
    /// takes the last value; an assignment `x = 1' in place of a comparison;
    /// and random numbers, which differ from run to run and from rank to rank.
    void
    refuse_slips(const std::string &text, const std::string &entry)
    {
      const auto refuse = [&](const std::string &why) {
        throw ExpressionError("The expression '" +
                                excerpt(Utilities::trim(text)) + "' of '" +
                                entry + "' " + why,
                              entry);
      };
      for (const char *function : {"rand", "rand_seed"})
        if (mentions(text, function))
          refuse("has random numbers ('" + std::string(function) +
                 "'), with which no run can be repeated.");
      int depth = 0;
      for (std::size_t i = 0; i < text.size(); ++i)
        {
          const char c    = text[i];
          const char last = i > 0 ? text[i - 1] : ' ';
          const char next = i + 1 < text.size() ? text[i + 1] : ' ';
          depth += c == '(' ? 1 : c == ')' ? -1 : 0;
          if (c == ',' && depth == 0)
            refuse("has a comma outside of parentheses; numbers have a "
                   "decimal point.");
          if (c == ';')
            refuse("has more than one component, but one is needed.");
          if (c == '=' && next != '=' && last != '=' && last != '!' &&
              last != '<' && last != '>')
            refuse("has a single '='; comparisons are written '=='.");
        }
    }



  } // namespace



  std::shared_ptr<ParserWithTables>
  parse_expression(const std::string &text,
                   const std::string &variables,
                   const std::string &entry)
  {
    if (Utilities::trim(text).empty())
      throw ExpressionError("The expression of '" + entry + "' is empty.",
                            entry);
    refuse_slips(text, entry);
    try
      {
        return std::make_shared<ParserWithTables>(text, variables);
      }
    catch (const std::exception &)
      {
        const std::string why  = reason_of_current_exception(),
                          name = unknown_name(why, variables);
        throw ExpressionError(
          "The expression '" + excerpt(Utilities::trim(text)) + "' of '" +
            entry + "' cannot be parsed: " +
            (name.empty() ? as_sentence(excerpt(why, 200)) :
                            "there is no '" + excerpt(name) +
                              "'; its variables are " + list_of(variables) +
                              ", and pi and functions such as sin, exp, min "
                              "and if are known."),
          entry);
      }
  }



  template <int dim>
  Point<dim>
  parse_point(const std::string &text, const std::string &entry)
  {
    std::vector<double> numbers;
    for (const std::string &number : Utilities::split_string_list(text, ','))
      numbers.push_back(
        number_of(number).value_or(std::numeric_limits<double>::infinity()));
    if (numbers.size() != dim ||
        !std::all_of(numbers.begin(), numbers.end(), [](const double x) {
          return std::isfinite(x);
        }))
      refuse("'" + entry + "' is '" + excerpt(text) + "', but it needs " +
             std::to_string(dim) + " finite numbers.");
    Point<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = numbers[d];
    return result;
  }



  template <int dim>
  Expression<dim>::Expression(const std::string &text,
                              const std::string &entry,
                              const std::string &variables)
    : text(Utilities::trim(text))
    , entry(entry)
    , variables(variables)
    , time_dependent(mentions(text, "t"))
    , position_dependent(false)
    , constant(0.)
    , parser(parse_expression(text, variables + ",t", entry))
  {
    const auto names = Utilities::split_string_list(variables);
    for (std::size_t i = 0; i < names.size(); ++i)
      (i < dim ? position_dependent : has_additional_variable) |=
        mentions(text, names[i]);
    constant = parser->value();
    // Check a constant here, since its value may never be asked for.
    if (!time_dependent && !position_dependent && !has_additional_variable)
      value(Point<dim>(), 0.);
  }



  template <int dim>
  Expression<dim>::Expression(const Function    &function,
                              const std::string &entry)
    : entry(entry)
    , variables(coordinate_names<dim>)
    , time_dependent(true)
    , position_dependent(true)
    , constant(0.)
    , function(function)
  {}



  template <int dim>
  double
  Expression<dim>::value(const Point<dim> &x,
                         const double      t,
                         const double      additional) const
  {
    double result = constant;
    if (!parser)
      result = function(x, t);
    else if (time_dependent || position_dependent || has_additional_variable)
      {
        if (has_additional_variable)
          parser->variables[dim] = additional;
        std::copy(x.begin_raw(), x.end_raw(), parser->variables.begin());
        parser->variables.back() = t;
        result                   = parser->value();
      }
    require_finite(result, x, t);
    return result;
  }



  template <int dim>
  void
  Expression<dim>::require_finite(const double      result,
                                  const Point<dim> &x,
                                  const double      t) const
  {
    if (!std::isfinite(result))
      {
        const std::string gap = parser ? parser->last_gap() : "";
        // Other variables may follow the components of x.
        auto names = Utilities::split_string_list(variables);
        names.resize(dim);
        std::string position;
        for (const std::string &name : names)
          position += (position.empty() ? "" : ",") + name;
        refuse("The expression '" + (parser ? excerpt(text) : "derived") +
               "' of '" + entry + "' has the value " + as_text(result) +
               " at " + (position == coordinate_names<dim> ? "x" : position) +
               " = (" + as_text(x) + "), t = " + as_text(t) +
               (gap.empty() ? "; it must be finite." : ": " + gap + "."));
      }
  }



  template <int dim>
  bool
  Expression<dim>::may_jump() const
  {
    if (!parser || !time_dependent)
      return false;
    bool result =
      text.find_first_of("<>=!?") != std::string::npos || parser->may_jump();
    for (const char *function : {"if", "int", "ceil", "floor", "rint", "sign"})
      result = result || mentions(text, function);
    return result;
  }



  template <int dim>
  std::vector<double>
  Expression<dim>::rows_of_tables() const
  {
    std::vector<double> result;
    for (const auto &column : columns_in(text))
      result.insert(result.end(),
                    column->nodes().begin(),
                    column->nodes().end());
    return result;
  }



  template <int dim>
  bool
  Expression<dim>::may_have_kinks() const
  {
    if (!parser || !time_dependent)
      return false;
    bool result = may_jump() || parser->has_tables();
    for (const char *function :
         {"abs", "min", "max", "fmod", "asin", "acos", "sqrt"})
      result = result || mentions(text, function);
    return result;
  }



  template <int dim>
  Tensor<1, dim>
  Expression<dim>::gradient(const Point<dim> &x, const double t) const
  {
    if (!position_dependent)
      return {};
    // The step balances truncation and rounding of a central difference.
    Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double h = 1e-5 * std::max(1e-3, std::abs(x[d]));
        Point<dim>   left(x), right(x);
        left[d] -= h;
        right[d] += h;
        result[d] = (value(right, t) - value(left, t)) / (right[d] - left[d]);
      }
    return result;
  }



  template <int dim>
  VectorExpression<dim>::VectorExpression(const std::string &text,
                                          const unsigned int n_components,
                                          const std::string &entry)
  {
    const auto parts = Utilities::split_string_list(text, ';');
    if (parts.size() != n_components)
      refuse("'" + entry + "' needs " + std::to_string(n_components) +
             " components separated by semicolons, but '" + excerpt(text) +
             "' has " + std::to_string(parts.size()) + ".");
    for (const std::string &part : parts)
      components.emplace_back(part, entry);
  }



  template <int dim>
  VectorExpression<dim>::VectorExpression(const Function    &function,
                                          const std::string &entry)
    : function(function)
  {
    for (unsigned int d = 0; d < dim; ++d)
      components.emplace_back([function,
                               d](const Point<dim> &x,
                                  const double t) { return function(x, t)[d]; },
                              entry);
  }



  template <int dim>
  VectorExpression<dim>::VectorExpression(
    const std::vector<typename Expression<dim>::Function> &functions,
    const std::string                                     &entry)
  {
    for (const auto &function : functions)
      components.emplace_back(function, entry);
  }



  template <int dim>
  Tensor<1, dim>
  VectorExpression<dim>::vector(const Point<dim> &x, const double t) const
  {
    Tensor<1, dim> result;
    if (!function)
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = value(x, t, d);
    else
      {
        result = function(x, t);
        for (unsigned int d = 0; d < dim; ++d)
          components[d].require_finite(result[d], x, t);
      }
    return result;
  }



  template <int dim>
  std::optional<VectorExpression<dim>>
  optional_vector(const std::string &text,
                  const unsigned int n_components,
                  const std::string &entry)
  {
    if (Utilities::trim(text).empty())
      return {};
    VectorExpression<dim> expression(text, n_components, entry);
    if (expression.is_zero())
      return {};
    return expression;
  }



  template class Expression<1>;
  VISCOPLASTIC_INSTANTIATE_CLASS(Expression);
  VISCOPLASTIC_INSTANTIATE_CLASS(VectorExpression);
  VISCOPLASTIC_INSTANTIATE(parse_point);
  VISCOPLASTIC_INSTANTIATE(optional_vector);
} // namespace Viscoplastic
