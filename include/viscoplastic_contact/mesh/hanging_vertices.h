// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

namespace Viscoplastic
{
  using namespace dealii;

  /**
   * Where manifolds curve a mesh, let each hanging vertex stand in the middle
   * of the edge or face of the coarser cell, now and after all refinements to
   * come. A manifold puts it beside that edge or face, whose cell has straight
   * edges: the cells of both sides would overlap or leave a gap, and what is
   * continuous at nodes would not be so between them. Refinement itself starts
   * from the places that manifolds give. Does nothing without manifolds.
   * Collective.
   */
  template <int dim>
  void
  keep_hanging_vertices_on_coarser_cells(
    parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
