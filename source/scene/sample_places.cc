// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/scene/data_in_time.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int n_places = 64;



    /// About n_places points, spread evenly over parts of dimension @p n.
    template <int n, int dim, typename Iterator>
    std::vector<Point<dim>>
    places_in(const std::vector<Iterator> &parts)
    {
      if (parts.empty())
        return {};
      const std::size_t stride =
        std::max<std::size_t>(1, parts.size() / n_places);
      const double       in_each = double(n_places) * stride / parts.size();
      const QIterated<n> lattice(QMidpoint<1>(),
                                 std::ceil(std::pow(in_each, 1. / n)));
      std::vector<Point<dim>> places;
      for (std::size_t i = 0; i < parts.size(); i += stride)
        for (const Point<n> &point : lattice.get_points())
          {
            Point<dim> x;
            for (const unsigned int v : parts[i]->vertex_indices())
              x += GeometryInfo<n>::d_linear_shape_function(point, v) *
                   parts[i]->vertex(v);
            places.push_back(x);
          }
      return places;
    }
  } // namespace



  template <int dim>
  std::vector<Point<dim>>
  places_on_boundary(const Triangulation<dim> &triangulation,
                     const types::boundary_id  id)
  {
    std::vector<typename Triangulation<dim>::face_iterator> faces;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() == id)
          faces.push_back(cell->face(f));
    return places_in<dim - 1, dim>(faces);
  }



  template <int dim>
  std::vector<Point<dim>>
  places_in_body(const Triangulation<dim> &triangulation)
  {
    std::vector<typename Triangulation<dim>::cell_iterator> cells;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      cells.push_back(cell);
    return places_in<dim, dim>(cells);
  }



  template <int dim>
  std::vector<double>
  values_at(const Expression<dim>         &datum,
            const std::vector<Point<dim>> &places,
            const double                   t)
  {
    std::vector<double> result;
    for (const Point<dim> &x : places)
      {
        result.push_back(datum.value(x, t));
        if (!datum.depends_on_position())
          break;
      }
    return result;
  }



  template <int dim>
  std::vector<DatumInTime<dim>>
  data_in_time(const Scene<dim> &scene, const Triangulation<dim> &triangulation)
  {
    std::vector<DatumInTime<dim>> result;
    const auto add = [&](const Expression<dim> &datum, const auto &places_of) {
      if (datum.depends_on_time())
        result.push_back({datum, places_of()});
    };
    const auto in_body = [&] { return places_in_body(triangulation); };
    for (const auto &[id, condition] : scene.boundary)
      for (const Expression<dim> *datum : condition.data())
        add(*datum,
            [&, id = id] { return places_on_boundary(triangulation, id); });
    for (const auto *datum : {&scene.axial_force, &scene.axial_strain})
      if (*datum)
        add(**datum, [] { return std::vector<Point<dim>>(1); });
    if (scene.body_force)
      for (unsigned int d = 0; d < dim; ++d)
        add((*scene.body_force)[d], in_body);
    if (scene.temperature)
      add(scene.temperature->value, in_body);
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(places_on_boundary);
  VISCOPLASTIC_INSTANTIATE(places_in_body);
  VISCOPLASTIC_INSTANTIATE(values_at);
  VISCOPLASTIC_INSTANTIATE(data_in_time);
} // namespace Viscoplastic
