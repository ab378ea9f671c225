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

  /// Return the rank that owns the active cell at a vertex of a cell, which may
  /// be refined and need not be known to this rank.
  template <int dim>
  unsigned int
  rank_at_vertex(const parallel::distributed::Triangulation<dim> &triangulation,
                 const CellId                                    &cell,
                 const unsigned int                               vertex);

  /// Refine a mesh to that of @p model with the same coarse cells. Collective.
  template <int dim>
  void
  refine_like(const parallel::distributed::Triangulation<dim> &model,
              parallel::distributed::Triangulation<dim>       &triangulation);

  /// Do what prepare_coarsening_and_refinement() does, but for the whole mesh,
  /// so that the flags do not depend on the partition. That function only sees
  /// the flags of owned cells: beside cells of other ranks, it keeps families
  /// that could be coarsened and refines cells needlessly. Collective.
  template <int dim>
  void
  prepare_mesh_change(parallel::distributed::Triangulation<dim> &triangulation);
} // namespace Viscoplastic
