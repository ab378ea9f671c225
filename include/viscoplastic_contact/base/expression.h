// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/function_parser.h>
#include <deal.II/base/point.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// An expression of the parameter file that cannot be parsed. Who knows the
  /// file can add the place of the entry.
  class ExpressionError : public StandardExceptions::ExcMessage
  {
  public:
    ExpressionError(const std::string &sentence, const std::string &entry)
      : StandardExceptions::ExcMessage(sentence)
      , entry(entry)
    {}

    /// The path of the entry, such as "Boundary 0/Traction".
    const std::string entry;
  };


  /// A muParser function of @p variables, e.g. "x,y,t", of which the last is
  /// what set_time() sets. @p entry names the parameter in error messages.
  /// Throws ExpressionError when @p text cannot be parsed.
  template <int dim>
  std::unique_ptr<FunctionParser<dim>>
  parse_expression(const std::string &text,
                   const std::string &variables,
                   const std::string &entry);


  /// A point or vector of the parameter file: dim numbers separated by commas.
  /// Throws ExcMessage naming @p entry.
  template <int dim>
  Point<dim>
  parse_point(const std::string &text, const std::string &entry);


  /// A scalar datum of the scene: a muParser expression of x, y, (z,) t given
  /// in the parameter file. It knows what it does not depend on, so that its
  /// users need not evaluate what cannot change.
  template <int dim>
  class Expression
  {
  public:
    /// @p entry names the parameter in error messages. @p variables are the
    /// names of the dim arguments before t where these are no coordinates; one
    /// more may follow them. Throws ExpressionError when @p text cannot be
    /// parsed.
    Expression(const std::string &text,
               const std::string &entry,
               const std::string &variables =
                 FunctionParser<dim>::default_variable_names());

    using Function = std::function<double(const Point<dim> &, const double)>;

    /// A datum that follows from others in ways unknown here; @p entry names
    /// what it follows from.
    Expression(const Function &function, const std::string &entry);

    /// Throws ExcMessage naming entry, place and time if not finite. @p
    /// additional is the variable that follows the dim first ones, if any.
    double
    value(const Point<dim> &x,
          const double      t,
          const double      additional = 0.) const;

    /// Throw ExcMessage, naming entry, place and time, unless the value @p
    /// result that is known already is finite.
    void
    require_finite(const double      result,
                   const Point<dim> &x,
                   const double      t) const;

    /// The gradient, by central differences of the expression.
    Tensor<1, dim>
    gradient(const Point<dim> &x, const double t) const;

    bool
    depends_on_time() const
    {
      return time_dependent;
    }

    bool
    depends_on_position() const
    {
      return position_dependent;
    }

    /// Whether it depends on a variable beside the dim first ones and time.
    bool
    depends_on_additional_variable() const
    {
      return has_additional_variable;
    }

    /// Whether it depends on time and has conditions or steps in it; poles are
    /// not looked for.
    bool
    may_jump() const;

    /// Whether it depends on time and its first derivative may jump.
    bool
    may_have_kinks() const;

    /// The arguments at which tables that it calls have a row.
    std::vector<double>
    rows_of_tables() const;

    const std::string &
    name_of_entry() const
    {
      return entry;
    }

    /// Whether both are of the same text; not of functions that have none.
    bool
    is_written_as(const Expression &other) const
    {
      return parser && other.parser && text == other.text &&
             variables == other.variables;
    }

    /// True for a constant expression of value zero.
    bool
    is_zero() const
    {
      return !time_dependent && !position_dependent &&
             !has_additional_variable && constant == 0.;
    }

  private:
    std::string                          text, entry, variables;
    bool                                 time_dependent, position_dependent;
    bool                                 has_additional_variable = false;
    double                               constant;
    std::unique_ptr<FunctionParser<dim>> parser;
    Function                             function; // if there is no parser
  };


  /// Expressions, one a component, separated by semicolons in the file.
  template <int dim>
  class VectorExpression
  {
  public:
    VectorExpression(const std::string &text,
                     const unsigned int n_components,
                     const std::string &entry);

    using Function =
      std::function<Tensor<1, dim>(const Point<dim> &, const double)>;

    /// The dim components of one function, which vector() calls once for all.
    VectorExpression(const Function &function, const std::string &entry);

    /// A component for each function.
    VectorExpression(
      const std::vector<typename Expression<dim>::Function> &functions,
      const std::string                                     &entry);

    double
    value(const Point<dim> &x, const double t, const unsigned int c) const
    {
      return components[c].value(x, t);
    }

    /// The first dim components.
    Tensor<1, dim>
    vector(const Point<dim> &x, const double t) const;

    bool
    depends_on_time() const
    {
      for (const auto &component : components)
        if (component.depends_on_time())
          return true;
      return false;
    }

    bool
    is_zero() const
    {
      for (const auto &component : components)
        if (!component.is_zero())
          return false;
      return true;
    }

    /// Whether it has the same text as another one, and is the same function.
    bool
    is_written_as(const VectorExpression &other) const
    {
      bool result = components.size() == other.components.size();
      for (unsigned int c = 0; result && c < components.size(); ++c)
        result = components[c].is_written_as(other.components[c]);
      return result;
    }

    const Expression<dim> &
    operator[](const unsigned int c) const
    {
      return components[c];
    }

  private:
    std::vector<Expression<dim>> components;
    Function                     function; // of all components, or none
  };


  /// A datum of a scene that may be missing: nothing if @p text is empty or
  /// all components are identically zero.
  template <int dim>
  std::optional<VectorExpression<dim>>
  optional_vector(const std::string &text,
                  const unsigned int n_components,
                  const std::string &entry);
} // namespace Viscoplastic
