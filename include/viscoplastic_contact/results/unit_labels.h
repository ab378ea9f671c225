// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/scene/scene.h>

#include <string>

namespace Viscoplastic
{
  /// What the results of a scene have behind the names of columns and fields:
  /// " [MPa]", or nothing where the scene declares no units.
  template <int dim>
  class UnitLabels
  {
  public:
    explicit UnitLabels(const Scene<dim> &scene)
      : scene(scene)
    {}

    /// Of a column of statistics.csv.
    std::string
    of_column(const std::string &name) const;

    /// Of a field of the body or of the contact face.
    std::string
    of_field(const std::string &name) const;

  private:
    /// The estimates of cells are a root of energies, or of the quantity of
    /// interest, which may be anything.
    Quantity
    of_estimator() const;

    const Scene<dim> &scene;
  };
} // namespace Viscoplastic
