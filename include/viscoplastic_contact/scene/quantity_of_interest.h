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
      contact_force, // of unilateral contact
      friction_dissipation,
      reaction,
      displacement, // of a point of `Output/Points'
      axial_strain,
      axial_force
    };

    /// The value of number for the sum over all boundaries.
    static constexpr unsigned int all = numbers::invalid_unsigned_int;

    Kind kind;
    /// The boundary id of a force or number of a point; 0, 1, 2 for x, y, z.
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

    /// Whether this is the force of a prescribed displacement or strain.
    bool
    is_reaction() const
    {
      return kind == Kind::reaction || kind == Kind::axial_force;
    }
  };

  /// Return the quantity with this @p column. Throws ExcMessage, naming places
  /// by @p names, unless it exists for these conditions, this number of points
  /// and the quantity @p of_section, if any, of generalized plane strain.
  template <int dim>
  QuantityOfInterest
  quantity_of_interest(
    const std::string                                          &column,
    const std::map<types::boundary_id, BoundaryCondition<dim>> &boundary,
    const unsigned int                                          n_points,
    const std::optional<QuantityOfInterest::Kind>               of_section,
    const PlaceNames                                           &names);
} // namespace Viscoplastic
