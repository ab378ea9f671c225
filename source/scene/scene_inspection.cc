// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh_check.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/mesh/plane_model.h>
#include <viscoplastic_contact/scene/data_in_time.h>
#include <viscoplastic_contact/scene/output_check.h>

#include <algorithm>
#include <limits>

// Consistency checks of a scene and its mesh.

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    void
    inspect_boundary_ids(const Scene<dim>                   &scene,
                         const std::set<types::boundary_id> &ids)
    {
      for (const types::boundary_id id : ids)
        if (scene.boundary.count(id) != 1)
          refuse(
            "Boundary id " + std::to_string(id) +
            " of the mesh has no role; add `subsection Boundary " +
            std::to_string(id) +
            "' with a role (free, if it carries no load). The mesh has the ids " +
            list(ids) +
            (id == 0 && !scene.parameters.geometry.file.empty() ?
               "; faces that the file puts into no group have the id 0." :
               "."));
      for (const auto &pair : scene.boundary)
        if (ids.count(pair.first) != 1)
          refuse(
            "'Boundary " + std::to_string(pair.first) +
            "' has a role, but the mesh has no such boundary id; it has the "
            "ids " +
            list(ids) + ".");
    }



    /// Refuse sections of bodies of revolution that cross the axis or whose
    /// nodes on the axis are free to move off it. Collective.
    template <int dim>
    void
    inspect_axis(const Scene<dim>                                &scene,
                 const parallel::distributed::Triangulation<dim> &triangulation)
    {
      const std::string model = "'Geometry/Plane model' = axisymmetric";
      double            least = 0.; // of x / cell diameter
      for (const auto &cell : triangulation.active_cell_iterators())
        if (!cell->is_artificial())
          for (const unsigned int v : cell->vertex_indices())
            least = std::min(least, cell->vertex(v)[0] / cell->diameter());
      least = Utilities::MPI::min(least, triangulation.get_communicator());
      if (!(least > -1e-9))
        refuse(
          "The mesh crosses the axis: some of it has x = r < 0, but with " +
          model +
          " it is the section of a body of revolution on one side of x = 0.");

      // The coarse mesh is known to all ranks.
      std::set<unsigned int> on_axis, held;
      for (const auto &cell : triangulation.cell_iterators_on_level(0))
        {
          for (const unsigned int v : cell->vertex_indices())
            if (cell->vertex(v)[0] <= 1e-9 * cell->diameter())
              on_axis.insert(cell->vertex_index(v));
          for (const unsigned int f : cell->face_indices())
            if (const auto face = cell->face(f);
                face->at_boundary() && is_on_axis(face))
              {
                const auto &condition = scene.boundary.at(face->boundary_id());
                const auto &radial    = condition.displacement[0];
                if (condition.role != BoundaryRole::symmetry &&
                    condition.role != BoundaryRole::clamped &&
                    (!radial || !radial->is_zero()))
                  refuse(
                    "Boundary " + std::to_string(condition.id) +
                    " lies on the axis of a body of revolution, where u_r = "
                    "0; give it the role symmetry, or a displacement whose "
                    "first component is 0.");
                for (const unsigned int v : face->vertex_indices())
                  held.insert(face->vertex_index(v));
              }
        }
      for (const unsigned int vertex : on_axis)
        if (held.count(vertex) != 1)
          refuse(
            "The mesh touches the axis of revolution in a single node, "
            "which nothing holds there; let a boundary lie on the axis, or "
            "none of it.");
    }



    /// Warn of entries of boundaries and of the initial state without effect.
    template <int dim>
    void
    inspect_unused_entries(Scene<dim> &scene)
    {
      if (scene.parameters.initial_state.reset_displacement &&
          !scene.parameters.initial_state.equilibrate &&
          !scene.initial_displacement)
        scene.warnings.emplace_back(
          "'Initial state/Reset displacement' changes nothing: without "
          "'Displacement' or 'Equilibrate' displacements begin with zero.");
      for (const auto &[id, condition] : scene.boundary)
        {
          const BoundaryParameters &given = scene.parameters.boundaries.at(id);
          for (const std::string &name : condition.unused_entries(given))
            scene.warnings.push_back(
              "'Boundary " + std::to_string(id) + "/" + name +
              "' is not used by the role " + name_of(given.role) +
              (condition.role == BoundaryRole::contact ?
                 (given.entries.at("Contact law") == "not given" ?
                    "" :
                    " with the contact law " + condition.contact_law->name) +
                   " with the friction law " + condition.friction_law->name :
                 "") +
              ".");
        }
    }



    /// Refuse curved contact boundaries with edges, given the largest angle
    /// between adjacent faces; warn if the angle is suspicious.
    template <int dim>
    void
    inspect_curve(Scene<dim>              &scene,
                  const types::boundary_id id,
                  const double             angle)
    {
      if (angle <= 30.)
        return;
      const std::string sentence =
        "The faces of boundary " + std::to_string(id) +
        ", which is in contact with another body, meet at an angle of " +
        as_text(angle) +
        " degrees, and normals at their nodes are means of theirs: give the "
        "parts beside an edge boundary ids of their own, and a curve more cells.";
      if (!(angle <= 60.))
        refuse(sentence);
      scene.warnings.push_back(sentence);
    }



    template <int dim>
    void
    inspect_flatness(
      Scene<dim>                                      &scene,
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      const double tolerance = scene.parameters.geometry.flatness_tolerance;
      for (auto &[id, condition] : scene.boundary)
        if (condition.role == BoundaryRole::symmetry ||
            condition.role == BoundaryRole::contact)
          {
            const PieceNormal<dim> piece = piece_normal(triangulation, id);
            if (condition.normal_is_given)
              {
                if (!faces_towards(triangulation, id, condition.normal))
                  refuse(
                    "'Boundary " + std::to_string(id) +
                    "/Foundation normal' points into the body; it goes from "
                    "the body into the foundation.");
                continue;
              }
            condition.normal = piece.normal;
            condition.normal_varies =
              condition.against.has_value() && piece.deviation > tolerance;
            if (condition.normal_varies)
              {
                for (const types::boundary_id side : {id, *condition.against})
                  inspect_curve(scene,
                                side,
                                largest_angle(triangulation, side));
                continue;
              }
            if (!(piece.deviation <= tolerance))
              refuse("Boundary " + std::to_string(id) + " has the role " +
                     name_of(condition.role) +
                     " but is not flat: its normals deviate by " +
                     as_text(piece.deviation) +
                     " degrees from their mean, and 'Geometry/Flatness "
                     "tolerance' is " +
                     as_text(tolerance) +
                     "; give each flat piece a boundary id of its own" +
                     (condition.is_unilateral() ?
                        ", or the foundation a 'Foundation normal'." :
                        "."));
          }
    }



    template <int dim>
    void
    inspect_contact_pairs(
      const Scene<dim>                                &scene,
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      const auto touching = touching_boundaries(triangulation);
      for (const auto &[id, condition] : scene.boundary)
        if (condition.against)
          for (const auto &[other_id, other] : scene.boundary)
            if (other_id != id && touching.count({id, other_id}) != 0 &&
                (other.role == BoundaryRole::contact ||
                 scene.is_other_side(other_id)))
              refuse(
                "Boundary " + std::to_string(id) +
                ", which is in contact with another body, has nodes in common "
                "with boundary " +
                std::to_string(other_id) +
                ", which is in contact, too; a node can be in contact with one "
                "other body or foundation. Leave a face between them free.");
    }



    /// Warn of boundaries with prescribed displacement that touch Gamma_3.
    template <int dim>
    void
    inspect_junctions(
      Scene<dim>                                      &scene,
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      const auto touching = touching_boundaries(triangulation);
      for (const auto &[id, condition] : scene.boundary)
        if (condition.prescribes_all())
          for (const auto &[other_id, other] : scene.boundary)
            if (other.has_contact_points() &&
                touching.count({id, other_id}) == 1)
              scene.warnings.push_back(
                "Boundary " + std::to_string(id) + " (" +
                (condition.is_glued() ? "glued" :
                 condition.role == BoundaryRole::clamped ?
                                        "clamped" :
                                        "prescribed displacement") +
                ") touches boundary " + std::to_string(other_id) +
                (other.has_friction() ? " (friction)" : " (contact)") +
                "; the theory keeps the closures of Gamma_1 and Gamma_3 apart, "
                "and stresses may be singular where they meet.");
    }



    /// Warn of a temperature without effect or probably not absolute.
    template <int dim>
    void
    inspect_temperature(Scene<dim>               &scene,
                        const Triangulation<dim> &triangulation)
    {
      if (!scene.temperature)
        return;
      if (scene.has_source())
        refuse(
          "'Exact solution/Data' = solution makes no data for a body with a "
          "temperature; leave 'Temperature/Value' out, or use 'Data' = scene.");
      bool is_used = scene.has_thermal_strain();
      for (const auto &material : scene.materials)
        {
          is_used |= material->law && material->law->depends_on_temperature();
          if (!material->needs_absolute_temperature())
            continue;
          // The default R needs kelvins; values this low suggest degrees
          // Celsius.
          constexpr double suspiciously_cold = 60.;
          double           least = std::numeric_limits<double>::infinity();
          for (const double T : values_at(scene.temperature->value,
                                          places_in_body(triangulation),
                                          0.))
            least = std::min(least, T);
          if (scene.parameters.temperature.gas_constant.empty() && least > 0. &&
              least < suspiciously_cold)
            scene.warnings.push_back(
              "'Temperature/Value' is " + as_text(least) +
              " K somewhere at t = 0, but '" + material->section +
              "/Activation energy' asks for absolute temperatures; if these are "
              "degrees Celsius, add 273.15.");
        }
      if (!is_used)
        scene.warnings.push_back(
          "'Temperature/Value' has no effect: no material has "
          "'Thermal expansion', 'Activation energy' or a law "
          "of the temperature T.");
    }
  } // namespace



  template <int dim>
  void
  Scene<dim>::inspect(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    warnings.clear();
    const auto warn = [this](const std::vector<std::string> &sentences) {
      warnings.insert(warnings.end(), sentences.begin(), sentences.end());
    };
    if (!has_contact_pairs())
      check_connection(triangulation);
    inspect_boundary_ids(*this, boundary_ids(triangulation));
    inspect_unused_entries(*this);
    if (is_axisymmetric())
      inspect_axis(*this, triangulation);
    inspect_flatness(*this, triangulation);
    inspect_junctions(*this, triangulation);
    if (has_contact_pairs())
      inspect_contact_pairs(*this, triangulation);
    warn(place_supports(triangulation, boundary, supports));
    warn(warnings_of_data_in_time(*this, triangulation));
    make_materials(material_ids(triangulation));
    inspect_temperature(*this, triangulation);
    find_stages(triangulation);
    warn(check_output_places(*this, triangulation));
    if (exact_solution)
      {
        const bool is_elastic =
          materials.size() == 1 && !materials[0]->law && !has_thermal_strain();
        exact_solution->set_body(body_diagonal(triangulation),
                                 is_elastic ? materials[0].get() : nullptr);
        for (auto &pair : boundary)
          pair.second.derive_data();
      }
  }



  template <int dim>
  void
  Scene<dim>::make_materials(const std::set<types::material_id> &ids)
  {
    materials.clear();
    entries.clear();
    const auto make = [this](const std::string        &section,
                             const MaterialParameters &given) {
      materials.push_back(
        std::make_unique<const Material<dim>>(section,
                                              given,
                                              parameters.handler,
                                              parameters.laws,
                                              /* is_absent = */ false,
                                              temperature.get()));
    };
    if (parameters.materials.empty())
      {
        make("Material", parameters.material);
        for (const types::material_id id : ids)
          entries[id] = {materials[0].get()};
        return;
      }

    for (const types::material_id id : ids)
      {
        const auto section = "Material " + std::to_string(id);
        const auto given   = parameters.materials.find(id);
        if (given == parameters.materials.end())
          refuse("Cells of the mesh have the material id " +
                 std::to_string(id) + ", but there is no `subsection " +
                 section + "'; the mesh has the material ids " + list(ids) +
                 ".");
        MaterialParameters named = given->second;
        if (names.has("material", id))
          named.name = names.of("material", id);
        make(section, named);
        entries[id] = {materials.back().get()};
      }
    for (const auto &pair : parameters.materials)
      if (ids.count(pair.first) == 0)
        warnings.push_back("'Material " + std::to_string(pair.first) +
                           "' is not used: the mesh has the material ids " +
                           list(ids) + ".");
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Scene, inspect);
} // namespace Viscoplastic
