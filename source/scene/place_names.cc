// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/files/read_mesh_file.h>
#include <viscoplastic_contact/scene/place_names.h>

#include <cctype>
#include <regex>

namespace Viscoplastic
{
  namespace
  {
    constexpr std::size_t longest_name = 40;



    /// Throw unless the name fits lists and sentences and is no number.
    void
    check_name(const std::string &name, const std::string &entry)
    {
      const auto require = [&](const bool condition, const std::string &why) {
        if (!condition)
          refuse("'" + entry + "': the name '" + excerpt(name) + "' " + why);
      };
      require(name.size() <= longest_name,
              "is too long; at most " + std::to_string(longest_name) +
                " characters are shown.");
      require(std::isdigit(static_cast<unsigned char>(name[0])) == 0 &&
                name.find_first_of(";:,=/#'\"\\{}") == std::string::npos,
              "begins with a digit or has one of the characters ; : , = / # "
              "' \" \\ { }; take letters, digits, blanks, - and _.");
      static const std::regex number("(boundary|material|point|line) *\\d*");
      require(!std::regex_match(name, number),
              "is what a place without a name is called; take another one.");
    }
  } // namespace



  std::pair<std::string, std::string>
  split_name(const std::string &text)
  {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      return {"", Utilities::trim(text)};
    return {Utilities::trim(text.substr(0, equals)),
            Utilities::trim(text.substr(equals + 1))};
  }



  PlaceNames::PlaceNames(const Parameters &parameters)
  {
    const auto add_given = [this](const PlaceNumber &place,
                                  const std::string &name,
                                  const std::string &entry) {
      if (name.empty())
        return;
      check_name(name, entry);
      for (const auto &[other, taken] : names)
        if (taken == name)
          refuse("'" + entry + "' is '" + excerpt(name) + "', which " +
                 other.text() + " is called already; take another name.");
      names[place] = name;
    };
    for (const auto &[id, boundary] : parameters.boundaries)
      add_given({"boundary", id},
                boundary.name,
                "Boundary " + std::to_string(id) + "/Name");
    for (const auto &[id, material] : parameters.materials)
      add_given({"material", id},
                material.name,
                "Material " + std::to_string(id) + "/Name");
    const auto add_list = [&](const std::string &kind,
                              const std::string &list,
                              const std::string &entry) {
      unsigned int number = 0;
      for (const std::string &text : Utilities::split_string_list(list, ';'))
        if (!text.empty())
          add_given({kind, number++}, split_name(text).first, entry);
    };
    add_list("point", parameters.output.points, "Output/Points");
    add_list("line", parameters.output.lines, "Output/Lines");

    // Add physical groups with admissible names. Of a material and a boundary
    // with the same name, one has it; names of other places are refused.
    const std::map<PlaceNumber, std::string> given    = names;
    const GeometryParameters                &geometry = parameters.geometry;
    if (geometry.file.empty())
      return;
    for (const auto &[group, name] : physical_names(geometry.file))
      {
        const bool is_body = group.first == parameters.dimension;
        if ((!is_body && group.first + 1 != parameters.dimension) ||
            !(is_body ? geometry.material_ids : geometry.boundary_ids).empty())
          continue;
        const PlaceNumber place{is_body ? "material" : "boundary",
                                group.second};
        if (names.count(place) == 1)
          continue;
        for (const auto &[other, taken] : given)
          if (taken == name)
            refuse("The scene calls " + other.text() + " '" + excerpt(name) +
                   "', as '" + geometry.file + "' calls " + place.text() +
                   "; take another name.");
        if (!find(name))
          try
            {
              check_name(name, geometry.file);
              names[place] = name;
            }
          catch (const ExceptionBase &)
            {} // the place goes by its number
      }
  }



  std::optional<PlaceNumber>
  PlaceNames::find(const std::string &name) const
  {
    for (const auto &[place, taken] : names)
      if (taken == name)
        return place;
    std::smatch             match;
    static const std::regex number(
      "(boundary|material|point|line) +(\\d{1,9})");
    if (std::regex_match(name, match, number))
      return PlaceNumber{match[1],
                         static_cast<unsigned int>(std::stoul(match[2]))};
    return {};
  }



  std::string
  PlaceNames::column(const std::string &quantity) const
  {
    std::smatch             match;
    static const std::regex of_place(
      "(reaction|friction_force|contact_force|displacement)_([xyz]) +of +(.+)");
    if (!std::regex_match(quantity, match, of_place))
      return quantity;
    const std::string what = match[1], component = match[2], name = match[3];
    const auto        place = find(name);
    const std::string kind  = what == "displacement" ? "point" : "boundary";
    if (!place || place->kind != kind)
      {
        std::vector<std::string> known;
        for (const auto &[other, taken] : names)
          if (other.kind == kind)
            known.push_back(taken);
        refuse("'Error control/Quantity' = '" + excerpt(quantity) +
               "': there is no " + kind + " '" + excerpt(name) + "'" +
               did_you_mean(name, known));
      }
    return (kind == "boundary" ? what + '_' : kind) +
           std::to_string(place->number) + '_' + component;
  }



  std::string
  PlaceNames::quantity(const std::string &column) const
  {
    std::smatch             match;
    static const std::regex of_place(
      "(reaction_|friction_force_|contact_force_|point)(\\d+)_([xyz])");
    if (!std::regex_match(column, match, of_place))
      return column;
    const bool        is_point = match[1] == "point";
    const std::string kind     = is_point ? "point" : "boundary";
    const auto        number = static_cast<unsigned int>(std::stoul(match[2]));
    return has(kind, number) ? (is_point ? "displacement_" : match[1].str()) +
                                 match[3].str() + " of " + of(kind, number) :
                               column;
  }



  std::string
  PlaceNames::words(const std::string &column) const
  {
    static const std::regex reaction("reaction_(\\d+)"), point("point(\\d+)"),
      field("point(\\d+)_(.*)"), other_reaction("reaction_(.*)"),
      foundation("(friction|contact)_force_(\\d+)");
    std::smatch match;
    const auto  place = [&](const std::string &kind) {
      return of(kind, static_cast<unsigned int>(std::stoul(match[1])));
    };
    if (std::regex_match(column, match, reaction))
      return "reaction of " + place("boundary");
    if (std::regex_match(column, match, foundation))
      return match[1].str() + " force on " +
             of("boundary", static_cast<unsigned int>(std::stoul(match[2])));
    if (std::regex_match(column, match, point))
      return "displacement of " + place("point");
    std::string text = column;
    // A field at a point.
    if (std::regex_match(column, match, field))
      text = match[2].str() + " at " + place("point");
    else if (std::regex_match(column, match, other_reaction))
      text = "reaction at " + match[1].str();
    else if (column == "slip_area")
      return "slipping area";
    else if (column.compare(0, 4, "max_") == 0)
      text = "largest " + column.substr(4);
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
  }
} // namespace Viscoplastic
