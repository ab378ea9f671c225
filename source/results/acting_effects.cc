// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/acting_effects.h>

namespace Viscoplastic
{
  namespace
  {
    /// Add sentences on data of boundaries that have had no effect.
    template <int dim>
    void
    add_idle_data(const Scene<dim>                   &scene,
                  const std::set<types::boundary_id> &loads,
                  const bool                          foundation_has_moved,
                  std::vector<std::string>           &result)
    {
      for (const auto &[id, condition] : scene.boundary)
        {
          const std::string section = "Boundary " + std::to_string(id);
          std::string       entries;
          for (const auto &[name, is_given] :
               {std::make_pair("Traction", condition.traction.has_value()),
                std::make_pair("Pressure", condition.pressure.has_value()),
                std::make_pair("Normal stress",
                               condition.normal_stress.has_value())})
            if (is_given)
              entries +=
                (entries.empty() ? "'" : " and '") + section + '/' + name + "'";
          if (!entries.empty() && loads.count(id) == 0)
            result.push_back("the load on " + scene.names.of("boundary", id) +
                             " has never acted: what " + entries +
                             " gives has been zero at all times wherever "
                             "displacements are free, and " +
                             (condition.role == BoundaryRole::displacement ||
                                  condition.has_springs() ?
                                "can go." :
                                "'Role' = free gives the same for less."));
          if (scene.has_friction() && !foundation_has_moved &&
              condition.has_friction() && condition.foundation_motion)
            result.push_back("the motion of the foundation has never acted: no "
                             "foundation has moved, and '" +
                             section + "/Foundation motion' can go.");
        }
    }
  } // namespace



  template <int dim>
  void
  ActingEffects<dim>::note(const Discretization<dim> &discretization,
                           const AcceptedStep<dim>   &step)
  {
    const std::set<types::boundary_id> &acting = step.end.forces.load.acting;
    loads.insert(acting.begin(), acting.end());
    if (!discretization.face)
      return;
    const auto is_so = [&discretization](const bool here) {
      return Utilities::MPI::logical_or(here,
                                        discretization.space.communicator);
    };
    const ContactLayout &layout = discretization.face->layout();
    if (!has_bound)
      {
        bool here = false;
        for (const unsigned int p : layout.friction_points())
          here |= step.end.state.contact.bound[p] > 0.;
        has_bound = is_so(here);
      }
    if (discretization.face->has_obstacles() && step.time_step.n > 0)
      {
        const ContactState &state   = step.end.state.contact;
        bool                touches = false, is_open = false;
        for (const unsigned int o : layout.obstacles())
          // Any pressure counts, however small beside those in the body.
          (state.multiplier[o][0] > 0. ||
               (!layout.points[o].compliance.is_rigid() &&
                state.penetration(o) > 0.) ?
             touches :
             is_open) = true;
        // A body held by contact alone needs it even without any pressure.
        has_touched = has_touched ||
                      discretization.space.is_held_by_contact() ||
                      is_so(touches);
        has_opened = has_opened || is_so(is_open);
        if (!has_touched && !closes_between_nodes)
          closes_between_nodes =
            discretization.face->closes_between_nodes(step.time_step.t,
                                                      step.end.forces.u);
      }
    const auto &steps = step.end.state.contact.foundation_step;
    if (!foundation_has_moved && discretization.scene().has_moving_foundation())
      foundation_has_moved =
        is_so(std::any_of(steps.begin(), steps.end(), [](const auto &w) {
          return w != Tensor<1, 2>();
        }));
  }



  template <int dim>
  std::vector<std::string>
  ActingEffects<dim>::that_never_acted(const Scene<dim>      &scene,
                                       const RunSummary<dim> &run) const
  {
    std::vector<std::string> result;
    // If the mesh is far too coarse, effects may be missing because of it.
    const double      error    = run.errors && run.errors->size > 0. ?
                                   run.errors->largest.space / run.errors->size :
                                   0.;
    const bool        is_rough = error > 0.3;
    const std::string on_this_mesh =
      "which with an error of the mesh of " + number(100. * error, 2) +
      " % in the energy norm a finer one may change.";
    if (scene.has_viscosity() && !run.has_flowed)
      {
        std::string text = "viscoplastic flow has never acted: no material has "
                           "flowed, and 'Law' = elastic gives the same for "
                           "less.";
        for (const auto &material : scene.materials)
          if (material->law_name == "perzyna")
            text += " The stress has stayed below '" + material->section +
                    "/perzyna/Yield radius', so that no hardening has been "
                    "used either.";
        result.push_back(text);
      }
    if (scene.has_friction() && !has_bound)
      result.push_back("friction has never acted: its bound has been zero "
                       "everywhere and at all times, " +
                       (is_rough ?
                          on_this_mesh :
                          "and contact without friction ('Friction law' = none "
                          "if it is bilateral, 'Role' = traction if its "
                          "pressure is given) gives the same for less."));
    else if (scene.has_friction() && run.slip_area.value == 0.)
      {
        std::string text =
          "friction has never acted: nothing has slipped, and at most " +
          number(100. * run.utilization.value, 3) + " % of a bound was needed";
        if (scene.on_any_boundary([](const auto &b) {
              return b.has_friction() && !b.is_unilateral();
            }))
          text += "; on bilateral contact 'Friction law' = glued gives the "
                  "same for less";
        text += '.';
        // With a tolerance of a quantity, stresses may be far less accurate.
        if (run.errors)
          text +=
            " Tractions of single nodes, as where cells change their "
            "size, have errors of the order of that in the energy norm, " +
            number(100. * run.errors->relative(), 3) + " %.";
        result.push_back(text);
      }
    if (scene.has_unilateral_contact() && !has_touched && closes_between_nodes)
      result.push_back("unilateral contact has never acted: the gap has closed "
                       "between the nodes, but not at them; the mesh is too "
                       "coarse for it ('Geometry/Boundary refinements').");
    else if (scene.has_unilateral_contact() && !has_touched &&
             !scene.on_any_boundary([](const auto &b) {
               return b.is_unilateral() && b.has_friction() &&
                      !b.has_computed_pressure();
             }))
      result.push_back(
        "unilateral contact has never acted: nothing has touched "
        "the foundation, " +
        (is_rough ? on_this_mesh :
                    "and 'Role' = free gives the same for less."));
    else if (scene.has_unilateral_contact() && has_touched && !has_opened &&
             !scene.on_any_boundary([](const auto &b) {
               return b.has_computed_pressure() || b.has_normal_compliance();
             }))
      result.push_back("unilateral contact has never opened: everything has "
                       "touched the foundation at all times, and 'Contact law' "
                       "= bilateral with the gap as 'Foundation displacement' "
                       "gives the same for less.");
    add_idle_data(scene, loads, foundation_has_moved, result);
    if (scene.body_force && loads.count(body_force_id) == 0)
      result.push_back("the body force has never acted: 'Loads/Body force' has "
                       "been zero everywhere and at all times, and can go.");
    // With a tolerance of a quantity, an earlier pass may have found the mesh.
    if (scene.is_adaptive() && !mesh_has_changed &&
        !(scene.quantity && scene.parameters.error_control.has_tolerance()))
      result.push_back("adaptivity has never acted: the mesh has never "
                       "changed, and 'Mesh refinement/Strategy' = none gives "
                       "the same for less.");
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ActingEffects);
} // namespace Viscoplastic
