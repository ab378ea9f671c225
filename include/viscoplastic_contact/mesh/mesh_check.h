// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <functional>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// Check that no cell is inverted or degenerate, and that lengths are in the
  /// permitted range. Throws ExcMessage with a sentence for the user.
  /// Collective.
  template <int dim>
  void
  check_mesh(const parallel::distributed::Triangulation<dim> &triangulation);

  /// The parts of a mesh that are connected by faces.
  struct ConnectedParts
  {
    unsigned int n = 0;
    /// The part of each coarse cell, by CellId::get_coarse_cell_id(); parts are
    /// numbered in the order of their first cells.
    std::vector<unsigned int> of_cell;
  };

  /// Return the parts that the cells of some materials make; other cells belong
  /// to none. All ranks know the coarse mesh.
  template <int dim>
  ConnectedParts
  connected_parts(
    const Triangulation<dim>                            &triangulation,
    const std::function<bool(const types::material_id)> &is_present);

  /// Check that all cells belong to one body, connected by the faces that they
  /// share. Throws ExcMessage if not.
  template <int dim>
  void
  check_connection(
    const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
