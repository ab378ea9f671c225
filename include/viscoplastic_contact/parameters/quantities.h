// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/parameters/parameter_text.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The dimensions that the numbers in an entry may have.
  struct EntryUnit
  {
    /// The dimension of the value of the entry; nothing if it is not known.
    std::optional<Dimension> dimension;
    /// Whether the entry is a wall time in seconds, whatever the units of the
    /// scene.
    bool is_wall_time = false;
    /// The exponent of a power law on which the dimension depends, and the name
    /// of its entry.
    std::optional<double> exponent          = {};
    std::string           entry_of_exponent = "Exponent";
  };

  /// Replace each number with a unit in a text by that number in the units of
  /// the scene: `25 MPa*(1 - x/(2 km))' becomes `25*(1 - x/(2000))' with MPa
  /// and m. Throws ExcMessage with a part of a sentence if a unit does not
  /// exist or does not fit the entry, or if the scene has no @p units.
  std::string
  without_units(const std::string &text,
                const EntryUnit   &entry,
                const Units       &units);

  /// Whether numbers in an entry have a unit, by its @p documentation.
  bool
  has_unit(const std::string &documentation);

  /// Return the units that the subsection `Units' in @p lines declares. Throws
  /// ExcMessage if they are wrong.
  Units
  declared_units(const std::vector<ParameterLine> &lines);

  /// Apply without_units() to the values of @p lines, which set entries of @p
  /// handler. Returns the original values that had units, by path. Throws
  /// ExcMessage with file and line.
  std::map<std::string, std::string>
  remove_units(std::vector<ParameterLine>     &lines,
               const Units                    &units,
               const dealii::ParameterHandler &handler);
} // namespace Viscoplastic
