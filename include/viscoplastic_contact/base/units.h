// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Exponents of length, time, stress and temperature, of which the units of
  /// everything in a scene are products: a force is a stress times length^2.
  struct Dimension
  {
    double length = 0., time = 0., stress = 0., temperature = 0.;

    /// Up to the rounding of exponents that are no whole numbers.
    bool
    operator==(const Dimension &other) const;

    Dimension
    operator*(const Dimension &other) const;

    Dimension
    power(const double exponent) const
    {
      return {exponent * length,
              exponent * time,
              exponent * stress,
              exponent * temperature};
    }
  };

  /// The dimension in words: "a stress", "a velocity", "length^2 / time".
  std::string
  in_words(const Dimension &dimension);



  /// A unit with a name, such as MPa, or a product of some, such as kN/m^3.
  struct Unit
  {
    std::string name;
    Dimension   dimension;
    /// The size of the unit in SI units.
    double si = 1.;
  };

  /// The names of all units that read_unit() knows, or of those of one
  /// dimension.
  std::vector<std::string>
  names_of_units(const std::optional<Dimension> &dimension = {});



  /// The result of read_unit().
  struct UnitInText
  {
    Unit unit;
    /// Position in the text behind the unit.
    std::size_t end;
    /// A name in it that is no unit; the others mean nothing then.
    std::string unknown_name;
  };

  /// The unit that follows a number ending at @p begin of @p text: after a
  /// blank, as in `25 MPa', `0.022 MPa/m', `1e-5 MPa^-5/day', `3 Pa s', or
  /// after a slash, as in `5/day'. What may be a part of a larger expression is
  /// left to it: `25 MPa*x' and `25 MPa/2' go on behind `MPa'. Nothing where a
  /// number has no unit.
  std::optional<UnitInText>
  read_unit(const std::string &text, const std::size_t begin);



  /// The physical quantities of numbers in results, from which their units
  /// follow.
  enum class Quantity
  {
    pure_number,
    length,
    area,   // 2D: length
    volume, // 2D: area
    time,
    rate,
    velocity,
    stress,
    force,         // 2D: by length
    axial_force,   // of a whole section
    energy,        // 2D: by length
    work_per_area, // energy by area
    energy_norm,   // energy^1/2
    rate_norm,     // (energy/time)^1/2
    stress_norm,   // stress volume^1/2
    temperature,   // always K
    wall_time      // s whatever the units of the scene
  };



  /// The units of a scene: those of numbers without unit in its parameter file
  /// and of all results. There may be none; then nothing is known but that they
  /// are consistent.
  class Units
  {
  public:
    /// No units: numbers are taken to be consistent.
    Units() = default;

    /// The units with these names or products, of which the fourth may be given
    /// in the place of the third. All empty: none. Throws ExcMessage with a
    /// sentence about the entries `Length', `Time', `Stress' and `Force' of the
    /// subsection `Units'.
    Units(const std::string &length,
          const std::string &time,
          const std::string &stress,
          const std::string &force = "");

    bool
    are_declared() const
    {
      return length.si > 0.;
    }

    /// The size in SI units of the scene's unit of this @p dimension.
    double
    si(const Dimension &dimension) const
    {
      return std::pow(length.si, dimension.length) *
             std::pow(time.si, dimension.time) *
             std::pow(stress.si, dimension.stress);
    }

    /// The name for @p quantity of a scene in @p dim dimensions, such as "MN/m"
    /// of a force in plane strain; empty without units.
    std::string
    name(const Quantity quantity, const unsigned int dim = 3) const;

    /// " [MPa]", behind the name of a column or field; empty without units and
    /// for pure numbers.
    std::string
    label(const Quantity quantity, const unsigned int dim) const
    {
      const std::string unit = name(quantity, dim);
      return unit.empty() ? "" : " [" + unit + ']';
    }

    /// " MPa", behind a number; likewise.
    std::string
    suffix(const Quantity quantity, const unsigned int dim = 3) const
    {
      const std::string unit = name(quantity, dim);
      return unit.empty() ? "" : ' ' + unit;
    }

    /// Whether results in two dimensions are those of whole bodies, as of
    /// bodies of revolution, not by length.
    bool are_of_whole_bodies = false;

    Unit length{"", {1., 0., 0.}, 0.}, time{"", {0., 1., 0.}, 0.},
      stress{"", {0., 0., 1.}, 0.};
  };

  /// The name of a column or field without the label of its unit.
  std::string
  without_label(const std::string &name);
} // namespace Viscoplastic
