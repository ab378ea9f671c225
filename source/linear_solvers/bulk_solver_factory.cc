// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver_factory.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

#include <algorithm>

namespace Viscoplastic
{
  namespace
  {
    /**
     * Whether the direct solver is expected to win. A factorization costs about
     * ten (2D) to eighty (3D) of its own solves and, in 3D, much memory;
     * multigrid is cheap to set up and needs no memory to speak of, but dies of
     * incompressibility.
     */
    bool
    prefer_direct(const unsigned int            dim,
                  const types::global_dof_index n_dofs,
                  const unsigned int            n_face_dofs,
                  const double                  max_poissons_ratio,
                  const unsigned int            n_solves)
    {
      // The dense face problem: 200 MB and a cubic set-up.
      if (n_face_dofs > 5000)
        return false;
      if (dim == 2)
        return n_dofs < 2000000;
      if (max_poissons_ratio > 0.45)
        return n_dofs < 200000;
      return n_dofs < 20000 || (n_dofs < 150000 && n_solves >= 20);
    }
    /// Whether there are coarser meshes. The first one is solved on directly,
    /// whenever its stick set changes: that must be little against a cycle on
    /// the present one.
    bool
    has_small_first_mesh(const BulkSystem    &system,
                         const NodeHierarchy &hierarchy)
    {
      if (hierarchy.n_levels < 2)
        return false;
      const NodeHierarchy::Node n     = system.dim * hierarchy.n_first,
                                share = system.matrix.m() / 100;
      return system.dim == 2 ?
               n <= std::max(NodeHierarchy::Node(2000),
                             std::min(share, NodeHierarchy::Node(10000))) :
               n <= std::max(NodeHierarchy::Node(600),
                             std::min(share, NodeHierarchy::Node(3000)));
    }



    std::unique_ptr<Preconditioner>
    make_preconditioner(const BulkSystem &system, const LinearSolver choice)
    {
      if (choice != LinearSolver::algebraic_multigrid)
        {
          NodeHierarchy hierarchy = system.hierarchy();
          if (has_small_first_mesh(system, hierarchy))
            {
              if (system.dim == 2)
                return std::make_unique<GeometricMultigrid<2>>(system.matrix,
                                                               system.excluded,
                                                               std::move(
                                                                 hierarchy),
                                                               system.face);
              return std::make_unique<GeometricMultigrid<3>>(system.matrix,
                                                             system.excluded,
                                                             std::move(
                                                               hierarchy),
                                                             system.face);
            }
        }
      return std::make_unique<AlgebraicMultigrid>(system.matrix,
                                                  system.excluded,
                                                  system.rigid_body_modes(),
                                                  system.face,
                                                  system.dim);
    }
  } // namespace



  bool
  is_direct(const SolverDemand           &demand,
            const unsigned int            dim,
            const types::global_dof_index n_dofs,
            const unsigned int            n_face_dofs,
            const MPI_Comm                communicator)
  {
    const LinearSolver choice  = demand.choice;
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    AssertThrow(choice != LinearSolver::direct || n_ranks == 1,
                ExcMessage("'Solver/Linear solver' = direct works on one MPI "
                           "rank, but the run has " +
                           std::to_string(n_ranks) +
                           "; use multigrid or automatic."));
    return choice == LinearSolver::direct ||
           (choice == LinearSolver::automatic && n_ranks == 1 &&
            prefer_direct(dim,
                          n_dofs,
                          n_face_dofs,
                          demand.max_poissons_ratio,
                          demand.n_solves));
  }



  std::unique_ptr<BulkSolver>
  make_bulk_solver(const BulkSystem &system, const SolverDemand &demand)
  {
    const DistributedMatrix &matrix = system.matrix;
    if (is_direct(demand,
                  system.dim,
                  matrix.m(),
                  system.face.dofs().size(),
                  matrix.get_mpi_communicator()))
      return std::make_unique<SchurSolver>(matrix,
                                           system.excluded,
                                           system.face,
                                           system.dim);
    return std::make_unique<KrylovSolver>(matrix,
                                          system.excluded,
                                          system.face,
                                          make_preconditioner(system,
                                                              demand.choice));
  }
} // namespace Viscoplastic
