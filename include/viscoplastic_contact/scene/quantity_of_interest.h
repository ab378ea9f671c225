// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/scene/boundary_condition.h>
#include <viscoplastic_contact/scene/place_names.h>

#include <map>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// A number whose error is estimated by duality: a column of statistics.csv
  /// that is linear in the displacement and the forces at the end of a step, or
  /// the work of friction, which adds up over the steps.
  struct QuantityOfInterest
  {
    enum class Kind
    {
      friction_force,
      contact_force, // of contact that opens
      friction_dissipation,
      reaction,
      displacement, // of a point of `Output/Points'
      axial_strain,
      axial_force
    };

    /// The id that stands for all boundaries together.
    static constexpr unsigned int all = numbers::invalid_unsigned_int;

    Kind kind;
    /// The boundary id of a force, the number of a point; and x, y or z.
    unsigned int number = 0, component = 0;
    /// The column of statistics.csv.
    std::string name;

    bool
    is_sum() const
    {
      return kind == Kind::friction_dissipation;
    }

    Quantity
    unit() const
    {
      return is_sum()                   ? Quantity::energy :
             kind == Kind::displacement ? Quantity::length :
             kind == Kind::axial_strain ? Quantity::pure_number :
             kind == Kind::axial_force  ? Quantity::axial_force :
                                          Quantity::force;
    }

    bool
    is_force() const
    {
      return kind == Kind::friction_force || kind == Kind::contact_force ||
             is_reaction();
    }

    bool
    is_of(const types::boundary_id id) const
    {
      return number == all || number == id;
    }

    /// Whether it is a force of what is prescribed.
    bool
    is_reaction() const
    {
      return kind == Kind::reaction || kind == Kind::axial_force;
    }
  };

  /// The quantity that @p column names. Throws ExcMessage if there is none in
  /// a scene with these conditions and so many output points, in which @p
  /// of_section, if any, is a quantity; it calls places by their @p names.
  template <int dim>
  QuantityOfInterest
  quantity_of_interest(
    const std::string                                          &column,
    const std::map<types::boundary_id, BoundaryCondition<dim>> &boundary,
    const unsigned int                                          n_points,
    const std::optional<QuantityOfInterest::Kind>               of_section,
    const PlaceNames                                           &names);
} // namespace Viscoplastic
