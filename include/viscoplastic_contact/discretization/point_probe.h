// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>

#include <array>
#include <vector>

namespace Viscoplastic
{
  /// The displacement at one point of the body, on the present mesh.
  template <int dim>
  class PointProbe
  {
  public:
    /// If @p x is not in the body, the nearest place in it is taken, as where
    /// finer meshes follow a curved boundary better. Collective.
    PointProbe(const AdmissibleSpace<dim> &space, const Point<dim> &x);

    /// Return the displacement at the point. Collective.
    Tensor<1, dim>
    value(const DistributedVector &ghosted_u) const
    {
      Tensor<1, dim> result;
      if (is_mine)
        for (unsigned int v = 0; v < n_vertices; ++v)
          for (unsigned int d = 0; d < dim; ++d)
            result[d] += shape_values[v] * ghosted_u.begin()[nodes[v] + d];
      return Utilities::MPI::sum(result, communicator);
    }

    /// Add the nodal forces of a force at the point to @p cartesian, a vector
    /// in the order of AdmissibleSpace::relevant.
    void
    add_force(const Tensor<1, dim> &force, std::vector<double> &cartesian) const
    {
      if (is_mine)
        for (unsigned int v = 0; v < n_vertices; ++v)
          for (unsigned int d = 0; d < dim; ++d)
            cartesian[nodes[v] + d] += shape_values[v] * force[d];
    }

  private:
    static constexpr unsigned int n_vertices =
      GeometryInfo<dim>::vertices_per_cell;

    MPI_Comm communicator;
    /// Whether the point is in an owned cell of this rank (one rank only).
    bool                                is_mine = false;
    std::array<std::size_t, n_vertices> nodes;
    std::array<double, n_vertices>      shape_values;
  };
} // namespace Viscoplastic
