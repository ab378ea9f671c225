// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/linear_solvers/solver_choice.h>

#include <cmath>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// Seconds that are proportional to a power of the degrees of freedom.
    struct Power
    {
      double seconds, exponent;
    };

    /// The costs of the solvers in 2D or 3D, as seconds at `n_dofs` unknowns.
    struct Costs
    {
      double n_dofs;
      /// The set-up of a new mesh, and the factorization in addition.
      Power mesh, factorization;
      Power direct_step, multigrid_step;
      /// How many times as long a step takes with algebraic multigrid as with
      /// geometric multigrid.
      double algebraic;

      double
      at(const Power &power, const double n) const
      {
        return power.seconds * std::pow(n / n_dofs, power.exponent);
      }
    };

    /// Costs measured on one machine, as benchmarks/results.md has them.
    Costs
    costs(const unsigned int dim)
    {
      return dim == 2 ?
               Costs{
                 5e5, {7., 1.}, {9.4, 1.1}, {0.41, 1.07}, {1.08, 1.07}, 5.} :
               Costs{
                 1.1e5, {2.3, 1.}, {14.5, 1.3}, {0.74, 1.24}, {0.37, 1.}, 15.};
    }



    /// The factor by which near incompressibility raises iteration counts.
    double
    growth_by_incompressibility(const double poissons_ratio)
    {
      return std::max(1.,
                      0.35 /
                        std::sqrt(std::max(1. - 2. * poissons_ratio, 1e-8)));
    }



    /// Whether there are coarser meshes for geometric multigrid.
    bool
    has_levels(const SolverDemand &demand)
    {
      return has_small_first_mesh(demand) ||
             (demand.n_first_dofs > 0 &&
              demand.n_first_dofs <= demand.n_dofs / 3);
    }



    /// Whether the direct solver is expected to win.
    bool
    prefer_direct(const SolverDemand &demand)
    {
      const auto [dim, n_dofs] = std::make_pair(demand.dim, demand.n_dofs);
      // Beyond 5000 unknowns, the dense face matrix has more than 200 MB and a
      // cubic set-up; large meshes lack the memory for the factor.
      if (demand.n_face_dofs > 5000 || n_dofs >= (dim == 2 ? 2000000 : 200000))
        return false;
      // Small systems are solved exactly, which costs next to nothing.
      constexpr unsigned int large_face = 1500;
      if (!(demand.has_friction && demand.n_face_dofs > large_face) &&
          n_dofs < (demand.n_solves < 4 && has_levels(demand) ? 2000 : 20000))
        return true;
      if (has_levels(demand))
        {
          const auto total = [&](const BulkSolverKind kind) {
            const SolverCost cost = expected_cost(kind, demand);
            return cost.set_up + demand.n_solves * cost.step;
          };
          return total(BulkSolverKind::direct) <
                 total(BulkSolverKind::geometric_multigrid);
        }
      // Algebraic multigrid takes several times the iterations.
      return dim == 2 || demand.max_poissons_ratio > 0.45 ||
             (n_dofs < 150000 && demand.n_solves >= 20);
    }
  } // namespace



  std::string
  to_string(const BulkSolverKind kind)
  {
    return kind == BulkSolverKind::direct              ? "direct" :
           kind == BulkSolverKind::geometric_multigrid ? "geometric multigrid" :
                                                         "algebraic multigrid";
  }



  bool
  has_small_first_mesh(const SolverDemand &demand)
  {
    // The first mesh's matrix is factorized whenever its stick set changes.
    using Number       = std::uint64_t;
    const Number share = demand.n_dofs / 20;
    return demand.n_first_dofs > 0 &&
           demand.n_first_dofs <=
             (demand.dim == 2 ?
                std::max(Number(2000), std::min(share, Number(20000))) :
                std::max(Number(600), std::min(share, Number(6000))));
  }



  BulkSolverKind
  choose_bulk_solver(const SolverDemand &demand)
  {
    const LinearSolver choice = demand.choice;
    if (choice == LinearSolver::direct && demand.n_ranks != 1)
      refuse(
        "The direct linear solver works on one MPI rank, but the run has " +
        std::to_string(demand.n_ranks) + "; let it be multigrid or automatic.");
    if (choice == LinearSolver::direct ||
        (choice == LinearSolver::automatic && demand.n_ranks == 1 &&
         prefer_direct(demand)))
      return BulkSolverKind::direct;
    return choice != LinearSolver::algebraic_multigrid && has_levels(demand) ?
             BulkSolverKind::geometric_multigrid :
             BulkSolverKind::algebraic_multigrid;
  }



  SolverCost
  expected_cost(const BulkSolverKind kind, const SolverDemand &demand)
  {
    // The costs of small systems, whatever their solver.
    constexpr double least_set_up = 1e-3, least_step = 2.5e-3;
    const Costs      c      = costs(demand.dim);
    const double     n      = demand.n_dofs;
    const double     set_up = least_set_up + c.at(c.mesh, n);
    if (kind == BulkSolverKind::direct)
      {
        // A step with friction has some 60 products with the face matrix, which
        // memory bandwidth limits.
        constexpr double by_entry = 1e-7;
        const double     n_face =
          demand.has_friction ? static_cast<double>(demand.n_face_dofs) : 0.;
        return {set_up + c.at(c.factorization, n),
                least_step + c.at(c.direct_step, n) +
                  by_entry * n_face * n_face};
      }
    // The factor for cycles of algebraic multigrid on a large first mesh.
    constexpr double large_first_mesh = 1.6;
    const double     factor = kind == BulkSolverKind::algebraic_multigrid ?
                                c.algebraic :
                              has_small_first_mesh(demand) ? 1. :
                                                             large_first_mesh;
    return {set_up,
            least_step +
              c.at(c.multigrid_step, n) * factor *
                growth_by_incompressibility(demand.max_poissons_ratio)};
  }



  double
  expected_seconds(SolverDemand       demand,
                   const double       n_steps,
                   const unsigned int n_ranks)
  {
    demand.n_ranks        = n_ranks;
    const SolverCost cost = expected_cost(choose_bulk_solver(demand), demand);
    const double     n_meshes = std::max(1.,
                                     n_steps * demand.solves_per_step /
                                       std::max(demand.n_solves, 1u));
    return (n_meshes * cost.set_up + n_steps * cost.step) / n_ranks;
  }



  double
  expected_memory(const BulkSolverKind kind, const SolverDemand &demand)
  {
    const unsigned int dim    = demand.dim;
    const double       n_dofs = demand.n_dofs, n_face_dofs = demand.n_face_dofs;
    const double       matrix  = n_dofs * matrix_bytes(dim);
    const double       vectors = n_dofs * 20. * 8.; // some 20
    if (kind == BulkSolverKind::geometric_multigrid)
      return matrix + vectors + n_dofs * (dim == 2 ? 950. : 1200.);
    // Algebraic multigrid has a second matrix without the prescribed rows, of
    // 12 bytes an entry, and ML's hierarchy.
    if (kind == BulkSolverKind::algebraic_multigrid)
      return matrix + vectors +
             n_dofs * (dim == 2 ? 18. * 12. + 850. : 81. * 12. + 2700.);
    // Nested dissection: n log n entries in 2D, n^(4/3) in 3D.
    const double factor = dim == 2 ?
                            n_dofs * 78. * std::log2(std::max(n_dofs, 2.)) :
                            n_dofs * 190. * std::cbrt(n_dofs);
    return matrix + vectors + factor + 2. * 8. * n_face_dofs * n_face_dofs;
  }
} // namespace Viscoplastic
