// SPDX-License-Identifier: LGPL-2.1-or-later

// Geometric multigrid: its hierarchy of spaces, iterations on finer and finer
// meshes, and renewal for another matrix.

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/mapping_q1.h>

#include "bulk_scenario.h"

#include <algorithm>
#include <map>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class NestedMeshes : public testing::Test
  {};
  TYPED_TEST_SUITE(NestedMeshes, Dimensions, );



  /// A truncation with points that stick within @p radius of a vertex.
  template <int dim>
  FaceTruncation
  sticking_within(const double radius, const BulkScenario<dim> &scenario)
  {
    std::map<types::global_dof_index, Point<dim>> position;
    DoFTools::map_dofs_to_support_points(MappingQ1<dim>(),
                                         scenario.dof_handler,
                                         position);
    const FaceRestriction &restriction = scenario.face->restriction();
    const ContactLayout   &face        = restriction.face();
    const Point<dim>       vertex = scenario.triangulation.begin(0)->vertex(0);
    FaceTruncation         truncation;
    truncation.spring.resize(face.n_nodes());
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      {
        const auto   dof = restriction.dofs()[face.first_dof[n]];
        const double r   = position.at(dof).distance(vertex);
        truncation.projector.emplace_back(
          r <= radius ? Tensor<2, 3>() :
                        Tensor<2, 3>(unit_symmetric_tensor<3>()));
      }
    return truncation;
  }



  TYPED_TEST(NestedMeshes, NestedSpacesHaveLinearFunctions)
  {
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(1, 2, true);
    const NodeHierarchy     hierarchy = make_node_hierarchy(*scenario.space);
    std::map<types::global_dof_index, Point<dim>> position;
    DoFTools::map_dofs_to_support_points(MappingQ1<dim>(),
                                         scenario.dof_handler,
                                         position);
    std::vector<double> x(scenario.dof_handler.n_dofs(), 0.);
    for (const auto dof : scenario.space->owned)
      x[dof] = position.at(dof)[dof % dim];
    Utilities::MPI::sum(x, MPI_COMM_WORLD, x);
    // The first space of each node, and of the nodes that depend on it.
    std::vector<unsigned int> first(hierarchy.end_of_mesh, 0),
      of_children(hierarchy.end_of_mesh, hierarchy.n_levels);
    for (std::size_t n = 0; n < hierarchy.first_level.size(); ++n)
      {
        const auto first_dof = (hierarchy.begin + n) * dim;
        if (scenario.space->cartesian_hanging_nodes().is_constrained(first_dof))
          {
            EXPECT_GE(hierarchy.first_level[n], hierarchy.n_levels);
            first[hierarchy.begin + n] = hierarchy.n_levels;
            continue;
          }
        ASSERT_LT(hierarchy.first_level[n], hierarchy.n_levels);
        first[hierarchy.begin + n] = hierarchy.first_level[n];
        EXPECT_EQ(hierarchy.row_begin[n] == hierarchy.row_begin[n + 1],
                  hierarchy.first_level[n] == 0);
        if (hierarchy.first_level[n] == 0)
          continue;
        double         sum = 0.;
        Tensor<1, dim> interpolated;
        for (std::size_t e = hierarchy.row_begin[n];
             e < hierarchy.row_begin[n + 1];
             ++e)
          {
            const auto &[parent, weight] = hierarchy.parents[e];
            sum += weight;
            of_children[parent] =
              std::min(of_children[parent], hierarchy.first_level[n]);
            for (unsigned int d = 0; d < dim; ++d)
              interpolated[d] += weight * x[parent * dim + d];
          }
        EXPECT_NEAR(sum, 1., 1e-14);
        for (unsigned int d = 0; d < dim; ++d)
          EXPECT_NEAR(interpolated[d], x[first_dof + d], 1e-14);
      }
    Utilities::MPI::sum(first, MPI_COMM_WORLD, first);
    Utilities::MPI::min(of_children, MPI_COMM_WORLD, of_children);
    unsigned int n_of_first_space = 0;
    for (std::size_t n = 0; n < first.size(); ++n)
      if (first[n] == 0)
        {
          ++n_of_first_space;
          EXPECT_GT(of_children[n], 0u);
        }
      else if (first[n] < hierarchy.n_levels) // no sooner than needed
        {
          EXPECT_EQ(first[n] + 1, of_children[n]);
        }
    EXPECT_EQ(n_of_first_space, dim == 2 ? 6u : 12u);
    EXPECT_EQ(n_of_first_space * dim, scenario.space->n_first_dofs());
    // Cells that were refined less leave with the finest ones.
    EXPECT_EQ(hierarchy.n_levels, 4u);
    EXPECT_LT(std::count(first.begin(), first.end(), 2u),
              std::count(first.begin(), first.end(), 3u) / (dim == 2 ? 2 : 4));
  }



  TYPED_TEST(NestedMeshes, IterationsDoNotGrowWithTheMesh)
  {
    // No point sticks, about half of them, or all, with one set-up. Filtering a
    // preconditioner for a free face takes 20 more iterations on the last mesh.
    constexpr int                               dim = TypeParam::value;
    std::map<double, std::vector<unsigned int>> iterations;
    for (const unsigned int n_levels : {1, 2, 3})
      {
        const BulkScenario<dim> scenario(1,
                                         dim == 2 ? n_levels + 2 : n_levels,
                                         true);
        const unsigned int      m      = scenario.face->layout().n_dofs();
        const auto              solver = scenario.geometric();
        for (const double radius : {-1., 0.9, 10.})
          {
            Vector<double>    force(m), w(m);
            DistributedVector u(scenario.start);
            const auto        solve = solver->begin(scenario.load, u);
            solve->set_truncation(sticking_within(radius, scenario));
            iterations[radius].push_back(solve->correct(force, 1e-8, w));
          }
      }
    for (const auto &[radius, counts] : iterations)
      {
        SCOPED_TRACE(radius);
        EXPECT_LE(counts[2], counts[1] + 2);
        EXPECT_LE(counts[2], counts[0] + 3);
        EXPECT_LE(counts[2], 20u);
      }
  }



  TYPED_TEST(NestedMeshes, AlgebraicCoarseSolverFollowsTheStickSet)
  {
    // In 2D the first mesh is too large for aggregation to just factorize.
    constexpr int           dim = TypeParam::value;
    const BulkScenario<dim> scenario(dim == 2 ? 23 : 3, 1);
    const unsigned int      m          = scenario.face->layout().n_dofs();
    const auto              correction = [&](BulkSolver   &solver,
                                const double  radius,
                                const double  tolerance,
                                unsigned int &iterations) {
      Vector<double>    force(m), w(m);
      DistributedVector u(scenario.start);
      const auto        solve = solver.begin(scenario.load, u);
      solve->set_truncation(sticking_within(radius, scenario));
      iterations = solve->correct(force, tolerance, w);
      return w;
    };
    const auto is_built_for = [&](const BulkSolver &solver,
                                  const double      radius) {
      return solver.preconditioner_state()->built_for.is_same_as(
        sticking_within(radius, scenario), scenario.face->layout());
    };
    const auto direct    = scenario.geometric(),
               algebraic = scenario.geometric(true);
    unsigned int n_direct, n_algebraic;
    EXPECT_FALSE(direct->preconditioner_state());
    EXPECT_FALSE(algebraic->preconditioner_state());
    // The sticking radius of the last set-up.
    double           built_for = -1.;
    constexpr double few_nodes = dim == 2 ? 0.06 : 0.2;
    for (const double radius : {-1., few_nodes, 0.9, 10., few_nodes})
      {
        SCOPED_TRACE(radius);
        Vector<double> exact = correction(*direct, radius, 1e-8, n_direct);
        Vector<double> w = correction(*algebraic, radius, 1e-8, n_algebraic);
        EXPECT_LE(n_algebraic, (3 * n_direct) / 2 + 3);
        const ContactLayout &face = scenario.face->layout();
        face.add(-1., exact, w);
        EXPECT_LE(std::sqrt(face.dot(w, w)),
                  1e-6 * std::sqrt(face.dot(exact, exact)));
        // A few more nodes that stick cause no new set-up.
        if (built_for != -1. || radius != few_nodes)
          built_for = radius;
        EXPECT_TRUE(is_built_for(*algebraic, built_for));
      }

    // A trial truncation causes no set-up, either. A solver restored to the
    // same state gives the same results whatever its history; without its state
    // it sets up anew.
    DistributedVector u(scenario.start);
    algebraic->begin(scenario.load, u)
      ->set_truncation(sticking_within(10., scenario),
                       /* may_rebuild = */ false);
    EXPECT_TRUE(is_built_for(*algebraic, built_for));
    const auto           state = algebraic->preconditioner_state();
    const Vector<double> w     = correction(*algebraic, -1., 1e-8, n_algebraic);
    const auto           other = scenario.geometric(true);
    other->restore(state);
    EXPECT_TRUE(correction(*other, -1., 1e-8, n_algebraic) == w);
    other->restore({});
    EXPECT_FALSE(other->preconditioner_state());
    EXPECT_FALSE(correction(*other, -1., 1e-8, n_algebraic) == w);
    EXPECT_TRUE(is_built_for(*other, -1.));
    other->restore(state);
    EXPECT_TRUE(correction(*other, -1., 1e-8, n_algebraic) == w);
  }



  TYPED_TEST(NestedMeshes, RenewedSetUpIsANewOne)
  {
    constexpr int        dim = TypeParam::value;
    BulkScenario<dim>    scenario(1, 2, true);
    const auto           renewed    = scenario.geometric();
    const FaceTruncation truncation = sticking_within<dim>(0.9, scenario);
    const unsigned int   m          = scenario.face->layout().n_dofs();
    const auto           correction = [&](BulkSolver &solver) {
      Vector<double>    force(m), w(m);
      DistributedVector u(scenario.start);
      const auto        solve = solver.begin(scenario.load, u);
      solve->set_truncation(truncation);
      solve->correct(force, 1e-8, w);
      return w;
    };
    correction(*renewed);
    // Renew with another material and another unit of stress.
    const ElasticModuli<dim> moduli(Stiffness::isotropic(1e9, 0.4));
    assemble_elastic_matrix(*scenario.space, moduli, true, scenario.matrix);
    ASSERT_TRUE(renewed->renew(scenario.matrix));
    const auto fresh = scenario.geometric();
    EXPECT_TRUE(correction(*renewed) == correction(*fresh));
    const DistributedMatrix other;
    EXPECT_FALSE(renewed->renew(other));
  }
} // namespace
