// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/parameter_file.h>

#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

namespace Viscoplastic
{
  /// Kind and number of a place of a scene: `boundary' 3, `material' 1, `point'
  /// 0 or `line' 0.
  struct PlaceNumber
  {
    std::string  kind;
    unsigned int number = 0;

    /// `boundary 3'.
    std::string
    text() const
    {
      return kind + ' ' + std::to_string(number);
    }

    bool
    operator<(const PlaceNumber &other) const
    {
      return std::tie(kind, number) < std::tie(other.kind, other.number);
    }
  };


  /// The names of the places of a scene, as used in the output and the record
  /// of a run and in entries that refer to a place. They are given by `Boundary
  /// <id>/Name', `Material <id>/Name', `Output/Points' and `Output/Lines', and
  /// by the physical groups of a Gmsh mesh file.
  class PlaceNames
  {
  public:
    PlaceNames() = default;

    /// Take the names from the entries of a scene. Throws ExcMessage for an
    /// inadmissible name or one that two places have.
    explicit PlaceNames(const Parameters &parameters);

    bool
    has(const std::string &kind, const unsigned int number) const
    {
      return names.count({kind, number}) == 1;
    }

    /// Return the name of a place, or `boundary 3' if it has none.
    std::string
    of(const std::string &kind, const unsigned int number) const
    {
      const PlaceNumber place{kind, number};
      const auto        found = names.find(place);
      return found == names.end() ? place.text() : found->second;
    }

    /// Return the place with this @p name, or nothing; `boundary 3' is a name,
    /// too.
    std::optional<PlaceNumber>
    find(const std::string &name) const;

    /// The column of statistics.csv for `reaction_y of roof' or `displacement_y
    /// of crown', or @p quantity itself. Throws ExcMessage for unknown names.
    std::string
    column(const std::string &quantity) const;

    /// The inverse of column(): returns `reaction_y of roof' for
    /// `reaction_3_y', and the column itself if the place has no name.
    std::string
    quantity(const std::string &column) const;

    /// Return a column of statistics.csv, with or without its component, in
    /// words: `reaction of roof' for `reaction_3'.
    std::string
    words(const std::string &column) const;

    std::map<PlaceNumber, std::string> names;
  };


  /// Split an element of a list of places, `crown = 0, 2.5', into name and
  /// place; the name is empty if there is none.
  std::pair<std::string, std::string>
  split_name(const std::string &text);
} // namespace Viscoplastic
