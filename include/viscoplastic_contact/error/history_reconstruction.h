// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/stress_space.h>

namespace Viscoplastic
{
  /// z and sigma with reconstructed slopes, for the children of refined cells.
  ///
  /// The strains of a bilinear displacement lack the variation along their own
  /// direction, and so does the irreversible stress z: it jumps between cells.
  /// Children that inherit these jumps keep them, since creep does not revert,
  /// and the mesh would be refined along edges of former cells. Cell means are
  /// more accurate than variations within cells. Therefore the slopes of z in a
  /// cell are fitted by least squares to the means of its neighbors of the same
  /// material. The mean of a cell stays, and so does a slope in whose direction
  /// there is no neighbor.
  ///
  /// The correction of sigma is scaled by |sigma|/|z| where that is below one:
  /// in long creep the stress has relaxed to one that makes strains of the
  /// present mesh flow, and a smoother one would begin with a fast transient.
  struct HistoryReconstruction
  {
    /// Reconstructed z and stress at the samples of all owned cells; if samples
    /// are cell means, at the centers of the children that the cells would
    /// have.
    IrreversibleStress z, stress;
    /// The squared error int E^-1 e : e of z by active cell, zero on cells of
    /// other ranks. For old slopes, e is their correction; for new ones it is
    /// estimated by the remaining jumps between neighbors. A cell gets the
    /// slopes with the smaller error.
    Vector<double> squared_error;
  };

  /// Reconstruct @p z and @p stress (sigma_h) from samples of owned cells; the
  /// stress gets new slopes in the cells in which z does. Collective.
  template <int dim>
  HistoryReconstruction
  reconstruct_history(const StressSpace<dim>   &stress_space,
                      const IrreversibleStress &z,
                      const IrreversibleStress &stress);
} // namespace Viscoplastic
