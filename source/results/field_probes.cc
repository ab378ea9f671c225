// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/results/field_probes.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    VertexWeights<dim>
    shape_values(const Point<dim> &unit)
    {
      VertexWeights<dim> result;
      for (unsigned int v = 0; v < result.size(); ++v)
        result[v] = GeometryInfo<dim>::d_linear_shape_function(unit, v);
      return result;
    }
  } // namespace



  template <int dim>
  FieldProbes<dim>::FieldProbes(const Discretization<dim>     &discretization,
                                const std::vector<Point<dim>> &points,
                                const std::set<RecordedField> &fields)
    : discretization(discretization)
    , fields(fields)
    , all_names(BodyFields<dim>::names(fields))
    , n_body(all_names.size())
    , is_on_face(points.size(), false)
  {
    const Triangulation<dim> &mesh =
      discretization.space.dof_handler.get_triangulation();
    const Scene<dim> &scene = discretization.scene();
    in_body =
      locate_points(mesh, points, [&scene](const types::material_id id) {
        return scene.is_present(id);
      }).points;
    if (scene.has_stages())
      {
        std::vector<unsigned int> is_absent(points.size(), 0);
        for (std::size_t i = 0; i < points.size(); ++i)
          if (in_body[i].is_mine())
            is_absent[i] = !scene.is_present(
              discretization.space.cells[in_body[i].cell]->material_id());
        Utilities::MPI::sum(is_absent,
                            discretization.space.communicator,
                            is_absent);
        for (std::size_t i = 0; i < points.size(); ++i)
          if (is_absent[i] > 0)
            absent_points.push_back(i);
      }
    const auto of_boundary = BoundaryFields<dim>::names(fields);
    if (of_boundary.empty())
      return;
    all_names.insert(all_names.end(), of_boundary.begin(), of_boundary.end());
    const PointLocations<dim> found =
      locate_on_boundary(mesh,
                         points,
                         discretization.scene().contact_boundaries());
    on_face = found.points;
    for (std::size_t i = 0; i < points.size(); ++i)
      is_on_face[i] = found.distances[i] == 0.;
  }



  template <int dim>
  std::vector<double>
  FieldProbes<dim>::values(const State<dim> &state) const
  {
    const AdmissibleSpace<dim> &space   = discretization.space;
    const std::size_t           n_names = all_names.size();
    std::vector<double>         result(in_body.size() * n_names, 0.);
    {
      const BodyFields<dim> body(discretization.laws, state, fields);
      for (std::size_t i = 0; i < in_body.size(); ++i)
        if (in_body[i].is_mine())
          body.add(in_body[i].cell,
                   shape_values(in_body[i].unit),
                   &result[i * n_names]);
    }
    if (!on_face.empty())
      {
        const BoundaryFields<dim> boundary(discretization.stress_space,
                                           state,
                                           discretization.face.get(),
                                           fields);
        for (std::size_t i = 0; i < on_face.size(); ++i)
          if (const CellPoint<dim> &place = on_face[i]; place.is_mine())
            {
              const types::boundary_id id =
                space.cells[place.cell]->face(place.face)->boundary_id();
              boundary.add(place.cell,
                           place.face,
                           shape_values(place.unit),
                           space.scene.boundary.at(id).normal,
                           &result[i * n_names + n_body]);
            }
      }
    Utilities::MPI::sum(result, space.communicator, result);
    for (const std::size_t i : absent_points)
      std::fill(&result[i * n_names],
                &result[i * n_names] + n_body,
                std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < on_face.size(); ++i)
      if (!is_on_face[i])
        std::fill(&result[i * n_names + n_body],
                  &result[i * n_names] + n_names,
                  std::numeric_limits<double>::quiet_NaN());
    return result;
  }



  template class FieldProbes<2>;
  template class FieldProbes<3>;
} // namespace Viscoplastic
