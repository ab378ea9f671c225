// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace Viscoplastic
{
  /// Return the active cells of a mesh (Triangulation or DoFHandler) that this
  /// rank owns: by coarse cells, with the descendants of a cell in succession.
  ///
  /// This order depends on the mesh alone. The order of active_cell_iterators()
  /// depends on the history of refinement: with it, sums would be rounded
  /// differently in a run that is restarted from a checkpoint.
  template <class Mesh>
  std::vector<typename Mesh::active_cell_iterator>
  owned_cells(const Mesh &mesh);

  /// Return the ghost cells, in the same order.
  template <class Mesh>
  std::vector<typename Mesh::active_cell_iterator>
  ghost_cells(const Mesh &mesh);
} // namespace Viscoplastic
