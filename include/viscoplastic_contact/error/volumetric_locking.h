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

  /// Estimate the locking of full integration in bodies that are nearly
  /// incompressible or creep without change of volume. A locked solution is
  /// smooth and wrong: neither jumps of stresses nor of strains show it.
  ///
  /// A cell that bends changes its volume at the quadrature points. This makes
  /// spurious pressures p that vary around their cell mean and carry loads that
  /// deviators should. In cells of width h and curvature kappa, p is about K h
  /// kappa beside deviators 2 mu L kappa, if curvatures extend over the length
  /// L. Without p, the same moment would bend the body more, by e of
  ///
  ///     (5/2)^{1/2} (h'/L) |p|/(2 mu)^{1/2}
  ///
  /// in the energy norm. h'/L is the variation of strain deviators in cells
  /// relative to their size, from recovered strains (@p defect: the squared
  /// energy of their deviators' errors). The rate is that of deviators s of the
  /// size of p, G'(sigma) s per unit of time, with the tangents at the largest
  /// p in the cell. @p strains: those of the owned cells. Collective.
  template <int dim>
  VolumetricLocking
  volumetric_locking(
    const LocalCells<dim>                                &cells,
    const std::vector<typename LocalCells<dim>::Strains> &strains,
    const FlowLaws<dim>                                  &laws,
    const State<dim>                                     &state,
    const double                                          defect);
} // namespace Viscoplastic
