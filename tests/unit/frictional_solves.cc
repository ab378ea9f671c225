// SPDX-License-Identifier: LGPL-2.1-or-later

// Solves with friction, and solves of larger problems with multigrid, by all
// bulk solvers. The direct one runs on one rank only.

#include "bulk_scenario.h"
#include <viscoplastic_contact/contact/contact_solver.h>

#include <cmath>
#include <string>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class FrictionalSolves : public testing::Test
  {};
  TYPED_TEST_SUITE(FrictionalSolves, Dimensions, );



  TYPED_TEST(FrictionalSolves, SolutionsAgree)
  {
    constexpr int           dim       = TypeParam::value;
    constexpr double        tolerance = 1e-9;
    const BulkScenario<dim> scenario(dim == 2 ? 8 : 3, true);
    const ContactLayout    &face = scenario.face->layout();
    // Scale bounds to the load, which is rough and of size 1 per node.
    auto bounds = scenario.face->bounds(0.5);
    for (double &bound : bounds)
      bound *= dim == 2 ? 20. : 60.;

    std::vector<DistributedVector> solutions;
    std::vector<ContactState>      states;
    for (const auto &solver : scenario.solvers())
      {
        DistributedVector   u(scenario.start);
        Vector<double>      increment(face.n_dofs());
        ContactState        state(bounds);
        const auto          solve = solver->begin(scenario.load, u);
        const ContactReport report =
          ContactSolver(50).solve(*solve, face, tolerance, increment, state);
        EXPECT_LE(report.relative_error, tolerance);
        EXPECT_LE(report.iterations, 20u);

        // Check equilibrium with the friction forces independently.
        DistributedVector residual(scenario.load);
        scenario.matrix.vmult(residual, u);
        residual.sadd(-1., 1., scenario.load);
        scenario.set_excluded_to_zero(residual);
        const double   size    = residual.l2_norm();
        Vector<double> on_face = scenario.face->restriction().gather(residual);
        Vector<double> force(face.n_dofs());
        unsigned int   n_stick = 0;
        for (unsigned int p = 0; p < face.points.size(); ++p)
          {
            const unsigned int node = face.points[p].node;
            face.set_node_values(face.node_values(force, node) +
                                   node_force(face.points[p],
                                              state.multiplier[p]),
                                 node,
                                 force);
            n_stick += state.sticks[p];
          }
        n_stick = Utilities::MPI::sum(n_stick, MPI_COMM_WORLD);
        EXPECT_GT(n_stick, 0u);
        EXPECT_LT(n_stick, scenario.face->n_global_points());
        scenario.face->restriction().add(-1., force, residual);
        EXPECT_LT(residual.l2_norm(), 1e-6 * size);

        // The slip is that of the displacement.
        DistributedVector moved(u);
        moved -= scenario.start;
        const auto slips = scenario.face->slips(moved, {});
        for (unsigned int p = 0; p < slips.size(); ++p)
          EXPECT_LT((slips[p] - state.slip[p]).norm(), 1e-11);
        solutions.push_back(u);
        states.push_back(state);
      }
    for (unsigned int s = 1; s < solutions.size(); ++s)
      {
        SCOPED_TRACE(s);
        solutions[s] -= solutions[0];
        EXPECT_LT(solutions[s].l2_norm(), 1e-6 * solutions[0].l2_norm());
        EXPECT_EQ(states[s].sticks, states[0].sticks);
        for (unsigned int p = 0; p < face.points.size(); ++p)
          EXPECT_LT((states[s].multiplier[p] - states[0].multiplier[p]).norm(),
                    1e-6);
      }
  }



  TYPED_TEST(FrictionalSolves, MultigridWithSeveralLevels)
  {
    // Large enough that ML does not just factorize.
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(dim == 2 ? 7 : 2, 2);
    ASSERT_GT(scenario.dof_handler.n_dofs(), 2500u);
    DistributedVector load(scenario.load);
    scenario.set_excluded_to_zero(load);
    for (const auto &solver : scenario.solvers())
      {
        SCOPED_TRACE(solver->name());
        DistributedVector u(scenario.start);
        const unsigned    n = solver->solve(scenario.load, u, 1e-9).iterations;
        EXPECT_LT(n, 60u);
        DistributedVector residual(scenario.load);
        scenario.matrix.vmult(residual, u);
        residual.sadd(-1., 1., scenario.load);
        scenario.set_excluded_to_zero(residual);
        EXPECT_LT(residual.l2_norm(), 1e-6 * load.l2_norm());

        if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
          {
            DistributedVector exact(scenario.start);
            scenario.direct()->solve(scenario.load, exact, 1e-9);
            const double size = exact.l2_norm();
            exact -= u;
            EXPECT_LT(exact.l2_norm(), 1e-6 * size);
          }
      }
  }



  TYPED_TEST(FrictionalSolves, SlipOnAFoundationTakesWhatBilateralSlipTakes)
  {
    // The systems are the same: normal components are excluded or blocked.
    constexpr int                                    dim = TypeParam::value;
    std::map<std::string, std::vector<unsigned int>> iterations;
    for (const std::string law : {"bilateral", "unilateral"})
      {
        const BulkScenario<dim> scenario(dim == 2 ? 7 : 2, 2, false, law);
        const ContactLayout    &face = scenario.face->layout();
        EXPECT_EQ(face.has_obstacles, law == "unilateral");
        FaceTruncation truncation;
        truncation.spring.resize(face.n_nodes());
        truncation.projector.assign(face.n_nodes(),
                                    Tensor<2, 3>(unit_symmetric_tensor<3>()));
        for (const ContactLayout::Point &point : face.points)
          if (point.is_obstacle)
            {
              const Tensor<1, 3> n = point.map[0] / point.map[0].norm();
              truncation.projector[point.node] -= outer_product(n, n);
            }
        const auto solve = [&](const std::unique_ptr<BulkSolver> &solver) {
          Vector<double>    force(face.n_dofs()), w(face.n_dofs());
          DistributedVector u(scenario.start);
          const auto        begun = solver->begin(scenario.load, u);
          begun->set_truncation(truncation);
          iterations[law].push_back(begun->correct(force, 1e-8, w));
        };
        solve(scenario.geometric());
        solve(scenario.geometric(true));
        solve(scenario.algebraic());
      }
    for (unsigned int i = 0; i < 3; ++i)
      EXPECT_LE(iterations["unilateral"][i], iterations["bilateral"][i] + 2);
  }



  TYPED_TEST(FrictionalSolves, DirectSolverKnowsWhetherPivotsChangeTheirSign)
  {
    if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      return;
    const BulkScenario<TypeParam::value> scenario(2, 1, false, "unilateral");
    const unsigned int                   n = scenario.face->layout().n_nodes();
    Tensor<2, 3>                         identity(unit_symmetric_tensor<3>());
    FaceTruncation                       truncation;
    truncation.projector.assign(n, identity);
    truncation.spring.resize(n);
    const auto        solver = scenario.direct();
    DistributedVector u(scenario.start);
    for (const bool turns : {false, true, false})
      {
        truncation.tilt.assign(n, identity);
        truncation.tilt[n / 2][0][0] = turns ? -1. : 2.;
        const auto solve             = solver->begin(scenario.load, u);
        solve->set_truncation(truncation);
        EXPECT_EQ(solve->has_negative_determinant(), turns);
      }
  }



  TYPED_TEST(FrictionalSolves, RoundingOfBlockedForcesIsBlocked)
  {
    // No iteration can reduce a residual outside of the unblocked space; one
    // that has no other part would end in values that are not finite.
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(2, 1, false, "unilateral");
    const FaceRestriction  &restriction = scenario.face->restriction();
    const ContactLayout    &face        = scenario.face->layout();
    Tensor<1, 3>            normal({0.7, 0.3, dim == 3 ? 0.9 : 0.});
    normal /= normal.norm();
    FaceTruncation truncation;
    truncation.projector.assign(face.n_nodes(),
                                Tensor<2, 3>(unit_symmetric_tensor<3>()));
    Vector<double> x(face.n_dofs());
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      if (face.n_node_dofs(node) == dim)
        {
          truncation.projector[node] -= outer_product(normal, normal);
          face.set_node_values((1. + node / 3.) * normal, node, x);
        }
    DistributedVector v(scenario.start);
    restriction.set(x, v);
    restriction.project(truncation, v);
    x = restriction.gather(v);
    Vector<double> again(x);
    truncation.project(face, again);
    again -= x;
    EXPECT_LE(again.l2_norm(), 1e-14 * x.l2_norm());
  }
} // namespace
