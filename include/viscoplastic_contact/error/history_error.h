// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/error/local_cells.h>

namespace Viscoplastic
{
  /// What z' = G by cell means leaves out in each unit of time,
  ///
  ///     (int E^-1 d : d)^{1/2},   d = G'(P0 sigma_h) (sigma_h - P0 sigma_h),
  ///
  /// with the derivative of G in the direction of what varies in a cell around
  /// its mean P0. That does not flow; in long creep it carries loads that it
  /// should not, which u_h does not show: the body as a whole is too stiff.
  /// Then it is large against the mean, and G itself there would say nothing.
  /// Collective.
  template <int dim>
  double
  cell_mean_defect(const LocalCells<dim> &cells,
                   const FlowLaws<dim>   &laws,
                   const State<dim>      &state);
} // namespace Viscoplastic
