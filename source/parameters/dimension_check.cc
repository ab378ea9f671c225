// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/numbers.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/dimension_check.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// A part of an expression.
    struct Value
    {
      /// The dimension of the value; nothing if numbers without unit make it
      /// fit any dimension.
      std::optional<Dimension> dimension;
      /// The value of a constant, which is needed if it is an exponent.
      std::optional<double> number = {};
      /// Whether a number in it has a unit.
      bool has_unit = false;
    };

    const Value anything{}, pure_number{Dimension()};

    bool
    is_pure(const Value &value)
    {
      return !value.dimension || *value.dimension == Dimension();
    }

    /// Thrown if the text cannot be read.
    struct Unreadable
    {};

    const std::map<std::string, Value> variables{
      {"x", {Dimension{1., 0., 0.}}},
      {"y", {Dimension{1., 0., 0.}}},
      {"z", {Dimension{1., 0., 0.}}},
      {"t", {Dimension{0., 1., 0.}}},
      {"T", {Dimension{0., 0., 0., 1.}}},
      {"sigma_eq", {Dimension{0., 0., 1.}}},
      {"p", {Dimension{0., 0., 1.}}},
      {"eps_eq", pure_number},
      {"id", pure_number},
      {"pi", {Dimension(), numbers::PI}},
      {"Pi", {Dimension(), numbers::PI}}};

    const std::set<std::string> of_pure_numbers{
      "sin",   "cos",   "tan",  "cot",  "csc",  "sec",   "asin",
      "acos",  "atan",  "sinh", "cosh", "tanh", "asinh", "acosh",
      "atanh", "log10", "log2", "log",  "ln",   "exp",   "erfc"},
      of_equals{"min",
                "max",
                "sum",
                "avg",
                "abs",
                "int",
                "rint",
                "ceil",
                "floor",
                "fmod"};



    /// Parses an expression as muParser does and computes its dimension. Throws
    /// ExcMessage with a part of the message if dimensions contradict.
    class DimensionReader
    {
    public:
      explicit DimensionReader(const std::string &text)
        : text(text)
      {}

      Value
      whole()
      {
        const Value value = choice();
        require(at == text.size());
        return value;
      }

    private:
      static void
      require(const bool is_readable)
      {
        if (!is_readable)
          throw Unreadable();
      }

      /// Skip and return the first of the @p tokens that comes next; return an
      /// empty string if none does. Skips blanks.
      std::string
      take(const std::vector<std::string> &tokens)
      {
        at = std::min(text.find_first_not_of(' ', at), text.size());
        for (const std::string &token : tokens)
          if (text.compare(at, token.size(), token) == 0)
            {
              at += token.size();
              return token;
            }
        return "";
      }

      bool
      takes(const std::string &token)
      {
        return !take({token}).empty();
      }

      /// The part of the text from @p begin to here.
      std::string
      part(const std::size_t begin) const
      {
        return "'" + excerpt(Utilities::trim(text.substr(begin, at - begin))) +
               "'";
      }

      /// Return the value of an operation on two operands that must have the
      /// same dimension.
      Value
      common(const Value &a, const Value &b, const std::size_t begin) const
      {
        if (a.dimension && b.dimension && !(*a.dimension == *b.dimension))
          refuse(part(begin) + " brings together " + in_words(*a.dimension) +
                 " and " + in_words(*b.dimension));
        return {a.dimension ? a.dimension : b.dimension,
                {},
                a.has_unit || b.has_unit};
      }

      static Value
      power(const Value &base, const Value &exponent)
      {
        if (!is_pure(exponent))
          refuse("an exponent is " + in_words(*exponent.dimension) +
                 ", since a unit follows it; write 1e6 for 10^6 and ^5/(1 day) "
                 "for ^5/day");
        if (!is_pure(base) && !exponent.number)
          return anything;
        Value result = base;
        result.number.reset();
        if (!is_pure(base))
          result.dimension = base.dimension->power(*exponent.number);
        if (base.number && exponent.number)
          result.number = std::pow(*base.number, *exponent.number);
        return result;
      }

      /// Count the depth of the recursion; muParser itself needs no deep stack.
      void
      descend()
      {
        if (++depth > 1000)
          refuse("'" + excerpt(text) +
                 "' is nested more than 1000 deep, too deep for its units");
      }

      Value
      choice()
      {
        descend();
        const std::size_t begin = at;
        Value             value = binary(0);
        if (takes("?"))
          {
            value = choice();
            require(takes(":"));
            value = common(value, choice(), begin);
          }
        --depth;
        return value;
      }

      /// Read operands between binary operators of at least this precedence;
      /// later rows of the table bind more tightly.
      Value
      binary(const std::size_t precedence)
      {
        static const std::vector<std::vector<std::string>> operators{
          {"&&", "||", "&", "|"},
          {"<=", ">=", "==", "!=", "<", ">"},
          {"+", "-"},
          {"*", "/"}};
        if (precedence == operators.size())
          return factor();
        const std::size_t begin = at;
        Value             value = binary(precedence + 1);
        for (std::string sign; !(sign = take(operators[precedence])).empty();)
          {
            const Value other = binary(precedence + 1);
            if (precedence == 3)
              value = product(value, other, sign == "*" ? 1. : -1.);
            else if (precedence == 2)
              {
                const double factor = sign == "+" ? 1. : -1.;
                const auto   a = value.number, b = other.number;
                value = common(value, other, begin);
                if (a && b)
                  value.number = *a + factor * *b;
              }
            else
              {
                if (precedence == 1)
                  common(value, other, begin);
                value = anything;
              }
          }
        return value;
      }

      static Value
      product(Value a, Value b, const double exponent)
      {
        // A number without unit is a pure one beside numbers with units.
        for (const auto &[bare, other] :
             {std::make_pair(&a, &b), std::make_pair(&b, &a)})
          if (!bare->dimension && bare->number && !bare->has_unit &&
              other->has_unit && !is_pure(*other))
            bare->dimension = Dimension();
        Value result{{}, {}, a.has_unit || b.has_unit};
        if (a.number && b.number)
          result.number = *a.number * std::pow(*b.number, exponent);
        if (a.dimension && b.dimension)
          result.dimension = *a.dimension * b.dimension->power(exponent);
        return result;
      }

      Value
      factor()
      {
        descend();
        const std::string sign  = take({"-", "+", "!"});
        Value             value = sign.empty() ? atom() : factor();
        if (sign.empty() && takes("^"))
          value = power(value, factor());
        if (sign == "-" && value.number)
          value.number = -*value.number;
        --depth;
        return value;
      }

      Value
      atom()
      {
        if (takes("("))
          {
            const Value value = choice();
            require(takes(")"));
            return value;
          }
        const std::size_t begin = at;
        if (at = end_of_number(text, begin); at > begin)
          {
            if (const auto found = read_unit(text, at))
              {
                at = found->end;
                return {found->unit.dimension, {}, true};
              }
            return {{}, std::strtod(&text[begin], nullptr)};
          }
        const std::string name = identifier_at(text, begin);
        require(!name.empty());
        at += name.size();
        if (takes("("))
          return call(name, begin);
        const auto variable = variables.find(name);
        return variable == variables.end() ? anything : variable->second;
      }

      Value
      call(const std::string &name, const std::size_t begin)
      {
        std::vector<Value> arguments;
        while (!takes(")"))
          {
            require(arguments.empty() || takes(","));
            arguments.push_back(choice());
          }
        const std::size_t n = arguments.size();
        if (n == 1 && of_pure_numbers.count(name) > 0)
          {
            if (!is_pure(arguments[0]))
              refuse(part(begin) + " is a function of " +
                     in_words(*arguments[0].dimension) + ", but '" + name +
                     "' takes a pure number");
            return pure_number;
          }
        if (n > 0 && of_equals.count(name) > 0)
          {
            Value value = arguments[0];
            for (const Value &argument : arguments)
              value = common(value, argument, begin);
            return value;
          }
        if (n == 3 && name == "if")
          return common(arguments[1], arguments[2], begin);
        if (n == 2 && name == "pow")
          return power(arguments[0], arguments[1]);
        if (n == 2 && name == "atan2")
          {
            common(arguments[0], arguments[1], begin);
            return pure_number;
          }
        if (n == 1 && name == "sqrt")
          return power(arguments[0], {{}, 0.5});
        return anything; // sign(), columns of tables, and functions that
                         // muParser refuses
      }

      const std::string &text;
      std::size_t        at    = 0;
      unsigned int       depth = 0;
    };



    /// Split a list at separators outside of parentheses.
    std::vector<std::string>
    parts_of_list(const std::string &text)
    {
      const std::string separators =
        text.find('?') == std::string::npos ? ";,:" : ";,";
      std::vector<std::string> result(1);
      int                      depth = 0;
      for (const char c : text)
        {
          depth += c == '(' ? 1 : c == ')' ? -1 : 0;
          if (depth == 0 && separators.find(c) != std::string::npos)
            result.emplace_back();
          else
            result.back() += c;
        }
      return result;
    }
  } // namespace



  std::string
  wrong_dimension(const std::string              &text,
                  const std::optional<Dimension> &wanted)
  {
    for (const std::string &part : parts_of_list(text))
      try
        {
          const auto dimension = DimensionReader(part).whole().dimension;
          if (dimension && wanted && !(*dimension == *wanted))
            return "'" + excerpt(Utilities::trim(part)) + "' is " +
                   in_words(*dimension) + ", but it must be " +
                   in_words(*wanted) +
                   (dimension->length == wanted->length &&
                        dimension->stress == wanted->stress ?
                      "; t has a unit here, t/(1 h) has none" :
                      "");
        }
      catch (const ExceptionBase &contradiction)
        {
          return reason(contradiction);
        }
      catch (const Unreadable &)
        {} // the parser of expressions reports the error
    return "";
  }



  std::size_t
  end_of_number(const std::string &text, const std::size_t begin)
  {
    const char *const from = text.data() + begin;
    if (begin >= text.size() ||
        (*from != '.' && std::isdigit(static_cast<unsigned char>(*from)) == 0))
      return begin;
    double number;
    return std::from_chars(from, text.data() + text.size(), number).ptr -
           text.data();
  }
} // namespace Viscoplastic
