// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>
#include <viscoplastic_contact/mesh/point_location.h>
#include <viscoplastic_contact/scene/output_check.h>

namespace Viscoplastic
{
  namespace
  {
    /// Throw ExcMessage unless the scene has the @p fields of contact, friction
    /// and history that @p entry asks for.
    template <int dim>
    void
    check_fields(const Scene<dim>              &scene,
                 const std::set<RecordedField> &fields,
                 const std::string             &entry)
    {
      for (const RecordedField field : fields)
        {
          const auto needs = [&](const bool is_there, const std::string &what) {
            if (!is_there)
              refuse("'" + entry + "': there is no `" + name_of(field) +
                     "' where no " + what + ".");
          };
          needs(!is_of_contact(field) || scene.has_contact(),
                "boundary has the role contact");
          needs(field != RecordedField::history || scene.has_history(),
                "law has history variables");
          needs(!is_of_friction(field) || scene.has_friction(),
                "boundary has friction");
          needs(!is_of_unilateral_contact(field) ||
                  scene.has_unilateral_contact(),
                "boundary has unilateral contact");
        }
    }



    /// Throw ExcMessage unless the scene has the @p fields and, for fields of
    /// the boundary, some of the @p points are on Gamma_3.
    template <int dim>
    void
    check_fields_at(
      const Scene<dim>                                &scene,
      const parallel::distributed::Triangulation<dim> &triangulation,
      const std::vector<Point<dim>>                   &points,
      const std::set<RecordedField>                   &fields,
      const std::string                               &entry,
      const std::string                               &places)
    {
      check_fields(scene, fields, entry);
      const auto field =
        std::find_if(fields.begin(), fields.end(), is_of_boundary);
      if (points.empty() || field == fields.end())
        return;
      const auto found =
        locate_on_boundary(triangulation, points, scene.contact_boundaries());
      if (std::count(found.distances.begin(), found.distances.end(), 0.) == 0)
        refuse("'" + entry + "': `" + name_of(*field) +
               "' is a field of boundaries with the role contact, and " +
               places + ".");
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  check_output_places(
    const Scene<dim>                                &scene,
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    const OutputParameters &asked = scene.parameters.output;
#ifndef DEAL_II_WITH_HDF5
    if (asked.in_hdf5)
      refuse("'Output/Fields in HDF5' needs a deal.II with HDF5, which this "
             "one has not.");
#endif
    check_points(triangulation, scene.output_points, "Output/Points");
    check_fields_at(scene,
                    triangulation,
                    scene.output_points,
                    asked.point_fields,
                    "Output/Point fields",
                    "none of 'Output/Points' is on one");
    std::vector<Point<dim>> points_of_lines;
    for (const OutputLine<dim> &line : scene.output_lines)
      for (const Point<dim> &x : line.points())
        points_of_lines.push_back(x);
    check_points(triangulation, points_of_lines, "Output/Lines");
    check_fields_at(scene,
                    triangulation,
                    points_of_lines,
                    asked.line_fields,
                    "Output/Line fields",
                    "none of 'Output/Lines' has a point on one");

    using Domain                                 = OutputIntegral::Domain;
    const std::string                  entry     = "Output/Integrals";
    const std::set<types::material_id> materials = material_ids(triangulation);
    for (const OutputIntegral &integral : scene.output_integrals)
      {
        const std::string id = std::to_string(integral.id);
        if (integral.domain == Domain::material &&
            materials.count(integral.id) != 1)
          refuse("'" + entry + "': no cell has the material id " + id +
                 "; the mesh has the material ids " +
                 list({materials.begin(), materials.end()}) + ".");
        if (integral.domain != Domain::boundary)
          continue;
        const auto boundary = scene.boundary.find(integral.id);
        if (boundary == scene.boundary.end())
          refuse("'" + entry + "': there is no boundary " + id +
                 "; the mesh has the ids " + list(boundary_ids(triangulation)) +
                 ".");
        for (const RecordedField field : integral.fields)
          if ((is_of_contact(field) &&
               boundary->second.role != BoundaryRole::contact) ||
              (is_of_friction(field) && !boundary->second.has_friction()) ||
              (is_of_unilateral_contact(field) &&
               !boundary->second.is_unilateral()))
            refuse("'" + entry + "': boundary " + id + " has no `" +
                   name_of(field) + "', which takes " +
                   (is_of_friction(field)           ? "friction." :
                    is_of_unilateral_contact(field) ? "unilateral contact." :
                                                      "the role contact."));
      }

    std::vector<std::string> warnings;
    for (const auto &[id, condition] : scene.boundary)
      if (condition.against && !condition.is_glued() &&
          !scene.output_points.empty())
        {
          const auto here     = locate_on_boundary(triangulation,
                                               scene.output_points,
                                               {id}),
                     opposite = locate_on_boundary(triangulation,
                                                   scene.output_points,
                                                   {*condition.against});
          for (std::size_t p = 0; p < scene.output_points.size(); ++p)
            if (here.distances[p] == 0. && opposite.distances[p] == 0.)
              warnings.push_back(
                "'Output/Points': " + scene.names.of("point", p) +
                " lies in both bodies, on " + scene.names.of("boundary", id) +
                " and on what is against it; it is taken of the body whose "
                "cell there has the center with the least coordinates. Move it "
                "a little into the one that is meant.");
        }
    if (!asked.point_fields.empty() && scene.output_points.empty())
      warnings.push_back(
        "'Output/Point fields' is not used without 'Output/Points'.");
    if (!asked.line_fields.empty() && scene.output_lines.empty())
      warnings.push_back(
        "'Output/Line fields' is not used without 'Output/Lines'.");
    return warnings;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(OutputLine);
  VISCOPLASTIC_INSTANTIATE(check_output_places);
} // namespace Viscoplastic
