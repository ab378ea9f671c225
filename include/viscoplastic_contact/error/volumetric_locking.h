// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/error/local_cells.h>

namespace Viscoplastic
{
  /// The error of volumetric locking in the strain, in the energy norm.
  struct VolumetricLocking
  {
    /// The squared error of the elastic strain in each active cell; zero on
    /// cells of other ranks.
    Vector<double> squared_error;
    /// The error of the rate of irreversible strain.
    double rate;
  };

  /// Locking of full integration in what is nearly incompressible, or becomes
  /// so since it creeps without change of volume. A locked solution is smooth,
  /// and wrong: neither jumps of stresses nor those of strains show it.
  ///
  /// A cell that bends changes its volume at the quadrature points, which makes
  /// pressures p that vary around their mean in it and have no part in the
  /// solution. They carry loads that deviators should. Let curvatures extend
  /// over the length L, and p be K h times the curvature kappa of cells of
  /// width h, beside deviators 2 mu L kappa. Without p the moment that both
  /// make bends the body by e of
  ///
  ///     (3/2)^{1/2} (h'/L) |p|/(2 mu)^{1/2}
  ///
  /// in the energy norm, where h'/L is what deviators of strains vary by in
  /// cells relative to their size, as recovered strains tell (@p defect, the
  /// squared energy of their deviators' errors). Flow makes of p in each unit
  /// of time as much as a deviator s of its size, G'(sigma) s, with the
  /// tangents where it is largest in the cell. Collective.
  template <int dim>
  VolumetricLocking
  volumetric_locking(const LocalCells<dim> &cells,
                     const FlowLaws<dim>   &laws,
                     const State<dim>      &state,
                     const double           defect);
} // namespace Viscoplastic
