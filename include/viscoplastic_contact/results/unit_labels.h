// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/scene/scene.h>

#include <string>

namespace Viscoplastic
{
  /// The physical quantity of a field of the body or of the contact face, or of
  /// one of its components, given its name; a pure number if it has no unit.
  Quantity
  quantity_of_field(const std::string &name);

  /// What an integral of a quantity over a boundary or a material is.
  Quantity
  integrated(const Quantity quantity, const bool is_of_boundary);

  /// The estimates of cells are a root of energies, or of the quantity of
  /// interest, which may be anything.
  template <int dim>
  Quantity
  quantity_of_estimator(const Scene<dim> &scene);

  /// What the results of a scene have behind the name of a field: " [MPa]", or
  /// nothing where the scene declares no units.
  template <int dim>
  std::string
  label_of_field(const Scene<dim> &scene, const std::string &name);
} // namespace Viscoplastic
