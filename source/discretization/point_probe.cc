// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/point_probe.h>
#include <viscoplastic_contact/mesh/point_location.h>

namespace Viscoplastic
{
  template <int dim>
  PointProbe<dim>::PointProbe(const AdmissibleSpace<dim> &space,
                              const Point<dim>           &x)
    : communicator(space.communicator)
  {
    const CellPoint<dim> place =
      locate_points(space.dof_handler.get_triangulation(),
                    {x},
                    [&space](const types::material_id id) {
                      return space.scene.is_present(id);
                    })
        .points[0];
    is_mine = place.is_mine();
    if (!is_mine)
      return;
    const auto &cell = space.cells[place.cell];
    for (const unsigned int v : cell->vertex_indices())
      {
        nodes[v] =
          space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
        shape_values[v] =
          GeometryInfo<dim>::d_linear_shape_function(place.unit, v);
      }
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(PointProbe);
} // namespace Viscoplastic
