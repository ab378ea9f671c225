// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Exponents of length, time, stress and temperature, of whose powers all
  /// units in a scene are products. For example, a force is a stress times
  /// length^2.
  struct Dimension
  {
    double length = 0., time = 0., stress = 0., temperature = 0.;

    /// Compare up to rounding of fractional exponents.
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

  /// Return words: "a stress", "a velocity", "length^2 time^-1".
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

  /// Return all names that read_unit() knows, or those of one dimension.
  std::vector<std::string>
  names_of_units(const std::optional<Dimension> &dimension = {});



  /// The result of read_unit().
  struct UnitInText
  {
    Unit unit;
    /// The position in the text after the unit.
    std::size_t end;
    /// A name that is no unit, if any; the other members are meaningless then.
    std::string unknown_name;
  };

  /// Read the unit that follows a number ending at position @p begin of @p
  /// text: after a blank, as in `25 MPa', `3 Pa s', `0.022 MPa/m', `1e-5
  /// MPa^-5/day', or after a slash, as in `5/day'. Reading stops before what
  /// may be a part of a larger expression: after `MPa' in `25 MPa*x' and `25
  /// MPa/2'. Returns nothing if there is no unit.
  std::optional<UnitInText>
  read_unit(const std::string &text, const std::size_t begin);



  /// Physical quantities of numbers in results, which determine their units.
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
    axial_force,   // of a whole cross section
    energy,        // 2D: by length
    work_per_area, // energy by area
    energy_norm,   // energy^1/2
    rate_norm,     // (energy/time)^1/2
    stress_norm,   // stress volume^1/2
    temperature,   // always K
    wall_time      // always s
  };



  /// The units of a scene: those of all results and of numbers without unit in
  /// its parameter file. Without declared units, numbers are only assumed to be
  /// consistent.
  class Units
  {
  public:
    /// Declare no units.
    Units() = default;

    /// Declare units by their names or by products of names, with either @p
    /// stress or @p force; if all are empty, none are declared. Throws
    /// ExcMessage with a sentence about the entries `Length', `Time', `Stress'
    /// and `Force' of the subsection `Units'.
    Units(const std::string &length,
          const std::string &time,
          const std::string &stress,
          const std::string &force = "");

    bool
    are_declared() const
    {
      return length.si > 0.;
    }

    /// Return the scene's unit of this @p dimension in SI units.
    double
    si(const Dimension &dimension) const
    {
      return std::pow(length.si, dimension.length) *
             std::pow(time.si, dimension.time) *
             std::pow(stress.si, dimension.stress);
    }

    /// Return the unit of @p quantity in a scene of @p dim dimensions, such as
    /// "MN/m" for a force in plane strain; empty without units.
    std::string
    name(const Quantity quantity, const unsigned int dim = 3) const;

    /// Return " [MPa]" to follow the name of a column or field; empty without
    /// units and for pure numbers.
    std::string
    label(const Quantity quantity, const unsigned int dim) const
    {
      const std::string unit = name(quantity, dim);
      return unit.empty() ? "" : " [" + unit + ']';
    }

    /// Return " MPa" to follow a number; empty in the same cases.
    std::string
    suffix(const Quantity quantity, const unsigned int dim = 3) const
    {
      const std::string unit = name(quantity, dim);
      return unit.empty() ? "" : ' ' + unit;
    }

    /// Whether results in two dimensions are those of whole bodies (as for
    /// bodies of revolution), not per unit length.
    bool are_of_whole_bodies = false;

    Unit length{"", {1., 0., 0.}, 0.}, time{"", {0., 1., 0.}, 0.},
      stress{"", {0., 0., 1.}, 0.};
  };

  /// Return the name of a column or field without the label of its unit.
  std::string
  without_label(const std::string &name);
} // namespace Viscoplastic
