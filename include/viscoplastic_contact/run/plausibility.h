// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>

#include <ostream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Print a line for each material, so that wrong units show before a run:
  /// elastic moduli, law with parameters, and the time |sigma|/|G| in which the
  /// law relaxes the largest stress that the data of the scene impose. That is
  /// the largest of initial stress, tractions, pressures, normal stresses, body
  /// force times size of the body, prescribed displacements times Young's
  /// modulus over size, and thermal stress; without those, the largest friction
  /// bound.
  ///
  /// Return sentences about materials with default moduli in scenes with loads,
  /// foundations that only withdraw, and contact that cannot balance the loads;
  /// if units are declared, also about moduli beyond those of all materials,
  /// stress that relaxes at once, and large strains. Collective.
  template <int dim>
  std::vector<std::string>
  implausible_data(const Discretization<dim> &discretization,
                   std::ostream              &out);
} // namespace Viscoplastic
