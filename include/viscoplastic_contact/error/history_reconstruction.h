// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/stress_space.h>

namespace Viscoplastic
{
  /// z and sigma as cells should pass them on to their children.
  ///
  /// In a bilinear displacement a strain varies across its own direction only,
  /// and the history follows it: between cells z jumps by what is missing.
  /// Children that inherit these jumps keep them, since what has crept stays,
  /// and no mesh mends that; they would be refined along the edges of cells
  /// that have long gone. But means of cells are more accurate than what varies
  /// within them, so that the slopes of z in a cell follow from the means of
  /// its neighbors in the same material, by least squares. The mean of a cell
  /// stays, and so does a slope in whose direction there is no neighbor.
  ///
  /// sigma goes the same way, but by |sigma|/|z| only where that is less than
  /// one: in long creep the stress has relaxed to what makes strains of the
  /// present mesh flow, and one that is smoother would begin with a fast
  /// transient.
  struct HistoryReconstruction
  {
    /// Reconstructed z and stress at the samples of all owned cells; if samples
    /// are cell means, at the centers of the children that the cells would
    /// have.
    IrreversibleStress z, stress;
    /// What is wrong in z in each active cell, (int E^-1 e : e), zero on cells
    /// of other ranks. As it was, e is what the slopes have changed;
    /// with the new ones it is estimated by the jumps to the neighbors that are
    /// left. The way with the smaller error has been taken.
    Vector<double> squared_error;
  };

  /// @p z and @p stress (sigma_h), which gets slopes where z does, at the
  /// samples of owned cells. Collective.
  template <int dim>
  HistoryReconstruction
  reconstruct_history(const StressSpace<dim>   &stress_space,
                      const IrreversibleStress &z,
                      const IrreversibleStress &stress);
} // namespace Viscoplastic
