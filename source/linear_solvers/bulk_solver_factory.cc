// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver_factory.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    std::unique_ptr<Preconditioner>
    make_geometric(const BulkSystem &system, const SolverDemand &demand)
    {
      std::vector<DistributedVector> rigid_body_modes;
      if (!has_small_first_mesh(demand))
        rigid_body_modes = system.rigid_body_modes();
      return std::make_unique<GeometricMultigrid<dim>>(
        system.matrix,
        system.excluded,
        system.hierarchy(),
        rigid_body_modes,
        system.face,
        typename GeometricMultigrid<dim>::Options());
    }
  } // namespace



  std::unique_ptr<BulkSolver>
  make_bulk_solver(const BulkSystem &system, SolverDemand demand)
  {
    const DistributedMatrix &matrix = system.matrix;
    demand.dim                      = system.dim;
    demand.n_ranks =
      Utilities::MPI::n_mpi_processes(matrix.get_mpi_communicator());
    demand.n_dofs      = matrix.m();
    demand.n_face_dofs = system.face.n_global_dofs();
    std::unique_ptr<Preconditioner> multigrid;
    switch (choose_bulk_solver(demand))
      {
        case BulkSolverKind::direct:
          return std::make_unique<SchurSolver>(matrix,
                                               system.excluded,
                                               system.face,
                                               system.dim);
        case BulkSolverKind::geometric_multigrid:
          multigrid = system.dim == 2 ? make_geometric<2>(system, demand) :
                                        make_geometric<3>(system, demand);
          break;
        case BulkSolverKind::algebraic_multigrid:
          {
            // Unknowns that couple with all others are solved for separately.
            std::vector<bool> apart(system.excluded);
            std::fill_n(apart.rbegin(), system.n_beyond_mesh, true);
            multigrid =
              std::make_unique<AlgebraicMultigrid>(matrix,
                                                   std::move(apart),
                                                   system.rigid_body_modes(),
                                                   system.face,
                                                   system.dim);
          }
      }
    return std::make_unique<KrylovSolver>(matrix,
                                          system.excluded,
                                          system.face,
                                          std::move(multigrid));
  }
} // namespace Viscoplastic
