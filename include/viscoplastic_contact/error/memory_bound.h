// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>

namespace Viscoplastic
{
  /// The largest number of cells with which a run on all ranks is expected to
  /// take no more than @p bytes: what the program itself takes, mesh and
  /// spaces, and expected_memory() of the solver that such a mesh gets. Scaled
  /// from
  /// @p present, the numbers of unknowns in the body and on the face of
  /// friction.
  template <int dim>
  unsigned int
  cells_in_memory(const Discretization<dim> &present, const double bytes);
} // namespace Viscoplastic
