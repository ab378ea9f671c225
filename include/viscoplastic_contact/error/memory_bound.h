// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>

namespace Viscoplastic
{
  /// Return the largest number of cells for which a run is expected to take at
  /// most @p bytes on all ranks together: the program itself, mesh and spaces,
  /// and expected_memory() of the linear solver chosen for such a mesh. Numbers
  /// of unknowns in the body and on the contact face are scaled from @p
  /// present.
  template <int dim>
  unsigned int
  cells_in_memory(const Discretization<dim> &present, const double bytes);
} // namespace Viscoplastic
