// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/solver_choice.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace
{
  using namespace Viscoplastic;
  using Kind = BulkSolverKind;

  SolverDemand
  demand(const unsigned int dim,
         const unsigned int n_dofs,
         const unsigned int n_solves,
         const unsigned int n_first_dofs,
         const double       poissons_ratio = 0.3,
         const unsigned int n_face_dofs    = 100)
  {
    SolverDemand result;
    result.dim                = dim;
    result.max_poissons_ratio = poissons_ratio;
    result.n_solves           = n_solves;
    result.n_dofs             = n_dofs;
    result.n_face_dofs        = n_face_dofs;
    result.n_first_dofs       = n_first_dofs;
    return result;
  }



  TEST(SolverChoice, AutomaticTakesWhatCostsLess)
  {
    for (const unsigned int dim : {2, 3})
      {
        const auto kind = [&](const auto... numbers) {
          return choose_bulk_solver(demand(dim, numbers...));
        };
        // Small systems: direct, unless the mesh changes again.
        EXPECT_EQ(kind(15000, 30, 500), Kind::direct);
        EXPECT_EQ(kind(1000, 1, 50), Kind::direct);
        EXPECT_EQ(kind(5000, 1, 500), Kind::geometric_multigrid);
        EXPECT_EQ(kind(5000, 1, 0), Kind::direct); // no coarser mesh
        EXPECT_EQ(kind(5000, 1, 4000),
                  Kind::direct); // the coarse mesh is not small
        // Direct in two dimensions for a mesh that is kept. In three, multigrid
        // is cheaper unless the body is nearly incompressible.
        EXPECT_EQ(kind(100000, 100, 500),
                  dim == 2 ? Kind::direct : Kind::geometric_multigrid);
        EXPECT_EQ(kind(100000, 2, 500), Kind::geometric_multigrid);
        EXPECT_EQ(kind(100000, 100, 500, 0.4999), Kind::direct);
        // Without levels, direct in three dimensions for a mesh that is kept
        // and not large, or a body that is nearly incompressible.
        const Kind in_3d = dim == 2 ? Kind::direct : Kind::algebraic_multigrid;
        EXPECT_EQ(kind(100000, 5, 0), in_3d);
        EXPECT_EQ(kind(100000, 50, 0), Kind::direct);
        EXPECT_EQ(kind(160000, 50, 0), in_3d);
        EXPECT_EQ(kind(160000, 50, 0, 0.48), Kind::direct);
        // The dense matrix of a large face excludes a direct solver.
        EXPECT_EQ(kind(15000, 30, 500, 0.3, 5000), Kind::direct);
        EXPECT_EQ(kind(15000, 30, 500, 0.3, 5001), Kind::geometric_multigrid);
        SolverDemand friction = demand(dim, 15000, 30, 500, 0.49, 1900);
        EXPECT_EQ(choose_bulk_solver(friction), Kind::direct);
        friction.has_friction = true;
        EXPECT_EQ(choose_bulk_solver(friction), Kind::geometric_multigrid);
        // The memory of the factor excludes a direct solver.
        EXPECT_EQ(kind(2100000, 100, 500, 0.4999), Kind::geometric_multigrid);
        EXPECT_EQ(kind(2100000, 100, 0), Kind::algebraic_multigrid);
      }
  }



  TEST(SolverChoice, SeveralRanksHaveMultigridOnly)
  {
    SolverDemand on_ranks = demand(2, 1000, 100, 50);
    on_ranks.n_ranks      = 2;
    EXPECT_EQ(choose_bulk_solver(on_ranks), Kind::geometric_multigrid);
    on_ranks.n_first_dofs = 0;
    EXPECT_EQ(choose_bulk_solver(on_ranks), Kind::algebraic_multigrid);
    on_ranks.choice = LinearSolver::direct;
    EXPECT_THROW(choose_bulk_solver(on_ranks), dealii::ExceptionBase);
  }



  TEST(SolverChoice, LargeFirstMeshesHaveLevelsIfTheyAreRefined)
  {
    for (const unsigned int dim : {2, 3})
      {
        SolverDemand large = demand(dim, 300000, 2, 100000);
        EXPECT_FALSE(has_small_first_mesh(large));
        EXPECT_EQ(choose_bulk_solver(large), Kind::geometric_multigrid);
        EXPECT_GT(expected_cost(Kind::geometric_multigrid, large).step,
                  expected_cost(Kind::geometric_multigrid,
                                demand(dim, 300000, 2, 500))
                    .step);
        large.choice = LinearSolver::algebraic_multigrid;
        EXPECT_EQ(choose_bulk_solver(large), Kind::algebraic_multigrid);
        large.choice       = LinearSolver::multigrid;
        large.n_first_dofs = 100001;
        EXPECT_EQ(choose_bulk_solver(large), Kind::algebraic_multigrid);
      }
  }



  TEST(SolverChoice, CostsAreThoseOfTheBenchmark)
  {
    // Seconds per step in benchmarks/step_cost.py, 5e5 and 1.1e5 unknowns.
    EXPECT_NEAR(expected_cost(Kind::direct, demand(2, 500000, 30, 500)).step,
                0.41,
                0.01);
    EXPECT_NEAR(
      expected_cost(Kind::geometric_multigrid, demand(3, 110000, 30, 500)).step,
      0.37,
      0.01);
    // Overhead dominates: a hundred unknowns take about as long as ten.
    EXPECT_LT(expected_cost(Kind::direct, demand(3, 100, 30, 0)).step,
              1.5 * expected_cost(Kind::direct, demand(3, 10, 30, 0)).step);
    // A factorization costs more time and memory than multigrid levels.
    for (const unsigned int dim : {2, 3})
      for (const unsigned int n : {10000, 1000000})
        {
          const SolverDemand d = demand(dim, n, 30, 500);
          EXPECT_GT(expected_cost(Kind::direct, d).set_up,
                    expected_cost(Kind::geometric_multigrid, d).set_up);
          EXPECT_GT(expected_cost(Kind::algebraic_multigrid, d).step,
                    expected_cost(Kind::geometric_multigrid, d).step);
        }
    const SolverDemand large = demand(3, 1000000, 30, 500);
    EXPECT_GT(expected_memory(Kind::direct, large),
              4. * expected_memory(Kind::geometric_multigrid, large));
  }



  /// The demand of a kept mesh with levels and one solve per step.
  SolverDemand
  steady(const unsigned int dim, const unsigned int n_dofs)
  {
    return demand(dim, n_dofs, 100, n_dofs / 200);
  }



  TEST(SolverChoice, RanksShareTheWork)
  {
    // (2.3 + 0.001 + 100 (0.37 + 0.0025)) / 4
    EXPECT_NEAR(expected_seconds(steady(3, 110000), 100., 4), 9.88775, 1e-10);
    EXPECT_NEAR(expected_seconds(steady(3, 110000), 100., 1), 39.551, 1e-10);
    // The mesh changes every fifth step, 20 times.
    SolverDemand often    = steady(3, 110000);
    often.n_solves        = 10;
    often.solves_per_step = 2;
    EXPECT_NEAR(expected_seconds(often, 100., 1), 37.25 + 20 * 2.301, 1e-10);
  }
} // namespace
