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

  /// How far data are, at the quarters of a step, from all that is between
  /// their values at its ends. Points that slip meanwhile remember it, and a
  /// body that creeps the part that relaxes in the step. Loads and friction
  /// bounds, those of the pressure at the beginning, count as a part of the
  /// forces of the body; prescribed displacements, gaps and motions of
  /// foundations as a part of its largest displacement, motions with the work
  /// of friction on them at most.
  ///
  /// Zero, and with data that do not depend on time for nothing, where each
  /// datum rises or falls all along the step and no vector turns by more than
  /// half a circle; of second order where a datum turns back.
  /// Collective.
  template <int dim>
  Swing
  swing_of_data(const Discretization<dim> &discretization,
                const EvaluatedState<dim> &accepted,
                const EvaluatedState<dim> &end);
} // namespace Viscoplastic
