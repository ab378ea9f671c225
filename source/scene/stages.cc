// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh_check.h>
#include <viscoplastic_contact/scene/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

// The stages of construction of a scene: materials that come and go.

namespace Viscoplastic
{
  namespace
  {
    /// Return the end of the phase at time @p t; nothing if it is not before
    /// the end of the run. Throws ExcMessage if t is not, up to rounding, that
    /// end.
    std::optional<double>
    end_of_phase(const TimeSchedule &schedule,
                 const double        t,
                 const std::string  &entry)
    {
      constexpr double rounding = 1e-9;
      if (t >= schedule.end_time() * (1. - rounding))
        return {};
      const double end = schedule.phase_at(t * (1. - rounding)).end;
      if (!(std::abs(end - t) <= rounding * t))
        refuse(
          "'" + entry + "' = " + as_text(t) +
          " is not the end of a phase. The body changes between two phases of "
          "'Time/Phases': let one end then; the present one ends at t = " +
          as_text(end) + ".");
      return end;
    }
  } // namespace



  template <int dim>
  void
  Scene<dim>::find_stages(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::set<types::material_id>                               changing;
    std::map<const Material<dim> *, std::pair<double, double>> times;
    stage_ends.clear();
    for (const auto &[id, entry] : entries)
      {
        const Material<dim> &material = *entry.material;
        const auto           read     = [&, id = id](const double       t,
                                       const std::string &name) {
          if (!std::isfinite(t))
            return t;
          const std::string path = material.section + "/" + name;
          if (parameters.materials.empty())
            refuse("'" + path +
                   "' would be that of the whole body; give numbers to the "
                                 "materials, of which one has to stay.");
          if (has_source())
            refuse("'" + path +
                   "' contradicts 'Exact solution/Data' = solution, which is "
                                 "that of one body.");
          changing.insert(id);
          if (name == "Added at" && !keeps_history_at_points())
            warnings.push_back(
              "'" + path +
              "' with 'Material/Stress history' = cell means: "
                            "what is added has no stress in the mean of each "
                            "cell, but some within coarse cells; with "
                            "quadrature points it has none.");
          const auto end = end_of_phase(schedule, t, path);
          if (!end)
            return std::numeric_limits<double>::infinity();
          stage_ends.push_back(*end);
          return *end;
        };
        times[&material] = {read(material.added_at, "Added at"),
                            read(material.removed_at, "Removed at")};
      }
    has_changing_materials = !changing.empty();
    std::sort(stage_ends.begin(), stage_ends.end());
    stage_ends.erase(std::unique(stage_ends.begin(), stage_ends.end()),
                     stage_ends.end());

    for (const types::material_id id : changing)
      {
        Entry &entry = entries[id];
        materials.push_back(
          std::make_unique<const Material<dim>>(entry.material->section,
                                                parameters.materials.at(id),
                                                parameters.handler,
                                                parameters.laws,
                                                /* is_absent = */ true));
        entry.absent                = materials.back().get();
        const auto [added, removed] = times[entry.material];
        // Stage n + 1 begins where stage n ends, at stage_ends[n].
        entry.begin =
          std::isfinite(added) || added > 0. ? 1 + stage_of_step_to(added) : 0;
        entry.end = 1 + stage_of_step_to(removed);
      }

    for (unsigned int n = 0; n <= stage_ends.size(); ++n)
      {
        enter_stage(n);
        if (!std::any_of(material_of_id.begin(),
                         material_of_id.end(),
                         [](const auto &pair) {
                           return !pair.second->is_absent;
                         }))
          refuse("'Added at' and 'Removed at' leave no material " +
                 (n == 0 ? "at the beginning." :
                           "from t = " + as_text(stage_ends[n - 1]) + " on."));
      }
    enter_stage(0);
    inspect_contact_of_stages(changing, triangulation);
  }



  template <int dim>
  void
  Scene<dim>::inspect_contact_of_stages(
    const std::set<types::material_id>              &changing,
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    // The coarse mesh is known to all ranks.
    std::vector<typename Triangulation<dim>::cell_iterator> others;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      for (const unsigned int f : cell->face_indices())
        if (cell->at_boundary(f))
          {
            const types::boundary_id id = cell->face(f)->boundary_id();
            const bool is_changed = changing.count(cell->material_id()) == 1;
            if (is_changed && boundary.at(id).has_springs())
              refuse("Boundary " + std::to_string(id) +
                     " has springs and a part in '" +
                     material(cell->material_id()).section +
                     "', which is added or removed; the pieces with springs "
                     "have to stay the same.");
            has_changing_contact |=
              is_changed && (boundary.at(id).role == BoundaryRole::contact ||
                             is_other_side(id));
            if (is_changed && is_other_side(id))
              others.push_back(cell);
          }
    if (others.empty())
      return;

    const ConnectedParts bodies =
      connected_parts<dim>(triangulation,
                           [](const types::material_id) { return true; });
    const auto body_of = [&bodies](const auto &cell) {
      return bodies.of_cell[cell->id().get_coarse_cell_id()];
    };
    for (unsigned int n = 0; n <= stage_ends.size(); ++n)
      {
        enter_stage(n);
        std::set<unsigned int> present;
        for (const auto &cell : triangulation.cell_iterators_on_level(0))
          if (is_present(cell->material_id()))
            present.insert(body_of(cell));
        for (const auto &cell : others)
          if (present.count(body_of(cell)) != 1)
            refuse("'" + lasting_material(cell->material_id()).section +
                   "' is absent for a time, and with it the whole of a body "
                   "that another one is 'Against'. Let the body that comes or "
                   "goes have the contact, 'Against' the one that stays: it "
                   "follows that until it comes.");
      }
    enter_stage(0);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Scene, inspect_contact_of_stages);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Scene, find_stages);
} // namespace Viscoplastic
