// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

namespace Viscoplastic
{
  using namespace dealii;

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
