// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/bulk_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>
#include <viscoplastic_contact/parameters/choices.h>

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
    /// The meshes that the present one has come from.
    std::function<NodeHierarchy()> hierarchy;
    /// The restriction to the friction face, which is empty without friction.
    const FaceRestriction &face;
  };


  /// What decides on the solver of a system.
  struct SolverDemand
  {
    LinearSolver choice = LinearSolver::automatic;
    /// The largest Poisson's ratio of the material that the matrix stands for.
    double max_poissons_ratio = 0.;
    /// How often the solver will be used at least.
    unsigned int n_solves = 1;
    /// Degrees of freedom of the mesh that the present one is refined from; 0
    /// where it is not refined.
    types::global_dof_index n_first_dofs = 0;
  };


  enum class BulkSolverKind
  {
    direct,
    geometric_multigrid,
    algebraic_multigrid
  };

  /**
   * The solver that make_bulk_solver() would take for a system with @p n_dofs
   * degrees of freedom in @p dim dimensions, @p n_face_dofs of them on the
   * face. Throws ExcMessage for a choice that cannot be had.
   */
  BulkSolverKind
  choose_bulk_solver(const SolverDemand           &demand,
                     const unsigned int            dim,
                     const types::global_dof_index n_dofs,
                     const unsigned int            n_face_dofs,
                     const MPI_Comm                communicator);


  /// Choose and set up a solver. Throws ExcMessage for a choice that cannot be
  /// had. Collective.
  std::unique_ptr<BulkSolver>
  make_bulk_solver(const BulkSystem &system, const SolverDemand &demand);
} // namespace Viscoplastic
