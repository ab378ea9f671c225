// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace Viscoplastic
{
  /// The active cells of a mesh, a Triangulation or a DoFHandler, that this
  /// rank owns: one coarse cell after the other, and the children of a cell one
  /// after the other.
  ///
  /// This order is a function of the mesh alone. The one of
  /// active_cell_iterators() depends on how the mesh came about; with it sums
  /// would be rounded otherwise in a run that goes on from a checkpoint.
  template <class Mesh>
  std::vector<typename Mesh::active_cell_iterator>
  owned_cells(const Mesh &mesh);

  /// The ghost cells, in the same order.
  template <class Mesh>
  std::vector<typename Mesh::active_cell_iterator>
  ghost_cells(const Mesh &mesh);
} // namespace Viscoplastic
