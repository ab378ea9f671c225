// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/error/evaluated_state.h>

namespace Viscoplastic
{
  /// The variation of data within a time step that the values at its ends do
  /// not show.
  struct Swing
  {
    /// The variation relative to the forces or the displacement of the body,
    /// and its effect in the energy norm.
    double share = 0., energy_norm = 0.;
  };

  /// Return by how much data, at the quarters of a step, lie outside the range
  /// of their values at its ends. Slipping points remember that, and a creeping
  /// body the part that relaxes in the step. Loads and friction bounds, with
  /// the pressure at the beginning, count relative to the forces of the body;
  /// prescribed displacements, gaps and motions of foundations relative to its
  /// largest displacement, the latter with at most the work of friction.
  ///
  /// Zero if each datum is monotone in the step and no vector turns by more
  /// than half a circle, of second order if a datum turns back; nothing is
  /// evaluated for data that do not depend on time. Collective.
  template <int dim>
  Swing
  swing_of_data(const Discretization<dim> &discretization,
                const EvaluatedState<dim> &accepted,
                const EvaluatedState<dim> &end);
} // namespace Viscoplastic
