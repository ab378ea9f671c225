// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/scene/scene.h>

namespace Viscoplastic
{
  /// Whether full integration may lock: with laws whose flow is deviatoric, or
  /// where the largest Poisson's ratio is @p max_nu > 0.4.
  template <int dim>
  bool
  may_lock(const Scene<dim> &scene, const double max_nu);

  /// Whether the volumetric strain is the mean over each cell: as the scene
  /// says, or by what `automatic' stands for where the largest Poisson's ratio
  /// is @p max_nu.
  template <int dim>
  bool
  uses_mean_dilatation(const Scene<dim> &scene, const double max_nu);
} // namespace Viscoplastic
