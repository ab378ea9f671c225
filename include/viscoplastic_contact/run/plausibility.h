// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>

#include <ostream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // Plausibility checks of the data by --check, to find wrong units before a
  // run.

  /// The largest stress that the data of a scene impose, and its origin.
  struct LargestStress
  {
    double      value = 0.;
    std::string origin;
    /// Whether a load causes the stress, rather than a friction bound.
    bool is_load = false;
    /// The time of the highest temperature, for a thermal stress; else 0.
    double t = 0.;
  };

  /// Return the largest of initial stress, tractions, pressures, normal
  /// stresses, body force times size of the body, prescribed displacements
  /// times Young's modulus over size, and thermal stress; if all are zero, the
  /// largest friction bound. Data are sampled in space and time. Collective.
  template <int dim>
  LargestStress
  largest_given_stress(const Discretization<dim> &discretization);

  /// Print a line for each material: elastic moduli, law with parameters, the
  /// time |sigma|/|G| in which the law relaxes a uniaxial stress of the size of
  /// @p stress, and, if the material is added later, the limit 2/r. Collective.
  template <int dim>
  void
  describe_materials(const Discretization<dim> &discretization,
                     const LargestStress       &stress,
                     std::ostream              &out);

  /// Return sentences about materials with default moduli in scenes with loads,
  /// contact that cannot balance the loads, large friction coefficients and
  /// overlaps, and, if units are declared, materials powers of ten off all
  /// known ones and loads with large strains. Collective.
  template <int dim>
  std::vector<std::string>
  implausible_data(const Discretization<dim> &discretization,
                   const LargestStress       &stress);
} // namespace Viscoplastic
