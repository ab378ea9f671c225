// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

namespace Viscoplastic
{
  using namespace dealii;

  /// The mean outward normal of the boundary faces with one id, which tells
  /// how far they are from a plane.
  template <int dim>
  struct PieceNormal
  {
    /// The outward normal of unit length; exact for pieces along coordinate
    /// planes.
    Tensor<1, dim> normal;
    /// The largest angle between it and the normals of the faces, in degrees.
    double deviation;
  };

  /// Return the mean normal of the boundary faces with this @p id, each
  /// weighted by its area. Where normals cancel, as all around a body, it is
  /// zero and the deviation 180. Collective.
  template <int dim>
  PieceNormal<dim>
  piece_normal(const parallel::distributed::Triangulation<dim> &triangulation,
               const types::boundary_id                         id);

  /// The largest angle between the normals of faces with this @p id that share
  /// a vertex, in degrees. Collective.
  template <int dim>
  double
  largest_angle(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id);

  /// Whether any face with this @p id looks, by its outward normal, into a @p
  /// direction. Collective.
  template <int dim>
  bool
  faces_towards(const parallel::distributed::Triangulation<dim> &triangulation,
                const types::boundary_id                         id,
                const Tensor<1, dim>                            &direction);
} // namespace Viscoplastic
