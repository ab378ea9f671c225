// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>

#include <viscoplastic_contact/mesh/plane_model.h>

#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace Viscoplastic
{
  /// Numbers the shapes of cells. Cells have the same shape if they differ by a
  /// translation, for bodies of revolution by a translation along the axis.
  template <int dim>
  class CellShapes
  {
  public:
    explicit CellShapes(const PlaneModel model)
      : is_of_ring(model == PlaneModel::axisymmetric)
    {}

    /// Return the number of the shape of a cell, and whether it is new.
    std::pair<unsigned int, bool>
    add(const typename DoFHandler<dim>::active_cell_iterator &cell);

  private:
    static constexpr unsigned int key_size =
      dim * (GeometryInfo<dim>::vertices_per_cell - 1) + 3;

    const bool                                                 is_of_ring;
    std::map<std::array<std::int64_t, key_size>, unsigned int> number_of;
  };
} // namespace Viscoplastic
