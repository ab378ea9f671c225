// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/fe/mapping_q1.h>

#include <viscoplastic_contact/discretization/point_probe.h>

#include <sstream>

namespace Viscoplastic
{
  template <int dim>
  PointProbe<dim>::PointProbe(const AdmissibleSpace<dim> &space,
                              const Point<dim>           &x)
    : communicator(space.communicator)
  {
    const MappingQ1<dim> mapping;
    for (const auto &cell : space.cells)
      {
        if (!cell->bounding_box().point_inside(x, 1e-6))
          continue;
        Point<dim> unit;
        try
          {
            unit = mapping.transform_real_to_unit_cell(cell, x);
          }
        catch (const typename Mapping<dim>::ExcTransformationFailed &)
          {
            continue;
          }
        if (GeometryInfo<dim>::distance_to_unit_cell(unit) > 1e-8)
          continue;
        is_mine = true;
        for (const unsigned int v : cell->vertex_indices())
          {
            nodes[v] =
              space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
            shape_values[v] =
              GeometryInfo<dim>::d_linear_shape_function(unit, v);
          }
        break;
      }
    // A point between the cells of several ranks belongs to the first.
    const unsigned int me   = Utilities::MPI::this_mpi_process(communicator);
    const unsigned int none = Utilities::MPI::n_mpi_processes(communicator);
    const unsigned int owner =
      Utilities::MPI::min(is_mine ? me : none, communicator);
    if (owner == none)
      {
        std::ostringstream message;
        message << "'Output/Points': the point (" << x
                << ") does not lie in the body.";
        AssertThrow(false, ExcMessage(message.str()));
      }
    is_mine = owner == me;
  }



  template <int dim>
  Tensor<1, dim>
  PointProbe<dim>::value(const DistributedVector &ghosted_u) const
  {
    Tensor<1, dim> result;
    if (is_mine)
      for (unsigned int v = 0; v < n_vertices; ++v)
        for (unsigned int d = 0; d < dim; ++d)
          result[d] += shape_values[v] * ghosted_u.begin()[nodes[v] + d];
    return Utilities::MPI::sum(result, communicator);
  }



  template <int dim>
  void
  PointProbe<dim>::add_force(const Tensor<1, dim> &force,
                             std::vector<double>  &cartesian) const
  {
    if (is_mine)
      for (unsigned int v = 0; v < n_vertices; ++v)
        for (unsigned int d = 0; d < dim; ++d)
          cartesian[nodes[v] + d] += shape_values[v] * force[d];
  }



  template class PointProbe<2>;
  template class PointProbe<3>;
} // namespace Viscoplastic
