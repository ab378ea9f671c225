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
  /// The matrix of a step on one mesh, with what solvers have to know of its
  /// unknowns. All references stay in use.
  struct BulkSystem
  {
    unsigned int             dim; // degrees of freedom a node
    const DistributedMatrix &matrix;
    /// Owned degrees of freedom that are no unknowns.
    const std::vector<bool> &excluded;
    /// The rigid body modes on owned entries, zero where excluded.
    std::function<std::vector<DistributedVector>()> rigid_body_modes;
    /// Makes the hierarchy of meshes for geometric multigrid.
    std::function<NodeHierarchy()> hierarchy;
    /// The restriction to the contact face; empty without contact points.
    const FaceRestriction &face;
    /// The number of owned degrees of freedom, last in the numbering, that
    /// belong to no node of the mesh.
    unsigned int n_beyond_mesh = 0;
  };


  /// Choose and set up a solver for the matrix of @p system. Of @p demand only
  /// what the system itself does not tell counts (choice, expected number of
  /// solves). Throws ExcMessage for a choice that cannot be had. Collective.
  std::unique_ptr<BulkSolver>
  make_bulk_solver(const BulkSystem &system, SolverDemand demand);
} // namespace Viscoplastic
