// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/units.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <regex>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    constexpr Dimension length_dimension{1., 0., 0.},
      time_dimension{0., 1., 0.}, stress_dimension{0., 0., 1.},
      force_dimension{2., 0., 1.}, energy_dimension{3., 0., 1.};

    // The Julian year has 365.25 days.
    constexpr double day = 86400., year = 365.25 * day;

    // Names that expressions use otherwise are left out: t is time, not tonne.
    const std::vector<Unit> &
    known_units()
    {
      static const std::vector<Unit> units{
        {"nm", length_dimension, 1e-9},
        {"um", length_dimension, 1e-6},
        {"mm", length_dimension, 1e-3},
        {"cm", length_dimension, 1e-2},
        {"m", length_dimension, 1.},
        {"km", length_dimension, 1e3},
        {"ms", time_dimension, 1e-3},
        {"s", time_dimension, 1.},
        {"min", time_dimension, 60.},
        {"h", time_dimension, 3600.},
        {"day", time_dimension, day},
        {"days", time_dimension, day},
        {"year", time_dimension, year},
        {"years", time_dimension, year},
        {"Pa", stress_dimension, 1.},
        {"kPa", stress_dimension, 1e3},
        {"MPa", stress_dimension, 1e6},
        {"GPa", stress_dimension, 1e9},
        {"bar", stress_dimension, 1e5},
        {"N", force_dimension, 1.},
        {"kN", force_dimension, 1e3},
        {"MN", force_dimension, 1e6},
        {"J", energy_dimension, 1.},
        {"kJ", energy_dimension, 1e3},
        {"kg", {1., 2., 1.}, 1.},
        {"K", {0., 0., 0., 1.}, 1.},
        // Amounts of substance are pure numbers, as they only divide energies.
        {"mol", {}, 1.}};
      return units;
    }



    const Unit *
    find_unit(const std::string &name)
    {
      const auto found =
        std::find_if(known_units().begin(),
                     known_units().end(),
                     [&name](const Unit &unit) { return unit.name == name; });
      return found == known_units().end() ? nullptr : &*found;
    }



    /// Return "length^2", or the name alone for an exponent of 1.
    std::string
    power(const std::string &name, const double exponent)
    {
      return exponent == 1. ? name : name + '^' + as_text(exponent);
    }



    /// Reads a text from left to right.
    struct Cursor
    {
      const std::string &text;
      std::size_t        at;

      char
      next() const
      {
        return at < text.size() ? text[at] : '\0';
      }

      void
      skip_blanks()
      {
        at = std::min(text.find_first_not_of(' ', at), text.size());
      }

      /// Read letters, digits and underscores that begin with a letter.
      std::string
      word()
      {
        const std::string result = next() == '_' ? "" : identifier_at(text, at);
        at += result.size();
        return result;
      }

      /// Whether a parenthesis follows, which makes the word a function.
      bool
      is_call() const
      {
        const std::size_t i = text.find_first_not_of(' ', at);
        return i != std::string::npos && text[i] == '(';
      }

      /// Read the exponent of a unit, `^-5' or `^(-5)'; 1 if there is none, or
      /// if it is none, which the parser of the expression reports.
      double
      exponent()
      {
        static const std::regex number("\\^(?:([-+]?[0-9.]+)|"
                                       "\\(([-+]?[0-9.]+)\\))");
        std::smatch             found;
        if (!std::regex_search(text.begin() + at,
                               text.end(),
                               found,
                               number,
                               std::regex_constants::match_continuous))
          return 1.;
        at += found.length();
        return std::strtod(found.str(found[1].matched ? 1 : 2).c_str(),
                           nullptr);
      }
    };



    /// Read the product of units in the parentheses that begin at the cursor,
    /// and move the cursor behind them. If they contain anything else, return
    /// nothing and leave the cursor.
    std::optional<Unit>
    read_group(Cursor &cursor)
    {
      const std::size_t end = cursor.text.find(')', cursor.at);
      if (cursor.next() != '(' || end == std::string::npos)
        return {};
      const std::string inside =
        ' ' +
        Utilities::trim(cursor.text.substr(cursor.at + 1, end - cursor.at - 1));
      const auto found = read_unit(inside, 0);
      if (!found || found->end != inside.size())
        return {};
      cursor.at = end + 1;
      return found->unit;
    }



    /// Return the SI prefix for a power of ten, or nothing if there is none.
    std::optional<std::string>
    prefix(const double size)
    {
      static const std::map<int, std::string> prefixes{{-9, "n"},
                                                       {-6, "u"},
                                                       {-3, "m"},
                                                       {0, ""},
                                                       {3, "k"},
                                                       {6, "M"},
                                                       {9, "G"},
                                                       {12, "T"},
                                                       {15, "P"}};
      const double                            power = std::log10(size);
      const auto found = prefixes.find(static_cast<int>(std::lround(power)));
      if (found == prefixes.end() || std::abs(power - found->first) > 1e-9)
        return {};
      return found->second;
    }



    /// Parse the whole @p text as a unit; refuse another dimension than @p
    /// wanted.
    Unit
    declared_unit(const std::string &entry,
                  const std::string &text,
                  const Dimension   &wanted)
    {
      const std::string where =
        "'Units/" + entry + "' is '" + excerpt(text) + "'";
      const auto        found = read_unit(' ' + text, 0);
      const std::string allowed =
        in_words(wanted) + ": " + enumeration(names_of_units(wanted)) +
        (entry == "Stress" ? ", or a product such as N/mm^2" : "");
      const std::string unknown = found ? found->unknown_name : text;
      if (!unknown.empty())
        refuse(where + did_you_mean(unknown,
                                    names_of_units(wanted),
                                    "; it must be " + allowed + "."));
      if (found->end != text.size() + 1)
        refuse(where + ", which is no unit behind '" +
               excerpt(text.substr(0, found->end - 1)) + "'; it must be " +
               allowed + ".");
      if (!(found->unit.dimension == wanted))
        refuse(where + ", " + in_words(found->unit.dimension) +
               "; it must be " + allowed + ".");
      return found->unit;
    }
  } // namespace



  bool
  Dimension::operator==(const Dimension &other) const
  {
    const auto equal = [](const double a, const double b) {
      return std::abs(a - b) < 1e-9;
    };
    return equal(length, other.length) && equal(time, other.time) &&
           equal(stress, other.stress) && equal(temperature, other.temperature);
  }



  Dimension
  Dimension::operator*(const Dimension &other) const
  {
    return {length + other.length,
            time + other.time,
            stress + other.stress,
            temperature + other.temperature};
  }



  std::string
  in_words(const Dimension &dimension)
  {
    static const std::vector<std::pair<Dimension, std::string>> words{
      {{0., 0., 0.}, "a pure number"},
      {{1., 0., 0.}, "a length"},
      {{2., 0., 0.}, "an area"},
      {{3., 0., 0.}, "a volume"},
      {{0., 1., 0.}, "a time"},
      {{0., -1., 0.}, "a rate, 1/time"},
      {{1., -1., 0.}, "a velocity"},
      {{0., 0., 1.}, "a stress"},
      {{2., 0., 1.}, "a force"},
      {{1., 0., 1.}, "a force per length"},
      {{-1., 0., 1.}, "a force per volume"},
      {{3., 0., 1.}, "an energy"},
      {{0., 0., 0., 1.}, "a temperature"},
      {{0., 1., 1.}, "a viscosity, stress times time"}};
    for (const auto &[known, word] : words)
      if (known == dimension)
        return word;
    std::string text;
    for (const auto &[name, exponent] :
         {std::make_pair("length", dimension.length),
          std::make_pair("time", dimension.time),
          std::make_pair("stress", dimension.stress),
          std::make_pair("temperature", dimension.temperature)})
      if (std::abs(exponent) > 1e-9)
        text += (text.empty() ? "" : " ") + power(name, exponent);
    return text;
  }



  std::vector<std::string>
  names_of_units(const std::optional<Dimension> &dimension)
  {
    std::vector<std::string> names;
    for (const Unit &unit : known_units())
      if (!dimension || unit.dimension == *dimension)
        names.push_back(unit.name);
    return names;
  }



  std::optional<UnitInText>
  read_unit(const std::string &text, const std::size_t begin)
  {
    Cursor     cursor{text, begin};
    UnitInText result{{"", {}, 1.}, begin, ""};
    for (bool is_first = true;; is_first = false)
      {
        const std::size_t before = cursor.at;
        cursor.skip_blanks();
        const char sign     = cursor.next();
        const bool has_sign = sign == '/' || (sign == '*' && !is_first);
        if (has_sign)
          {
            ++cursor.at;
            cursor.skip_blanks();
          }
        else if (cursor.at == before)
          break;
        std::optional<Unit> factor;
        if (has_sign && !is_first)
          factor = read_group(cursor);
        if (!factor)
          {
            const std::string name = cursor.word();
            const Unit *const unit = find_unit(name);
            // After a number or a unit and a blank, only a unit can follow. A
            // word after a sign that is no unit belongs to a larger expression,
            // unless it resembles the name of a unit.
            if (unit == nullptr && !cursor.is_call() &&
                (!has_sign || (!is_first && name.size() > 1 &&
                               !nearest_name(name, names_of_units()).empty())))
              result.unknown_name = name;
            if (unit == nullptr || cursor.is_call())
              break;
            factor = *unit;
          }
        const double exponent = (sign == '/' ? -1. : 1.) * cursor.exponent();
        result.unit.dimension =
          result.unit.dimension * factor->dimension.power(exponent);
        result.unit.si *= std::pow(factor->si, exponent);
        result.end = cursor.at;
      }
    if (result.end == begin && result.unknown_name.empty())
      return {};
    const std::size_t first = text.find_first_not_of(' ', begin);
    result.unit.name        = text.substr(first, result.end - first);
    return result;
  }



  Units::Units(const std::string &length_name,
               const std::string &time_name,
               const std::string &stress_name,
               const std::string &force_name)
  {
    if (length_name.empty() && time_name.empty() && stress_name.empty() &&
        force_name.empty())
      return;
    std::vector<std::string> missing;
    if (length_name.empty())
      missing.emplace_back("Length");
    if (time_name.empty())
      missing.emplace_back("Time");
    if (stress_name.empty() && force_name.empty())
      missing.emplace_back("Stress");
    if (!missing.empty())
      refuse(
        "'Units' has no " + enumeration(missing) +
        "; give `Length', `Time' and `Stress' (or `Force'), or none of them.");
    if (!stress_name.empty() && !force_name.empty())
      refuse("'Units' has both `Stress' and `Force'; give one of them, the "
             "other one follows.");
    length = declared_unit("Length", length_name, length_dimension);
    time   = declared_unit("Time", time_name, time_dimension);
    if (!stress_name.empty())
      {
        stress = declared_unit("Stress", stress_name, stress_dimension);
        return;
      }
    const Unit force     = declared_unit("Force", force_name, force_dimension);
    stress.si            = force.si / (length.si * length.si);
    const auto of_pascal = prefix(stress.si);
    stress.name = of_pascal && find_unit(*of_pascal + "Pa") != nullptr ?
                    *of_pascal + "Pa" :
                    force.name + '/' + length.name + "^2";
  }



  std::string
  Units::name(const Quantity quantity, const unsigned int dim_of_mesh) const
  {
    if (!are_declared())
      return "";
    const unsigned int dim             = are_of_whole_bodies ? 3 : dim_of_mesh;
    const auto         power_of_length = [this](const double n) {
      return power(length.name, n);
    };
    // N or J with a prefix if there is one, otherwise a product of stress and
    // powers of length; per length if @p by_length.
    const auto derived = [&](const char        *unit,
                             const unsigned int n,
                             const bool         by_length) {
      const auto found = prefix(si({double(n), 0., 1.}));
      return found ?
               *found + unit + (by_length ? '/' + length.name : std::string()) :
               stress.name + '*' + power_of_length(by_length ? n - 1 : n);
    };
    const std::string                     energy = derived("J", 3, dim == 2);
    const std::map<Quantity, std::string> names{
      {Quantity::pure_number, ""},
      {Quantity::length, length.name},
      {Quantity::area, power_of_length(dim - 1)},
      {Quantity::volume, power_of_length(dim)},
      {Quantity::time, time.name},
      {Quantity::rate, "1/" + time.name},
      {Quantity::velocity, length.name + '/' + time.name},
      {Quantity::stress, stress.name},
      {Quantity::force, derived("N", 2, dim == 2)},
      {Quantity::axial_force, derived("N", 2, false)},
      {Quantity::energy, energy},
      {Quantity::work_per_area, stress.name + '*' + length.name},
      {Quantity::energy_norm, '(' + energy + ")^0.5"},
      {Quantity::rate_norm, '(' + energy + '/' + time.name + ")^0.5"},
      {Quantity::stress_norm, stress.name + '*' + power_of_length(0.5 * dim)},
      {Quantity::temperature, "K"},
      {Quantity::wall_time, "s"}};
    return names.at(quantity);
  }



  std::string
  without_label(const std::string &name)
  {
    const std::size_t begin = name.rfind(" [");
    return begin != std::string::npos && name.back() == ']' ?
             name.substr(0, begin) :
             name;
  }
} // namespace Viscoplastic
