// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>

#include <ostream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // What --check tells of the data of a scene, so that a slip in a unit is seen
  // before the run.

  /// The largest stress that the data of a scene give, and which of them.
  struct LargestStress
  {
    double      value = 0.;
    std::string origin;
    /// Whether it is a load; not of friction bounds.
    bool is_load = false;
    /// Its time: of a thermal stress that of the highest temperature.
    double t = 0.;
  };

  /// From the initial stress, tractions, pressures and normal stresses, the
  /// body force times the size of the body, prescribed displacements times
  /// Young's modulus over that size; where there is none of these, from
  /// friction bounds. Of places and times that stand for all. Collective.
  template <int dim>
  LargestStress
  largest_given_stress(const Discretization<dim> &discretization);

  /// A line for each material: elastic moduli, law with its parameters, and how
  /// fast that law relaxes a uniaxial stress sigma of the size of @p stress,
  /// |sigma|/|G|, and 2/r there of what is added later. Collective.
  template <int dim>
  void
  describe_materials(const Discretization<dim> &discretization,
                     const LargestStress       &stress,
                     std::ostream              &out);

  /// Sentences about a material that has been left at its defaults although the
  /// scene has loads, and, where units are declared, about one that is powers
  /// of ten away from all known ones, or that loads would strain far beyond
  /// small strains. Collective.
  template <int dim>
  std::vector<std::string>
  implausible_data(const Discretization<dim> &discretization,
                   const LargestStress       &stress);
} // namespace Viscoplastic
