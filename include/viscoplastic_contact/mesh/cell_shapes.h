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
  /// Numbers for the shapes of cells: the same for cells that differ by a
  /// translation, on sections of rings by one along the axis.
  template <int dim>
  class CellShapes
  {
  public:
    explicit CellShapes(const PlaneModel model)
      : is_of_ring(model == PlaneModel::axisymmetric)
    {}

    /// The number of a cell's shape, and whether it is new.
    std::pair<unsigned int, bool>
    add(const typename DoFHandler<dim>::active_cell_iterator &cell);

  private:
    static constexpr unsigned int key_size =
      dim * (GeometryInfo<dim>::vertices_per_cell - 1) + 3;

    const bool                                                 is_of_ring;
    std::map<std::array<std::int64_t, key_size>, unsigned int> number_of;
  };
} // namespace Viscoplastic
