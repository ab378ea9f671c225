// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/choices.h>

#include <cstdint>
#include <string>

namespace Viscoplastic
{
  // Which linear solver a scene gets, and what it is expected to cost. Pure
  // functions of numbers.

  enum class BulkSolverKind
  {
    direct,
    geometric_multigrid,
    algebraic_multigrid
  };

  /// The name of a solver in the tables of refinement studies.
  std::string
  to_string(const BulkSolverKind kind);


  /// The sizes and properties of a system from which choose_bulk_solver()
  /// selects a direct or an iterative solver.
  struct SolverDemand
  {
    LinearSolver choice = LinearSolver::automatic;
    unsigned int dim = 2, n_ranks = 1;
    /// The largest Poisson's ratio of the material that the matrix stands for.
    double max_poissons_ratio = 0.;
    /// The least number of solves with one matrix, and the number of solves in
    /// a time step.
    unsigned int n_solves = 1, solves_per_step = 1;
    /// Degrees of freedom in total and on the contact face; 64 bits, since cost
    /// models go beyond dealii::types::global_dof_index.
    std::uint64_t n_dofs = 0, n_face_dofs = 0;
    bool          has_friction = false;
    /// The number of unknowns of the mesh that the present one is refined from;
    /// 0 where it is not refined.
    std::uint64_t n_first_dofs = 0;
  };


  /// Whether the mesh is refined from a small one, on which a direct solver
  /// costs little compared with a multigrid cycle on the present one.
  bool
  has_small_first_mesh(const SolverDemand &demand);


  /// The solver for a demand. Throws ExcMessage for a choice that cannot be
  /// had.
  BulkSolverKind
  choose_bulk_solver(const SolverDemand &demand);


  /// Seconds of one set-up, with all other work on a new mesh, and of a step.
  struct SolverCost
  {
    double set_up, step;
  };

  /// The expected cost of a solver: powers of the number of degrees of freedom,
  /// fitted to measurements by benchmarks/step_cost.py and
  /// benchmarks/new_mesh.py. Only ratios mean anything on other machines and in
  /// other scenes.
  SolverCost
  expected_cost(const BulkSolverKind kind, const SolverDemand &demand);


  /// The expected seconds of @p n_steps steps: those of one core, divided by
  /// the number of ranks. True while these have `dofs_worth_a_rank' each.
  double
  expected_seconds(SolverDemand       demand,
                   const double       n_steps,
                   const unsigned int n_ranks);

  /// Degrees of freedom of a rank with which it is worth its core, and those
  /// with fewer of which it loses by waiting for others: what follows from
  /// counted messages (benchmarks/results.md, Prediction).
  constexpr unsigned int dofs_worth_a_rank = 20000, least_dofs_of_rank = 1000;


  /// Bytes of the matrix per degree of freedom: a node has 5 (2D) or 14 (3D)
  /// blocks on and above the diagonal, each with a column number of 4 bytes.
  constexpr double
  matrix_bytes(const unsigned int dim)
  {
    return (dim == 2 ? 5. : 14.) * (8. * dim * dim + 4.) / dim;
  }


  /// Memory in bytes that matrix, solver and vectors take beyond mesh and
  /// spaces: fitted to measurements (doc/solvers.md), good to a factor of 1.5
  /// or so.
  double
  expected_memory(const BulkSolverKind kind, const SolverDemand &demand);
} // namespace Viscoplastic
