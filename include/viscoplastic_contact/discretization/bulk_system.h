// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver_factory.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

namespace Viscoplastic
{
  /// Return the hierarchy of nodes on the meshes that p4est has refined into
  /// the present one, for multigrid. Collective.
  template <int dim>
  NodeHierarchy
  make_node_hierarchy(const AdmissibleSpace<dim> &space);

  /// Return the matrix and the unknowns of a space, for linear solvers;
  /// references all arguments.
  template <int dim>
  BulkSystem
  make_bulk_system(const AdmissibleSpace<dim> &space,
                   const DistributedMatrix    &matrix,
                   const FaceRestriction      &face)
  {
    return {dim,
            matrix,
            space.excluded(),
            [&space] { return space.rigid_body_modes(); },
            [&space] { return make_node_hierarchy(space); },
            face,
            space.owned_axial() ? dim : 0u};
  }
} // namespace Viscoplastic
