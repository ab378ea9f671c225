// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver_factory.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

namespace Viscoplastic
{
  std::unique_ptr<BulkSolver>
  make_bulk_solver(const BulkSystem &system, SolverDemand demand)
  {
    const DistributedMatrix &matrix = system.matrix;
    demand.dim                      = system.dim;
    demand.n_ranks =
      Utilities::MPI::n_mpi_processes(matrix.get_mpi_communicator());
    demand.n_dofs      = matrix.m();
    demand.n_face_dofs = system.face.n_global_dofs();
    // Sharing rows pays after about four solves.
    const double shared_part = demand.n_solves < 4 ? 0. : 0.25;
    std::unique_ptr<Preconditioner> multigrid;
    switch (choose_bulk_solver(demand))
      {
        case BulkSolverKind::direct:
          return std::make_unique<SchurSolver>(matrix,
                                               system.excluded,
                                               system.face,
                                               system.dim);
        case BulkSolverKind::geometric_multigrid:
          if (system.dim == 2)
            multigrid =
              std::make_unique<GeometricMultigrid<2>>(matrix,
                                                      system.excluded,
                                                      system.hierarchy(),
                                                      system.face,
                                                      shared_part);
          else
            multigrid =
              std::make_unique<GeometricMultigrid<3>>(matrix,
                                                      system.excluded,
                                                      system.hierarchy(),
                                                      system.face,
                                                      shared_part);
          break;
        case BulkSolverKind::algebraic_multigrid:
          multigrid =
            std::make_unique<AlgebraicMultigrid>(matrix,
                                                 system.excluded,
                                                 system.rigid_body_modes(),
                                                 system.face,
                                                 system.dim);
      }
    return std::make_unique<KrylovSolver>(matrix,
                                          system.excluded,
                                          system.face,
                                          std::move(multigrid));
  }
} // namespace Viscoplastic
