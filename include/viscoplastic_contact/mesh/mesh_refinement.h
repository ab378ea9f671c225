// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  /// Refine the mesh as `Geometry/Global refinements' and `Boundary
  /// refinements' say. Collective. Throws ExcMessage with a sentence for the
  /// user.
  template <int dim>
  void
  refine_mesh(const GeometryParameters                  &geometry,
              parallel::distributed::Triangulation<dim> &triangulation);

  /// The rank that owns the active cell at a vertex of a cell, which may be
  /// refined and need not be known here.
  template <int dim>
  unsigned int
  rank_at_vertex(const parallel::distributed::Triangulation<dim> &triangulation,
                 const CellId                                    &cell,
                 const unsigned int                               vertex);

  /// Make a mesh that of another one with the same coarse cells. Collective.
  template <int dim>
  void
  refine_like(const parallel::distributed::Triangulation<dim> &model,
              parallel::distributed::Triangulation<dim>       &triangulation);

  /// prepare_coarsening_and_refinement() for the whole mesh: the flags that a
  /// balanced mesh asks for, whatever part each rank has. deal.II's own looks
  /// at the flags of owned cells alone: beside the cells of another rank a
  /// family stays that could go with them, and cells are refined unasked.
  /// Collective.
  template <int dim>
  void
  prepare_mesh_change(parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
