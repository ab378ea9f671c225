// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>
#include <viscoplastic_contact/linear_solvers/bulk_solver_factory.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/schur_solver.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /**
     * Seconds of the solvers in one dimension, as powers of the degrees of
     * freedom: what the set-up of the direct solver takes beyond that of
     * geometric multigrid, and a step with each of them. Measured by
     * benchmarks/step_cost.py; only ratios matter.
     */
    struct Costs
    {
      double n_dofs; // for which the seconds are
      double factorization, factorization_exponent;
      double direct_step, direct_exponent;
      double multigrid_step, multigrid_exponent;
    };

    Costs
    costs(const unsigned int dim)
    {
      return dim == 2 ? Costs{5e5, 6.0, 1.1, 0.29, 1.07, 1.0, 1.08} :
                        Costs{1.1e5, 13., 1.3, 0.59, 1.24, 0.44, 1.0};
    }



    /// How many times more iterations nearly incompressible bodies take.
    double
    growth_by_incompressibility(const double poissons_ratio)
    {
      return std::max(1.,
                      0.35 /
                        std::sqrt(std::max(1. - 2. * poissons_ratio, 1e-8)));
    }



    /// Whether the mesh is refined from a small one. That one is solved on
    /// directly, whenever its stick set changes: it must be little against a
    /// cycle on the present one.
    bool
    has_small_first_mesh(const SolverDemand           &demand,
                         const unsigned int            dim,
                         const types::global_dof_index n_dofs)
    {
      using Number       = types::global_dof_index;
      const Number share = n_dofs / 20;
      return demand.n_first_dofs > 0 &&
             demand.n_first_dofs <=
               (dim == 2 ?
                  std::max(Number(2000), std::min(share, Number(20000))) :
                  std::max(Number(600), std::min(share, Number(6000))));
    }



    /// Whether the direct solver is expected to win.
    bool
    prefer_direct(const SolverDemand           &demand,
                  const unsigned int            dim,
                  const types::global_dof_index n_dofs,
                  const unsigned int            n_face_dofs)
    {
      // The dense face problem: 200 MB and a cubic set-up. Beyond, the memory
      // of the factor.
      if (n_face_dofs > 5000 || n_dofs >= (dim == 2 ? 2000000 : 200000))
        return false;
      // An exact solution, where it costs next to nothing.
      const bool has_levels = has_small_first_mesh(demand, dim, n_dofs);
      if (n_dofs < (demand.n_solves < 4 && has_levels ? 2000 : 20000))
        return true;
      if (has_levels)
        {
          const Costs  c     = costs(dim);
          const double ratio = n_dofs / c.n_dofs;
          return c.factorization * std::pow(ratio, c.factorization_exponent) +
                   demand.n_solves * c.direct_step *
                     std::pow(ratio, c.direct_exponent) <
                 demand.n_solves * c.multigrid_step *
                   growth_by_incompressibility(demand.max_poissons_ratio) *
                   std::pow(ratio, c.multigrid_exponent);
        }
      // Algebraic multigrid takes several times the iterations.
      return dim == 2 || demand.max_poissons_ratio > 0.45 ||
             (n_dofs < 150000 && demand.n_solves >= 20);
    }
  } // namespace



  BulkSolverKind
  choose_bulk_solver(const SolverDemand           &demand,
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
    if (choice == LinearSolver::direct ||
        (choice == LinearSolver::automatic && n_ranks == 1 &&
         prefer_direct(demand, dim, n_dofs, n_face_dofs)))
      return BulkSolverKind::direct;
    return choice != LinearSolver::algebraic_multigrid &&
               has_small_first_mesh(demand, dim, n_dofs) ?
             BulkSolverKind::geometric_multigrid :
             BulkSolverKind::algebraic_multigrid;
  }



  std::unique_ptr<BulkSolver>
  make_bulk_solver(const BulkSystem &system, const SolverDemand &demand)
  {
    const DistributedMatrix        &matrix = system.matrix;
    std::unique_ptr<Preconditioner> multigrid;
    switch (choose_bulk_solver(demand,
                               system.dim,
                               matrix.m(),
                               system.face.dofs().size(),
                               matrix.get_mpi_communicator()))
      {
        case BulkSolverKind::direct:
          return std::make_unique<SchurSolver>(matrix,
                                               system.excluded,
                                               system.face,
                                               system.dim);
        case BulkSolverKind::geometric_multigrid:
          if (system.dim == 2)
            multigrid = std::make_unique<GeometricMultigrid<2>>(
              matrix, system.excluded, system.hierarchy(), system.face);
          else
            multigrid = std::make_unique<GeometricMultigrid<3>>(
              matrix, system.excluded, system.hierarchy(), system.face);
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
