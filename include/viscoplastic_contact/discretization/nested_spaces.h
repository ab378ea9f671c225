// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

namespace Viscoplastic
{
  /// The meshes that p4est has refined into the present one, as multigrid needs
  /// them. Collective.
  template <int dim>
  NodeHierarchy
  make_node_hierarchy(const AdmissibleSpace<dim> &space);
} // namespace Viscoplastic
