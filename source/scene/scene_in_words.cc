// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/scene/scene.h>

#include <cmath>

// The effects of a scene in words for the user.

namespace Viscoplastic
{
  namespace
  {
    /// A contact law combined with a friction law, in words.
    std::string
    in_words(const ContactLaw &contact, const FrictionLaw &friction)
    {
      if (friction.entries.empty())
        return "frictionless " + contact.words;
      if (contact.kind == ContactLaw::Kind::given_stress)
        return friction.words + " with " + contact.words;
      return contact.words + " with " + friction.words +
             (friction.follows_pressure() ? " of the computed pressure" : "");
    }



    /// Add "@p name on A and boundary 3, 4" with all boundaries for whose
    /// condition @p holds is true, if any.
    template <int dim, typename Predicate>
    void
    add_on_boundaries(const Scene<dim>         &scene,
                      const std::string        &name,
                      const Predicate          &holds,
                      std::vector<std::string> &effects)
    {
      std::string pieces, ids;
      for (const auto &[id, condition] : scene.boundary)
        if (holds(condition))
          {
            const bool   has_name = scene.names.has("boundary", id);
            std::string &list     = has_name ? pieces : ids;
            list +=
              (list.empty() ? "" : ", ") +
              (has_name ? scene.names.of("boundary", id) : std::to_string(id));
          }
      if (!pieces.empty() || !ids.empty())
        effects.push_back(name + " on " + pieces +
                          (pieces.empty() || ids.empty() ? "" : " and ") +
                          (ids.empty() ? "" : "boundary " + ids));
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  Scene<dim>::effects() const
  {
    std::vector<std::string> result{
      is_axisymmetric() ? "elasticity (axisymmetric)" :
      is_generalized()  ? "elasticity (generalized plane strain)" :
      dim == 2          ? "elasticity (plane strain)" :
                          "elasticity (3D)"};
    const std::string history = name_of(parameters.stress.stress_history);
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
    const auto add = [&](const std::string &name, const auto &holds) {
      add_on_boundaries(*this, name, holds, result);
    };
    for (const ContactLaw &contact : contact_laws())
      for (const FrictionLaw &friction : friction_laws())
        if (!friction.is_glued)
          add(in_words(contact, friction), [&](const auto &b) {
            return b.contact_law == &contact && b.friction_law == &friction;
          });
    add("friction that depends on the slip rate",
        [](const auto &b) { return b.slip_rate_factor.has_value(); });
    add("glued contact", [](const auto &b) { return b.is_glued(); });
    add("foundation moving in normal direction",
        [](const auto &b) { return b.foundation_displacement.has_value(); });
    add("foundation moving in tangential direction",
        [](const auto &b) { return b.foundation_motion.has_value(); });
    add("contact with another body",
        [](const auto &b) { return b.against.has_value(); });
    if (exact_solution)
      result.push_back(exact_solution->makes_data ?
                         "manufactured solution, which makes loads, initial "
                         "data and a source in G" :
                         "errors against an exact solution");
    if (body_force)
      result.push_back("body force");
    add("surface traction",
        [](const auto &b) { return b.traction.has_value(); });
    add("surface pressure",
        [](const auto &b) { return b.pressure.has_value(); });
    add("springs", [](const auto &b) { return b.has_springs(); });
    add("prescribed displacement",
        [](const auto &b) { return b.role == BoundaryRole::displacement; });
    for (const Support<dim> &support : supports)
      result.push_back("support at " + support.place);
    if (initial_displacement || initial_stress)
      result.push_back("initial displacement or stress");
    const std::string time_unit = unit(Quantity::time);
    for (const auto &[id, entry] : entries)
      {
        const Material<dim> &material = *entry.material;
        std::string          stages;
        if (std::isfinite(material.added_at))
          stages = " added at t = " + as_text(material.added_at) + time_unit;
        if (std::isfinite(material.removed_at))
          stages += (stages.empty() ? "" : " and") +
                    (" removed at t = " + as_text(material.removed_at)) +
                    time_unit;
        if (!stages.empty())
          result.push_back(material.name + stages);
      }
    if (parameters.error_control.has_tolerance())
      result.push_back("meshes and steps for an error of " +
                       as_text(100. * parameters.error_control.tolerance) +
                       " %");
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
    if (on_any_boundary([](const auto &condition) {
          return condition.has_computed_pressure();
        }))
      add("Solver/Coulomb pressure",
          name_of(parameters.solver.coulomb_pressure),
          "lagged");
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Scene, effects);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Scene, changed_defaults);
} // namespace Viscoplastic
