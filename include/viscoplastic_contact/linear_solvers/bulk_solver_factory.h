// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/bulk_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>
#include <viscoplastic_contact/linear_solvers/solver_choice.h>

#include <functional>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// The matrix of a step on one mesh, with the properties of its unknowns that
  /// solvers need. Keeps references.
  struct BulkSystem
  {
    unsigned int             dim; // degrees of freedom a node
    const DistributedMatrix &matrix;
    /// Owned degrees of freedom that are no unknowns.
    const std::vector<bool> &excluded;
    /// The rigid body modes on owned entries, zero where excluded.
    std::function<std::vector<DistributedVector>()> rigid_body_modes;
    /// Returns the hierarchy of meshes for geometric multigrid.
    std::function<NodeHierarchy()> hierarchy;
    /// The restriction to the contact face; empty without contact points.
    const FaceRestriction &face;
    /// The number of owned degrees of freedom, the last, without a mesh node.
    unsigned int n_beyond_mesh = 0;
  };


  /// Choose and set up a solver for @p system. Of @p demand only data that the
  /// system does not contain are used (choice, expected number of solves).
  /// Throws ExcMessage if the choice is not available. Collective.
  std::unique_ptr<BulkSolver>
  make_bulk_solver(const BulkSystem &system, SolverDemand demand);
} // namespace Viscoplastic
