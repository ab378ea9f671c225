// SPDX-License-Identifier: LGPL-2.1-or-later

// The solvers of the bulk, direct and Krylov with algebraic and geometric
// multigrid, against dense algebra and against each other. The direct one runs
// on one rank only.

#include "dense_scenario.h"
#include "refusals.h"
#include <viscoplastic_contact/contact/contact_solver.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class BulkSolvers : public testing::Test
  {};
  TYPED_TEST_SUITE(BulkSolvers, Dimensions, );



  double
  distance(Vector<double> a, const Vector<double> &b)
  {
    a -= b;
    return a.l2_norm();
  }



  TYPED_TEST(BulkSolvers, PlainSolve)
  {
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(1, 1, true);
    const Dense             dense(scenario);
    Vector<double>          exact = dense.solve(dense.residual(dense.start));
    exact += dense.start;
    for (const auto &solver : scenario.solvers())
      {
        SCOPED_TRACE(solver->name());
        DistributedVector u(scenario.start);
        solver->solve(scenario.load, u, 1e-10);
        EXPECT_LT(distance(dense.gather(u), exact), 1e-8 * exact.l2_norm());
        // The set-up can be used again, from any start.
        u.add(0.3, scenario.rough_unknowns(5.));
        solver->solve(scenario.load, u, 1e-10);
        EXPECT_LT(distance(dense.gather(u), exact), 1e-8 * exact.l2_norm());
      }
  }



  TYPED_TEST(BulkSolvers, SchurComplementIsThatOfTheBulk)
  {
    if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      GTEST_SKIP() << "The direct solver runs on one rank.";
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(1, 1, true);
    const Dense             dense(scenario);
    const auto              solver = scenario.direct();
    const auto             &S =
      dynamic_cast<const DenseFaceMatrix &>(solver->face_matrix()).matrix();
    const unsigned int m = dense.face_dofs.size();
    ASSERT_EQ(S.m(), m);
    // S^-1 is the face block of K^-1.
    FullMatrix<double> inverse(m, m), product(m, m);
    for (unsigned int k = 0; k < m; ++k)
      {
        Vector<double> unit(m);
        unit[k] = 1.;
        const Vector<double> x =
          dense.on_face(dense.solve(dense.from_face(unit)));
        for (unsigned int i = 0; i < m; ++i)
          inverse(i, k) = x[i];
      }
    S.mmult(product, inverse);
    for (unsigned int i = 0; i < m; ++i)
      for (unsigned int j = 0; j < m; ++j)
        {
          EXPECT_NEAR(product(i, j), i == j ? 1. : 0., 1e-10);
          EXPECT_EQ(S(i, j), S(j, i));
        }
  }



  /// A mixture of free, sticking and slipping points with springs.
  FaceTruncation
  some_truncation(const ContactLayout &face)
  {
    FaceTruncation truncation;
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        Tensor<2, 3> projector(unit_symmetric_tensor<3>()), spring;
        if (node % 3 == 0)
          projector = Tensor<2, 3>();
        else
          {
            // One direction is blocked in rotated components, one has a spring.
            const ContactLayout::Point &point =
              face.points[face.first_point[node]];
            Tensor<1, 3> q = point.map[0];
            q /= q.norm();
            if (node % 3 == 1)
              projector -= outer_product(q, q);
            else
              spring = 0.7 * outer_product(q, q);
          }
        // Entries beyond the components of the node stay diagonal.
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            if ((i >= face.n_node_dofs(node) || j >= face.n_node_dofs(node)) &&
                i != j)
              projector[i][j] = spring[i][j] = 0.;
        truncation.projector.push_back(projector);
        truncation.spring.push_back(spring);
      }
    return truncation;
  }



  TYPED_TEST(BulkSolvers, StepsOfAContactSolver)
  {
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(1, 1, true);
    const Dense             dense(scenario);
    const ContactLayout    &face = scenario.face->layout();
    const unsigned int      m = face.n_dofs(), n = dense.face_dofs.size();
    Vector<double>          force(m), change(m);
    for (unsigned int k = 0; k < m; ++k)
      {
        force[k]  = 0.1 * std::cos(3. * k);
        change[k] = 0.02 * std::sin(5. * k);
      }
    const FaceTruncation     truncation = some_truncation(face);
    const FullMatrix<double> projector =
                               dense.from_blocks(truncation.projector),
                             springs = dense.from_blocks(truncation.spring);

    for (const auto &solver : scenario.solvers())
      {
        SCOPED_TRACE(solver->name());
        const bool is_direct =
          dynamic_cast<const SchurSolver *>(solver.get()) != nullptr;
        // With a direct solver the bulk is in equilibrium for a given face.
        const auto relaxed = [&](const Vector<double> &u) {
          if (!is_direct)
            return u;
          FullMatrix<double> none(n, n);
          Vector<double>     result =
            dense.solve(dense.residual(u), none, FullMatrix<double>(n, n));
          result += u;
          return result;
        };

        DistributedVector u(scenario.start);
        const auto        solve    = solver->begin(scenario.load, u);
        Vector<double>    expected = relaxed(dense.start),
                       r           = solve->face_residual();
        EXPECT_LT(distance(r, dense.on_face(dense.residual(expected))), 1e-11);

        // The face matrix predicts the residual after a motion of the face.
        // Each node moves once.
        Vector<double>    foretold(r);
        const FaceMatrix &matrix    = solve->face_matrix();
        unsigned int      n_relaxed = 0;
        for (unsigned int s = 0; s < matrix.stages().size(); ++s)
          {
            Vector<double> change_in_stage(m);
            for (const unsigned int node : matrix.stages()[s])
              {
                const Tensor<1, 3> values = face.node_values(change, node);
                matrix.subtract(node, values, foretold);
                face.set_node_values(values, node, change_in_stage);
                ++n_relaxed;
              }
            matrix.subtract_changes_elsewhere(s, change_in_stage, foretold);
          }
        EXPECT_EQ(n_relaxed, face.n_nodes());
        solve->move_face(change);
        Vector<double> moved(expected);
        moved += dense.from_face(change);
        expected = relaxed(moved);
        r        = solve->face_residual();
        EXPECT_LT(distance(r, dense.on_face(dense.residual(expected))), 1e-11);
        EXPECT_LT(distance(r, foretold), 1e-11);
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          {
            const Tensor<2, 3> block =
              solve->face_matrix().diagonal_block(node);
            for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
              {
                Vector<double> column(m);
                Tensor<1, 3>   unit;
                unit[i] = 1.;
                solve->face_matrix().subtract(node, unit, column);
                for (unsigned int j = 0; j < face.n_node_dofs(node); ++j)
                  EXPECT_NEAR(block[i][j],
                              -column[face.first_dof[node] + j],
                              1e-13);
              }
          }

        // The error bound is exact for direct solvers.
        solve->set_truncation(truncation);
        Vector<double> unbalanced = dense.residual(expected);
        unbalanced -= dense.from_face(force);
        const double norm = std::sqrt(unbalanced * dense.solve(unbalanced));
        EXPECT_NEAR(solve->dual_norm(force),
                    norm,
                    is_direct ? 1e-9 * norm : 0.7 * norm);

        // Compare the correction on the truncated space.
        Vector<double>       w(m);
        const Vector<double> correction =
          dense.solve(unbalanced, projector, springs);
        solve->correct(force, 1e-10, w);
        EXPECT_LT(distance(w, dense.on_face(correction)),
                  1e-7 * correction.l2_norm());

        // Change the correction and take half a step along it.
        if (m > 0)
          {
            w[0] += 0.01;
            w[m - 1] -= 0.02;
          }
        Vector<double> step(correction);
        step -= dense.from_face(dense.on_face(correction));
        step += dense.from_face(w);
        if (is_direct)
          {
            Vector<double> target(expected);
            target += step;
            step = relaxed(target);
            step -= expected;
          }
        const auto terms = solve->search_terms(w);
        EXPECT_NEAR(terms.slope, dense.residual(expected) * step, 1e-7);
        EXPECT_NEAR(terms.curvature, dense.K.matrix_norm_square(step), 1e-7);
        const Vector<double> before = solve->face_residual();
        solve->take_step(0.5);
        expected.add(0.5, step);
        r = solve->face_residual();
        Vector<double> lost(before);
        lost -= r;
        lost *= 2.;
        EXPECT_LT(distance(lost, terms.response), 1e-10);
        EXPECT_LT(distance(r, dense.on_face(dense.residual(expected))), 1e-7);

        // The final displacement, with prescribed values unchanged.
        solve->finish();
        EXPECT_LT(distance(dense.gather(u), expected),
                  1e-7 * expected.l2_norm());
        // The squared norm of a direct solver omits a small product.
        const double energy = std::sqrt(dense.K.matrix_norm_square(expected));
        EXPECT_NEAR(solve->energy_norm(),
                    energy,
                    (is_direct ? 0.1 : 1e-7) * energy);
      }
  }



  // However often a correction is corrected, springs keep their forces.
  TYPED_TEST(BulkSolvers, TruncatedSolve)
  {
    constexpr int            dim = TypeParam::value;
    const BulkScenario<dim>  scenario(1, 1, true);
    const Dense              dense(scenario);
    const ContactLayout     &face       = scenario.face->layout();
    FaceTruncation           truncation = some_truncation(face);
    const FullMatrix<double> projector =
                               dense.from_blocks(truncation.projector),
                             springs = dense.from_blocks(truncation.spring);
    Vector<double> expected =
      dense.solve(dense.residual(dense.start), projector, springs);
    expected += dense.start;
    for (const auto &solver : scenario.solvers())
      for (const bool is_tilted : {false, true})
        {
          SCOPED_TRACE(solver->name());
          truncation.tilt.clear();
          if (is_tilted)
            truncation.tilt.assign(face.n_nodes(),
                                   Tensor<2, 3>(unit_symmetric_tensor<3>()));
          DistributedVector u(scenario.start);
          solve_truncated(*solver->begin(scenario.load, u),
                          face,
                          truncation,
                          /* is_kept = */ true,
                          Vector<double>(face.n_dofs()),
                          /* reduction = */ 1e-10,
                          /* enough = */ 0.);
          EXPECT_LT(distance(dense.gather(u), expected),
                    1e-6 * expected.l2_norm());
        }
  }



  TYPED_TEST(BulkSolvers, NodesRelaxedAtOnceDoNotCouple)
  {
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(1, 1, true);
    const Dense             dense(scenario);
    const ContactLayout    &face   = scenario.face->layout();
    const auto              solver = scenario.geometric();
    const auto             &stages = solver->face_matrix().stages();
    const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
    // Stage and owner of each entry of the face on all ranks.
    std::vector<unsigned int> stage(dense.face_dofs.size(), 0),
      owner(dense.face_dofs.size(), 0);
    for (unsigned int s = 0; s < stages.size(); ++s)
      for (const unsigned int node : stages[s])
        for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
          {
            const auto k = dense.restriction.global_numbers().nth_index_in_set(
              face.first_dof[node] + i);
            stage[k] = s;
            owner[k] = rank;
          }
    Utilities::MPI::sum(stage, MPI_COMM_WORLD, stage);
    Utilities::MPI::sum(owner, MPI_COMM_WORLD, owner);
    unsigned int n_couplings = 0;
    for (unsigned int a = 0; a < stage.size(); ++a)
      for (unsigned int b = 0; b < stage.size(); ++b)
        if (owner[a] != owner[b] &&
            dense.K(dense.face_dofs[a], dense.face_dofs[b]) != 0.)
          {
            EXPECT_NE(stage[a], stage[b]);
            EXPECT_GT(stage[a], 0u);
            ++n_couplings;
          }
    EXPECT_EQ(n_couplings > 0,
              Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1);
  }



  TYPED_TEST(BulkSolvers, WithoutFriction)
  {
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(2, 0);
    const Dense             dense(scenario);
    const FaceRestriction   no_face;
    Vector<double>          exact = dense.solve(dense.residual(dense.start));
    exact += dense.start;
    const bool serial = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1;
    const BulkSystem system =
      make_bulk_system(*scenario.space, scenario.matrix, no_face);
    for (const LinearSolver choice : {LinearSolver::direct,
                                      LinearSolver::multigrid,
                                      LinearSolver::algebraic_multigrid,
                                      LinearSolver::automatic})
      {
        const auto make = [&] {
          SolverDemand demand;
          demand.choice             = choice;
          demand.max_poissons_ratio = 0.3;
          demand.n_first_dofs       = scenario.space->n_first_dofs();
          return make_bulk_solver(system, demand);
        };
        if (choice == LinearSolver::direct && !serial)
          {
            expect_refusal([&] { make(); }, "works on one MPI rank");
            continue;
          }
        const auto solver = make();
        EXPECT_EQ(dynamic_cast<SchurSolver *>(solver.get()) != nullptr,
                  serial && (choice == LinearSolver::direct ||
                             choice == LinearSolver::automatic));
        DistributedVector u(scenario.start);
        solver->solve(scenario.load, u, 1e-10);
        EXPECT_LT(distance(dense.gather(u), exact), 1e-8 * exact.l2_norm());
      }
  }



  TYPED_TEST(BulkSolvers, RefusesAnIndefiniteMatrix)
  {
    if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      GTEST_SKIP() << "The direct solver runs on one rank.";
    constexpr int     dim = TypeParam::value;
    BulkScenario<dim> scenario(2, 0);
    for (unsigned int i = 0; i < scenario.matrix.m(); ++i)
      scenario.matrix.add_to_diagonal(i, -2. * scenario.matrix.diagonal(i));
    expect_refusal([&] { scenario.direct(); }, "not positive definite");
  }
} // namespace
