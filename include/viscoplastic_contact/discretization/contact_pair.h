// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/surface_normals.h>
#include <viscoplastic_contact/mesh/plane_model.h>

namespace Viscoplastic
{
  /// Two boundaries in contact with each other. Multipliers belong to the nodes
  /// of the secondary one, whose outward normal this is; where it is curved,
  /// there are normals at the nodes of both instead.
  template <int dim>
  struct ContactPair
  {
    types::boundary_id         secondary, primary;
    Tensor<1, dim>             normal;
    const SurfaceNormals<dim> *normals     = nullptr;
    PlaneModel                 plane_model = PlaneModel::strain;
  };
} // namespace Viscoplastic
