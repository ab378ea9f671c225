// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/scene/scene.h>

#include <string>

namespace Viscoplastic
{
  /// The physical quantity of a field of the body or of the boundary, or of one
  /// of its components, given its name; a pure number if it has no unit.
  Quantity
  quantity_of_field(const std::string &name);

  /// The quantity of cell-wise estimates: roots of energies or, for a quantity
  /// of interest, of any unit.
  template <int dim>
  Quantity
  quantity_of_estimator(const Scene<dim> &scene);

  /// The label after the name of a field in results: " [MPa]", or nothing if
  /// the scene declares no units.
  template <int dim>
  std::string
  label_of_field(const Scene<dim> &scene, const std::string &name);
} // namespace Viscoplastic
