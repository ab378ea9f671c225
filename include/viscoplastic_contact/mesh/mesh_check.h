// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

namespace Viscoplastic
{
  using namespace dealii;

  /// Check that no cell is inverted or degenerate, and that lengths are in the
  /// permitted range. Throws ExcMessage with a sentence for the user.
  /// Collective.
  template <int dim>
  void
  check_mesh(const parallel::distributed::Triangulation<dim> &triangulation);

  /// Check that all cells belong to one body, connected by the faces that they
  /// share. Throws ExcMessage if not.
  template <int dim>
  void
  check_connection(
    const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
