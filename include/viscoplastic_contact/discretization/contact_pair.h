// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/surface_normals.h>
#include <viscoplastic_contact/scene/scene.h>

namespace Viscoplastic
{
  /// Two boundaries in contact with each other. Multipliers belong to the nodes
  /// of the secondary one, whose outward normal this is; where it is curved,
  /// there are normals at the nodes of both instead. Faces of materials that
  /// are absent belong to neither.
  template <int dim>
  struct ContactPair
  {
    types::boundary_id         secondary, primary;
    Tensor<1, dim>             normal;
    const SurfaceNormals<dim> *normals;
    const Scene<dim>          &scene;
    /// Whether it is the pair of the absent faces of the secondary side with
    /// all of the primary one, which they follow until they come.
    bool of_absent = false;
  };
} // namespace Viscoplastic
