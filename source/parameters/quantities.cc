// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/parameters/dimension_check.h>
#include <viscoplastic_contact/parameters/parameter_tree.h>
#include <viscoplastic_contact/parameters/quantities.h>

#include <boost/property_tree/ptree.hpp>

#include <cmath>
#include <cstdlib>
#include <limits>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    using Tree = boost::property_tree::ptree;

    const std::string power_law  = "1/(stress^n time)",
                      compliance = "stress/length^m";

    /// The dimensions of entries, by the words in their descriptions.
    const std::map<std::string, Dimension> dimension_of_words{
      {"1", {0., 0., 0.}},
      {"length", {1., 0., 0.}},
      {"time", {0., 1., 0.}},
      {"1/time", {0., -1., 0.}},
      {"stress", {0., 0., 1.}},
      {"force", {2., 0., 1.}},
      {"1/stress", {0., 0., -1.}},
      {"stress times time", {0., 1., 1.}},
      {"force per volume", {-1., 0., 1.}},
      {"stress/length", {-1., 0., 1.}},
      {"temperature", {0., 0., 0., 1.}},
      {"1/temperature", {0., 0., 0., -1.}},
      {"energy/mol", {3., 0., 1.}},
      {"energy/(mol temperature)", {3., 0., 1., -1.}}};



    /// Return a number with as few digits as determine it up to rounding.
    std::string
    shortest(const double number)
    {
      const std::string text = as_text(number, 15);
      return std::abs(std::strtod(text.c_str(), nullptr) - number) >
                 std::numeric_limits<double>::epsilon() * std::abs(number) ?
               as_text(number, 17) :
               text;
    }



    struct NumberWithUnit
    {
      std::size_t begin, end_of_number;
      UnitInText  found;
      /// Whether the blank between number and unit is missing, as in `25MPa'.
      bool lacks_blank;
    };



    std::vector<NumberWithUnit>
    numbers_with_units(const std::string &text)
    {
      std::vector<NumberWithUnit> result;
      std::size_t                 i = 0;
      while (i < text.size())
        {
          const std::size_t begin = i;
          i                       = end_of_number(text, begin);
          if (i == begin)
            {
              // Skip names, since digits in them begin no number.
              i += std::max<std::size_t>(1, identifier_at(text, i).size());
              continue;
            }
          if (!identifier_at(text, i).empty())
            {
              const auto found =
                read_unit(text.substr(0, i) + ' ' + text.substr(i), i);
              if (found && found->unknown_name.empty())
                result.push_back({begin, i, *found, true});
            }
          else if (const auto found = read_unit(text, i))
            {
              result.push_back({begin, i, *found, false});
              i = std::max(i, found->end);
            }
        }
      return result;
    }



    /// Return the last value of an entry; its default if no line sets it.
    std::string
    last_value(const std::vector<ParameterLine> &lines,
               const std::string                &path,
               const std::string                &default_value)
    {
      const ParameterLine *const line = last_line(lines, path);
      return line == nullptr ? default_value : line->value;
    }



    /// Return the value of the exponent in the section of a line.
    std::optional<double>
    exponent_beside(const ParameterLine              &line,
                    const std::vector<ParameterLine> &lines,
                    const Tree                       &declared)
    {
      for (const std::string name : {"Exponent", "Compliance exponent"})
        {
          const std::string path = line.section + name;
          const auto        entry =
            declared.get_child_optional(Tree::path_type(path, '/'));
          if (entry && is_entry(*entry))
            return number_of(last_value(
              lines, path, entry->get<std::string>("default_value")));
        }
      return {};
    }



    /// Return the unit of an entry from the words after `Unit: ' in its
    /// description; for unknown words the dimension is unknown. @p exponent is
    /// n or m in power_law and compliance. Returns nothing for a description
    /// without `Unit: ': the entry is no number.
    std::optional<EntryUnit>
    unit_of_entry(const std::string           &description,
                  const std::optional<double> &exponent)
    {
      const std::string introduction = "Unit: ";
      const std::size_t begin        = description.rfind(introduction);
      if (begin == std::string::npos)
        return {};
      std::string words = description.substr(begin + introduction.size());
      words             = words.substr(0, words.find('.'));
      if (words == "seconds")
        return EntryUnit{Dimension{0., 1., 0.}, true};
      if (words == power_law && exponent)
        return EntryUnit{Dimension{0., -1., -*exponent}, false, exponent};
      if (words == compliance && exponent)
        return EntryUnit{Dimension{-*exponent, 0., 1.},
                         false,
                         exponent,
                         "Compliance exponent"};
      const auto known = dimension_of_words.find(words);
      return known == dimension_of_words.end() ? EntryUnit() :
                                                 EntryUnit{known->second};
    }
  } // namespace



  bool
  has_unit(const std::string &documentation)
  {
    const auto unit = unit_of_entry(documentation, {});
    return unit && !(unit->dimension && *unit->dimension == Dimension());
  }



  std::string
  without_units(const std::string &text,
                const EntryUnit   &entry,
                const Units       &units)
  {
    for (const std::string name : {"\u00B0C", "degC"})
      if (text.find(name) != std::string::npos)
        refuse("'" + name +
               "' is no unit here: temperatures are absolute, 20 \u00B0C is "
               "`293.15 K', and differences are in K");
    std::string result;
    std::size_t copied = 0;
    for (const NumberWithUnit &number : numbers_with_units(text))
      {
        const auto &[unit, end, unknown_name] = number.found;
        const std::string digits =
          text.substr(number.begin, number.end_of_number - number.begin);
        if (number.lacks_blank)
          refuse("a blank must stand between '" + excerpt(digits) +
                 "' and its unit");
        if (!unknown_name.empty())
          refuse(
            "there is no unit '" + excerpt(unknown_name) + "'" +
            did_you_mean(unknown_name,
                         names_of_units(entry.is_wall_time ? entry.dimension :
                                                             std::nullopt),
                         "; units are " + enumeration(names_of_units(), 40)));
        if (!entry.is_wall_time && !units.are_declared())
          refuse("'" + excerpt(text.substr(number.begin, end - number.begin)) +
                 "' has a unit, but the scene says none: declare `Length', "
                 "`Time' and `Stress' in `subsection Units'");
        const double factor =
          unit.si / (entry.is_wall_time ? 1. : units.si(unit.dimension));
        // std::stod() is not used, since it throws for tiny numbers.
        const double value = factor * std::strtod(digits.c_str(), nullptr);
        if (!std::isfinite(value))
          refuse("'" + excerpt(digits) +
                 "' leaves the range of floating-point numbers");
        result += text.substr(copied, number.begin - copied) +
                  (std::abs(factor - 1.) < 1e-14 ? digits : shortest(value));
        copied = end;
      }
    if (copied == 0)
      return text;
    std::string wrong = wrong_dimension(text, entry.dimension);
    if (!wrong.empty() && entry.exponent)
      wrong += " with '" + entry.entry_of_exponent +
               "' = " + shortest(*entry.exponent);
    if (!wrong.empty())
      refuse(wrong);
    return result + text.substr(copied);
  }



  Units
  declared_units(const std::vector<ParameterLine> &lines)
  {
    const auto value = [&lines](const std::string &name) {
      return last_value(lines, "Units/" + name, "");
    };
    return {value("Length"), value("Time"), value("Stress"), value("Force")};
  }



  std::map<std::string, std::string>
  remove_units(std::vector<ParameterLine> &lines,
               const Units                &units,
               const ParameterHandler     &handler)
  {
    std::map<std::string, std::string> as_written;
    std::optional<Tree> declared; // made only if needed, since it is slow
    for (ParameterLine &line : lines)
      {
        if (!line.sets_entry())
          continue;
        const std::string path = line.path();
        as_written.erase(path);
        try
          {
            const auto numbers = numbers_with_units(line.value);
            if (numbers.empty())
              continue;
            if (!declared)
              declared = declared_entries(handler);
            const auto entry =
              declared->get_child_optional(Tree::path_type(path, '/'));
            if (!entry || !is_entry(*entry)) // refused elsewhere
              continue;
            auto unit = unit_of_entry(entry->get<std::string>("documentation"),
                                      exponent_beside(line, lines, *declared));
            if (!unit)
              continue;
            // The exponent need not belong to a value that is overridden later.
            if (unit->exponent && last_line(lines, path) != &line)
              unit = EntryUnit();
            if (path == "Time/Phases")
              for (const auto &number : numbers)
                {
                  const std::size_t separator =
                    line.value.find_last_of(":,", number.begin);
                  if (separator != std::string::npos &&
                      line.value[separator] != ',')
                    refuse("the number of steps has no unit");
                }
            const std::string value = without_units(line.value, *unit, units);
            as_written[path]        = line.value;
            line.value              = value;
            line.text               = "set " + line.name + " = " + value;
          }
        catch (const std::exception &exception)
          {
            const std::string why = reason(exception);
            refuse(line.origin() + ": '" + excerpt(path) + "' is '" +
                   excerpt(line.value) + "'; " + why +
                   (why.back() == '?' || why.back() == '.' ? "" : "."));
          }
      }
    return as_written;
  }
} // namespace Viscoplastic
