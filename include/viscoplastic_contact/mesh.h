// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/parameters.h>

#include <set>
#include <string>

namespace Viscoplastic
{
  /**
   * The mesh of a scene before any adaptation: from a generator or a file, with
   * ids by expression, moved, checked and refined. Collective. Throws
   * ExcMessage with a sentence for the user.
   */
  template <int dim>
  void
  make_mesh(const GeometryParameters                  &geometry,
            parallel::distributed::Triangulation<dim> &triangulation);

  /// The ids of the coarse mesh, the same on all ranks. Collective.
  template <int dim>
  std::set<types::boundary_id>
  boundary_ids(const parallel::distributed::Triangulation<dim> &triangulation);

  template <int dim>
  std::set<types::material_id>
  material_ids(const parallel::distributed::Triangulation<dim> &triangulation);


  /// The mean outward normal of a boundary piece, and how far it is from flat.
  template <int dim>
  struct PieceNormal
  {
    /// Of unit length; exact for pieces along coordinate planes.
    Tensor<1, dim> normal;
    /// The largest angle between it and a face's normal, in degrees.
    double deviation;
  };

  /// Collective.
  template <int dim>
  PieceNormal<dim>
  piece_normal(const parallel::distributed::Triangulation<dim> &triangulation,
               const types::boundary_id                         id);
} // namespace Viscoplastic
