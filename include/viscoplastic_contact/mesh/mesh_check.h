// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

namespace Viscoplastic
{
  using namespace dealii;

  /**
   * Check that the body is connected, that no cell is inverted or degenerate,
   * and that lengths can be computed with. Collective. Throws ExcMessage with a
   * sentence for the user if not.
   */
  template <int dim>
  void
  check_mesh(const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
