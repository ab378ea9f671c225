// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/scene/quantity_of_interest.h>

namespace Viscoplastic
{
  template <int dim>
  QuantityOfInterest
  quantity_of_interest(
    const std::string                                          &column,
    const std::map<types::boundary_id, BoundaryCondition<dim>> &boundary,
    const unsigned int                                          n_points,
    const std::optional<QuantityOfInterest::Kind>               of_section,
    const PlaceNames                                           &names)
  {
    using Kind = QuantityOfInterest::Kind;
    std::vector<QuantityOfInterest> known;
    const auto                      add =
      [&known](const Kind kind, const unsigned int i, const std::string &name) {
        for (unsigned int d = 0; d < dim; ++d)
          known.push_back({kind, i, d, name + '_' + "xyz"[d]});
      };
    bool         has_friction = false, opens = false;
    unsigned int n_contacts = 0;
    for (const auto &[id, condition] : boundary)
      {
        has_friction |= condition.has_friction();
        opens |= condition.is_unilateral();
        n_contacts += condition.has_contact_points();
      }
    constexpr unsigned int all = QuantityOfInterest::all;
    if (has_friction)
      {
        add(Kind::friction_force, all, "friction_force");
        known.push_back(
          {Kind::friction_dissipation, 0, 0, "friction_dissipation"});
      }
    if (opens)
      add(Kind::contact_force, all, "contact_force");
    for (const auto &[id, condition] : boundary)
      {
        // On a single contact boundary, its force and the sum are the same.
        const std::string suffix = '_' + std::to_string(id) + '_';
        if (const auto at = column.find(suffix);
            n_contacts == 1 && condition.has_contact_points() &&
            at != std::string::npos && column.find("_force") < at)
          return quantity_of_interest(std::string(column).replace(at,
                                                                  suffix.size(),
                                                                  "_"),
                                      boundary,
                                      n_points,
                                      of_section,
                                      names);
        if (n_contacts > 1 && condition.has_friction())
          add(Kind::friction_force, id, "friction_force_" + std::to_string(id));
        if (n_contacts > 1 && condition.is_unilateral())
          add(Kind::contact_force, id, "contact_force_" + std::to_string(id));
      }
    for (const auto &[id, condition] : boundary)
      // The dual problem has reactions of constraints, but not of springs.
      if (condition.constrains() && !condition.has_springs())
        add(Kind::reaction, id, "reaction_" + std::to_string(id));
    for (unsigned int i = 0; i < n_points; ++i)
      add(Kind::displacement, i, "point" + std::to_string(i));

    if (of_section)
      known.push_back(
        {*of_section,
         0,
         0,
         *of_section == Kind::axial_force ? "axial_force" : "axial_strain"});

    std::string text;
    for (const QuantityOfInterest &quantity : known)
      {
        if (quantity.name == column)
          return quantity;
        text += (text.empty() ? "" : ", ") + names.quantity(quantity.name);
      }
    refuse("'Error control/Quantity': '" + excerpt(names.quantity(column)) +
           "' is none of the quantities of this scene whose error can be "
           "estimated: " +
           (text.empty() ? "there are none; give 'Output/Points'" : text) +
           ".");
    return {};
  }



  VISCOPLASTIC_INSTANTIATE(quantity_of_interest);
} // namespace Viscoplastic
