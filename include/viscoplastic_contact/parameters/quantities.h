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
    /// The dimension that the value of the entry must have; nothing if it is
    /// not known.
    std::optional<Dimension> dimension;
    /// Seconds of the clock on the wall, whatever the units of the scene.
    bool is_wall_time = false;
    /// The exponent of a power law that the dimension follows from, and its
    /// entry.
    std::optional<double> exponent          = {};
    std::string           entry_of_exponent = "Exponent";
  };

  /// The unit of an entry as its description says it, behind `Unit: ':
  /// "length", "time", "stress", "1" for pure numbers and a few others, see
  /// source/parameters/quantities.cc; of others the dimension is not known.
  /// @p exponent is that of the power of an entry in "1/(stress^n time)" or
  /// "stress/length^m".
  /// Nothing for descriptions without those words: the text is no number.
  std::optional<EntryUnit>
  unit_of_entry(const std::string           &description,
                const std::optional<double> &exponent = {});

  /// The text with each number that has a unit replaced by that number in the
  /// units of the scene: `25 MPa*(1 - x/(2 km))' becomes `25*(1 - x/(2000))'
  /// with MPa and m. Throws ExcMessage with a part of a sentence: for a unit
  /// that does not exist or does not fit the entry, or where the scene has no
  /// @p units.
  std::string
  without_units(const std::string &text,
                const EntryUnit   &entry,
                const Units       &units);

  /// The units that the subsection `Units' of @p lines declares. Throws
  /// ExcMessage.
  Units
  declared_units(const std::vector<ParameterLine> &lines);

  /// Replace the values of @p lines, which set entries of @p handler, by those
  /// without_units(). Returns the values as they were in the file, by path,
  /// where they had units. Throws ExcMessage with file and line.
  std::map<std::string, std::string>
  remove_units(std::vector<ParameterLine>     &lines,
               const Units                    &units,
               const dealii::ParameterHandler &handler);
} // namespace Viscoplastic
