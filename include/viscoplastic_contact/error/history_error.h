// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/error/local_cells.h>

namespace Viscoplastic
{
  /// Return the error per unit of time by evaluating z' = G at cell means,
  ///
  ///     (int E^-1 d : d)^{1/2},   d = G'(P0 sigma_h) (sigma_h - P0 sigma_h),
  ///
  /// where P0 takes cell means. The variation of the stress in a cell does not
  /// flow; in long creep it carries loads that should relax, and the body as a
  /// whole is too stiff, which u_h does not show. G' is used since the
  /// variation is then large against the mean, where G itself says nothing.
  /// Collective.
  template <int dim>
  double
  cell_mean_defect(const LocalCells<dim> &cells,
                   const FlowLaws<dim>   &laws,
                   const State<dim>      &state);
} // namespace Viscoplastic
