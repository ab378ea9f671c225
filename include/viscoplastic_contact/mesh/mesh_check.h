// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

namespace Viscoplastic
{
  using namespace dealii;

  /**
   * Whether the body is one, and no cell is inverted or degenerate. Collective.
   * Throws ExcMessage with a sentence for the user.
   */
  template <int dim>
  void
  check_mesh(const parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
