// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/instantiate_member.h>
#include <viscoplastic_contact/scene/scene.h>

#include <algorithm>
#include <cmath>
#include <sstream>

// What a scene has, in words for the user.

namespace Viscoplastic
{
  template <int dim>
  std::vector<std::string>
  Scene<dim>::effects() const
  {
    std::vector<std::string> result{
      is_axisymmetric() ? "elasticity (axisymmetric)" :
      is_generalized()  ? "elasticity (generalized plane strain)" :
      dim == 2          ? "elasticity (plane strain)" :
                          "elasticity (3D)"};
    const std::string history  = name_of(parameters.stress.stress_history),
                      pressure = "the computed pressure";
    for (const auto &material : materials)
      {
        const std::string of =
          materials.size() > 1 ? " of " + material->name : "";
        if (material->is_anisotropic())
          result.push_back("anisotropic elasticity" + of);
        if (!material->law)
          continue;
        const std::string announcement = material->law->announcement();
        result.push_back(
          "viscoplastic flow" + of + " (" + material->law_name +
          (material->needs_absolute_temperature() ? ", by temperature" : "") +
          ", history at " + history +
          (announcement.empty() ? "" : "; " + announcement) + ")");
      }
    if (temperature)
      result.emplace_back(has_thermal_strain() ?
                            "thermal expansion" :
                            "temperature, without thermal expansion");
    if (has_viscosity())
      result.push_back("time integration by " +
                       name_of(parameters.time.scheme));
    const auto boundaries = [&](const auto &condition) {
      std::string pieces, ids;
      for (const auto &[id, data] : boundary)
        if (condition(data))
          {
            const bool   has_name = names.has("boundary", id);
            std::string &list     = has_name ? pieces : ids;
            list += (list.empty() ? "" : ", ") +
                    (has_name ? names.of("boundary", id) : std::to_string(id));
          }
      return pieces + (pieces.empty() || ids.empty() ? "" : " and ") +
             (ids.empty() ? "" : "boundary " + ids);
    };
    const auto add = [&](const std::string &name, const std::string &pieces) {
      if (!pieces.empty())
        result.push_back(name + " on " + pieces);
    };
    const auto add_contact = [&](const std::string &name,
                                 const ContactLaw   contact_law,
                                 const FrictionLaw  friction_law) {
      add(name, boundaries([=](const auto &b) {
            return b.contact_law == contact_law &&
                   b.friction_law == friction_law;
          }));
    };
    add_contact("bilateral contact with Tresca friction",
                ContactLaw::bilateral,
                FrictionLaw::tresca);
    add_contact("Coulomb friction with given normal stress",
                ContactLaw::given_stress,
                FrictionLaw::coulomb);
    add_contact("frictionless bilateral contact",
                ContactLaw::bilateral,
                FrictionLaw::none);
    add_contact("unilateral contact with Tresca friction",
                ContactLaw::unilateral,
                FrictionLaw::tresca);
    add_contact("unilateral contact with Coulomb friction of " + pressure,
                ContactLaw::unilateral,
                FrictionLaw::coulomb);
    add_contact("frictionless unilateral contact",
                ContactLaw::unilateral,
                FrictionLaw::none);
    add_contact("normal compliance with Tresca friction",
                ContactLaw::compliance,
                FrictionLaw::tresca);
    add_contact("normal compliance with Coulomb friction of " + pressure,
                ContactLaw::compliance,
                FrictionLaw::coulomb);
    add_contact("frictionless normal compliance",
                ContactLaw::compliance,
                FrictionLaw::none);
    add("friction that depends on the slip rate", boundaries([](const auto &b) {
          return b.slip_rate_factor.has_value();
        }));
    add("glued contact",
        boundaries([](const auto &b) { return b.is_glued(); }));
    add("foundation moving in normal direction", boundaries([](const auto &b) {
          return b.foundation_displacement.has_value();
        }));
    add("foundation moving in tangential direction",
        boundaries(
          [](const auto &b) { return b.foundation_motion.has_value(); }));
    add("contact with another body",
        boundaries([](const auto &b) { return b.against.has_value(); }));
    if (exact_solution)
      result.push_back(exact_solution->makes_data ?
                         "manufactured solution, which makes loads, initial "
                         "data and a source in G" :
                         "errors against an exact solution");
    if (body_force)
      result.push_back("body force");
    add("surface traction",
        boundaries([](const auto &b) { return b.traction.has_value(); }));
    add("surface pressure",
        boundaries([](const auto &b) { return b.pressure.has_value(); }));
    add("springs", boundaries([](const auto &b) { return b.has_springs(); }));
    add("prescribed displacement", boundaries([](const auto &b) {
          return b.role == BoundaryRole::displacement;
        }));
    for (const Support<dim> &support : supports)
      result.push_back("support at " + support.place);
    if (initial_displacement || initial_stress)
      result.push_back("initial displacement or stress");
    const std::string time_unit = unit(Quantity::time);
    for (const auto &[id, entry] : entries)
      {
        const Material<dim> &material = *entry.material;
        std::ostringstream   stages;
        if (std::isfinite(material.added_at))
          stages << " added at t = " << material.added_at << time_unit;
        if (std::isfinite(material.removed_at))
          stages << (stages.str().empty() ? "" : " and")
                 << " removed at t = " << material.removed_at << time_unit;
        if (!stages.str().empty())
          result.push_back(material.name + stages.str());
      }
    std::ostringstream tolerance;
    tolerance << "meshes and steps for an error of "
              << 100. * parameters.error_control.tolerance << " %";
    if (parameters.error_control.has_tolerance())
      result.push_back(tolerance.str());
    else if (is_adaptive())
      result.push_back("adaptive mesh (" +
                       name_of(parameters.refinement.strategy) + " estimator)");
    return result;
  }



  template <int dim>
  std::vector<std::string>
  Scene<dim>::changed_defaults() const
  {
    std::vector<std::string> result;
    const auto               add = [&](const std::string &entry,
                         const std::string &present,
                         const std::string &earlier) {
      if (parameters.origin_of(entry).empty())
        result.push_back("'" + entry + "' = " + present + " (was " + earlier +
                         ")");
    };
    if (has_viscosity())
      add("Material/Stress history",
          name_of(parameters.stress.stress_history),
          "cell means");
    if (std::any_of(boundary.begin(), boundary.end(), [](const auto &pair) {
          return pair.second.has_computed_pressure();
        }))
      add("Solver/Coulomb pressure",
          name_of(parameters.solver.coulomb_pressure),
          "lagged");
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Scene, effects);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Scene, changed_defaults);
} // namespace Viscoplastic
