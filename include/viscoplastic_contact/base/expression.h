// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// Thrown if an expression of the parameter file cannot be parsed. Code that
  /// knows the file can add the line of the entry.
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


  class ParserWithTables;

  /// Return a muParser function of @p variables, e.g. "x,y,t". @p entry names
  /// the parameter in error messages. Throws ExpressionError when @p text
  /// cannot be parsed.
  std::shared_ptr<ParserWithTables>
  parse_expression(const std::string &text,
                   const std::string &variables,
                   const std::string &entry);



  /// The names of the coordinates: "x,y" or "x,y,z".
  template <int dim>
  const std::string coordinate_names = std::string("x,y,z").substr(0,
                                                                   2 * dim - 1);



  /// Parse a point or vector: dim numbers separated by commas. Throws
  /// ExcMessage naming @p entry.
  template <int dim>
  Point<dim>
  parse_point(const std::string &text, const std::string &entry);


  /// A scalar datum of the scene: a muParser expression of x, y, (z,) t given
  /// in the parameter file. It tells on which variables it depends, so that
  /// callers can avoid needless evaluations.
  template <int dim>
  class Expression
  {
  public:
    /// @p entry names the parameter in error messages. @p variables are the
    /// names of the dim arguments before t, by default the coordinates, and
    /// optionally of one more. Throws ExpressionError when @p text cannot be
    /// parsed.
    Expression(const std::string &text,
               const std::string &entry,
               const std::string &variables = coordinate_names<dim>);

    using Function = std::function<double(const Point<dim> &, const double)>;

    /// A datum given by a function, which may depend on place and time; @p
    /// entry names its origin in error messages.
    Expression(const Function &function, const std::string &entry);

    /// Return the value; throws ExcMessage naming entry, place and time if it
    /// is not finite. @p additional is the value of the variable that follows
    /// the first dim ones, if any.
    double
    value(const Point<dim> &x,
          const double      t,
          const double      additional = 0.) const;

    /// Throw ExcMessage naming entry, place and time unless @p result, the
    /// value at x and t, is finite.
    void
    require_finite(const double      result,
                   const Point<dim> &x,
                   const double      t) const;

    /// Return the gradient, computed by central differences.
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

    /// Whether it depends on a variable other than the first dim ones and t.
    bool
    depends_on_additional_variable() const
    {
      return has_additional_variable;
    }

    /// Whether the expression depends on time and contains conditions, steps or
    /// piecewise constant tables; poles are not detected.
    bool
    may_jump() const;

    /// Whether the expression depends on time and its time derivative may jump.
    bool
    may_have_kinks() const;

    /// The arguments in the rows of all tables that the expression calls.
    std::vector<double>
    rows_of_tables() const;

    const std::string &
    name_of_entry() const
    {
      return entry;
    }

    /// Whether both have the same text and variables; false for functions.
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
    std::string                       text, entry, variables;
    bool                              time_dependent, position_dependent;
    bool                              has_additional_variable = false;
    double                            constant;
    std::shared_ptr<ParserWithTables> parser;
    Function                          function; // used if there is no parser
  };


  /// A vector of expressions, which are separated by semicolons in the file.
  template <int dim>
  class VectorExpression
  {
  public:
    VectorExpression(const std::string &text,
                     const unsigned int n_components,
                     const std::string &entry);

    using Function =
      std::function<Tensor<1, dim>(const Point<dim> &, const double)>;

    /// The dim components of one function, which vector() evaluates only once.
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

    /// Whether all components are written as those of @p other.
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
    Function                     function; // vector-valued, if any
  };


  /// Parse an optional datum of a scene; returns nothing if @p text is empty or
  /// all components are identically zero.
  template <int dim>
  std::optional<VectorExpression<dim>>
  optional_vector(const std::string &text,
                  const unsigned int n_components,
                  const std::string &entry);
} // namespace Viscoplastic
