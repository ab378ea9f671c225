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
  /// A place of a scene without its name: `boundary' 3, `material' 1, `point' 0
  /// or `line' 0.
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


  /// What a scene calls its places, for people: in what a run prints, in the
  /// record of the run and in entries that name a place. The names are those of
  /// `Boundary <id>/Name', `Material <id>/Name', `Output/Points' and
  /// `Output/Lines', and of the physical groups of a mesh file of Gmsh.
  class PlaceNames
  {
  public:
    PlaceNames() = default;

    /// Take the names from the entries of a scene. Throws ExcMessage for one
    /// that is no name or that two places have; find() and column() for one
    /// that no place has.
    explicit PlaceNames(const Parameters &parameters);

    bool
    has(const std::string &kind, const unsigned int number) const
    {
      return names.count({kind, number}) == 1;
    }

    /// The name of a place, or `boundary 3' if it has none.
    std::string
    of(const std::string &kind, const unsigned int number) const
    {
      const PlaceNumber place{kind, number};
      const auto        found = names.find(place);
      return found == names.end() ? place.text() : found->second;
    }

    /// The place that @p name names, or nothing. Numbers are names, too:
    /// `boundary 3'.
    std::optional<PlaceNumber>
    find(const std::string &name) const;

    /// The column of statistics.csv that @p quantity means: it itself, or, of
    /// `reaction_y of roof' and `displacement_y of crown', that of the place.
    std::string
    column(const std::string &quantity) const;

    /// The reverse of column(): `reaction_y of roof' of `reaction_3_y'; the
    /// column itself where the place has no name.
    std::string
    quantity(const std::string &column) const;

    /// A column of statistics.csv, or the part of it before its component, for
    /// people: `reaction of roof' of `reaction_3'.
    std::string
    words(const std::string &column) const;

    std::map<PlaceNumber, std::string> names;

  private:
    void
    add(const PlaceNumber &place, const std::string &name);
  };


  /// An element of a list of places, `crown = 0, 2.5', as name and place; the
  /// name is empty if there is none.
  std::pair<std::string, std::string>
  split_name(const std::string &text);
} // namespace Viscoplastic
