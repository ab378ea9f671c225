// SPDX-License-Identifier: LGPL-2.1-or-later

// Which cells are marked for refinement and coarsening, on any number of ranks.

#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_generator.h>

#include "body.h"
#include "refusals.h"
#include <viscoplastic_contact/mesh/mesh_marking.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>
#include <viscoplastic_contact/mesh/mesh_size.h>

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class Marking : public testing::Test
  {};
  TYPED_TEST_SUITE(Marking, Dimensions, );



  TYPED_TEST(Marking, RespectsLevels)
  {
    constexpr int        dim = TypeParam::value;
    Body<dim>            body(box_with<dim>("set Role = clamped\n"));
    RefinementParameters parameters;
    parameters.refinement_fraction = 0.8;
    parameters.coarsening_fraction = 0.1;
    parameters.minimal_level       = 1;
    parameters.maximal_level       = 2;
    body.triangulation.refine_global(1);
    // The estimate has a peak that moves from left to right.
    for (const double peak : {0., 0., 2., 2.})
      {
        Vector<double> estimate(body.triangulation.n_active_cells());
        for (const auto &cell : body.triangulation.active_cell_iterators())
          estimate[cell->active_cell_index()] =
            std::exp(-10. * std::abs(cell->center()[0] - peak));
        mark_cells(body.triangulation, estimate, parameters);
        body.triangulation.execute_coarsening_and_refinement();
        int coarsest = 100, finest = 0;
        for (const auto &cell : body.triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            {
              coarsest = std::min(coarsest, cell->level());
              finest   = std::max(finest, cell->level());
            }
        EXPECT_EQ(Utilities::MPI::min(coarsest, MPI_COMM_WORLD), 1);
        EXPECT_EQ(Utilities::MPI::max(finest, MPI_COMM_WORLD), 2);
      }
    // Nothing is left to be refined or coarsened.
    parameters.coarsening_fraction = 0.;
    parameters.maximal_level       = 1;
    Vector<double> estimate(body.triangulation.n_active_cells());
    estimate = 1.;
    EXPECT_FALSE(mark_cells(body.triangulation, estimate, parameters));
    estimate                 = 0.;
    parameters.maximal_level = 6;
    EXPECT_FALSE(mark_cells(body.triangulation, estimate, parameters));
  }



  TYPED_TEST(Marking, RankAtVertex)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(box_with<dim>("set Role = clamped\n"));
    body.triangulation.refine_global(2);
    body.refine_where([](const Point<dim> &x) { return x[0] < 0.4; });
    for (const auto &cell : body.triangulation.cell_iterators())
      for (const unsigned int v : cell->vertex_indices())
        {
          auto there = cell;
          while (there->has_children())
            there = there->child(v);
          if (!there->is_artificial())
            {
              EXPECT_EQ(rank_at_vertex(body.triangulation, cell->id(), v),
                        there->subdomain_id())
                << cell->id() << " " << v << " " << there->id();
            }
        }
  }



  TYPED_TEST(Marking, EachRankNeedsAllCoarseCells)
  {
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
    rlimit limit   = before;
    limit.rlim_cur = rlim_t(8) << 30;
    ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
    const auto message_with = [](const double n_coarse_cells) {
      return message_of([&] {
        check_mesh_size(
          TypeParam::value, 5e6, n_coarse_cells, "It", MPI_COMM_WORLD);
      });
    };
    const std::string many = message_with(5e6), few = message_with(1.);
    ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_EQ(few, "");
    const bool is_parallel =
      Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;
    EXPECT_EQ(many.find("coarse cells, which each rank keeps") !=
                std::string::npos,
              is_parallel)
      << many;
  }



  TYPED_TEST(Marking, ThatChangesAlmostNothingKeepsTheMesh)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(box_with<dim>("set Role = clamped\n"));
    body.triangulation.refine_global(1);
    body.refine_where([](const Point<dim> &x) { return x[0] < 1.; });
    // The fine half cannot be refined further; the coarse half has @p share of
    // the estimate.
    RefinementParameters parameters;
    parameters.refinement_fraction = 1.;
    parameters.coarsening_fraction = 0.;
    parameters.maximal_level       = 2;
    Vector<double> estimate(body.triangulation.n_active_cells());
    const auto     mark = [&](const double share) {
      for (const auto &cell : body.triangulation.active_cell_iterators())
        {
          const bool is_fine = cell->center()[0] < 1.;
          estimate[cell->active_cell_index()] =
            cell->measure() * (is_fine ? 1. - share : share);
        }
      return mark_cells(body.triangulation, estimate, parameters);
    };
    const auto any_flag = [&] {
      for (const auto &cell : body.triangulation.active_cell_iterators())
        if (cell->refine_flag_set() || cell->coarsen_flag_set())
          return true;
      return false;
    };
    parameters.smallest_share = 0.02;
    EXPECT_FALSE(mark(0.019));
    EXPECT_FALSE(any_flag());
    EXPECT_TRUE(mark(0.021));
    parameters.smallest_share = 0.;
    EXPECT_TRUE(mark(0.001));

    // Coarsening alone changes the mesh for all families, not for one.
    for (const auto &cell : body.triangulation.active_cell_iterators())
      cell->clear_refine_flag();
    parameters.smallest_share      = 0.02;
    parameters.refinement_fraction = 0.;
    parameters.coarsening_fraction = 0.001;
    for (const auto &cell : body.triangulation.active_cell_iterators())
      {
        const bool is_in_the_corner =
          cell->level() == 2 && cell->center().norm() < 0.25 * std::sqrt(dim);
        estimate[cell->active_cell_index()] = is_in_the_corner ? 1e-9 : 1.;
      }
    EXPECT_FALSE(mark_cells(body.triangulation, estimate, parameters));
    EXPECT_FALSE(any_flag());
    parameters.coarsening_fraction = 1.;
    EXPECT_TRUE(mark_cells(body.triangulation, estimate, parameters));
  }



  TYPED_TEST(Marking, ForAToleranceAsManyAsItTakes)
  {
    constexpr int dim = TypeParam::value;
    // The estimate is of order h and grows toward a corner.
    const auto estimate_on = [](const auto &triangulation) {
      Vector<double> squared(triangulation.n_active_cells());
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          squared[cell->active_cell_index()] =
            std::pow(cell->diameter(), 2.) * cell->measure() /
            std::pow(cell->center().norm(), 1.5);
      return squared;
    };
    const auto size_of = [](const Vector<double> &squared) {
      return std::sqrt(Utilities::MPI::sum(squared.l1_norm(), MPI_COMM_WORLD));
    };
    Body<dim>                   body(box_with<dim>("set Role = clamped\n"));
    auto                       &triangulation = body.triangulation;
    RefinementParameters        parameters;
    const std::function<void()> none, any = [] {};
    triangulation.refine_global(1);
    const double wanted   = 0.3 * size_of(estimate_on(triangulation));
    unsigned int n_meshes = 0;
    double       ratio    = 0.;
    for (;; ++n_meshes)
      {
        const Vector<double> squared = estimate_on(triangulation);
        ratio                        = size_of(squared) / wanted;
        if (!mark_cells_to_tolerance(triangulation,
                                     squared,
                                     parameters,
                                     ratio,
                                     n_meshes == 0 ? any : none))
          break;
        triangulation.execute_coarsening_and_refinement();
        ASSERT_LT(n_meshes, 20u);
      }
    EXPECT_LE(ratio, 1.);
    EXPECT_GT(ratio, 0.7);
    EXPECT_GT(n_meshes, 2u);
    // Near the tolerance the mesh stays; far below, cells are coarsened.
    const auto     fine    = triangulation.n_global_active_cells();
    Vector<double> squared = estimate_on(triangulation);
    EXPECT_FALSE(
      mark_cells_to_tolerance(triangulation, squared, parameters, 0.65, any));
    EXPECT_FALSE(
      mark_cells_to_tolerance(triangulation, squared, parameters, 0.3));
    const double larger = 3. * wanted;
    while (mark_cells_to_tolerance(
      triangulation, squared, parameters, size_of(squared) / larger, any))
      {
        triangulation.execute_coarsening_and_refinement();
        squared = estimate_on(triangulation);
        EXPECT_LT(size_of(squared), larger);
      }
    EXPECT_LT(triangulation.n_global_active_cells(), 0.7 * fine);
    // If only a few cells may be refined, the mesh stays.
    const auto       n_cells = triangulation.n_global_active_cells();
    constexpr double family  = GeometryInfo<dim>::max_children_per_cell;
    parameters.cell_budget   = n_cells + family - 1;
    EXPECT_FALSE(
      mark_cells_to_tolerance(triangulation, squared, parameters, 2.));
    parameters.cell_budget = family * n_cells;
    EXPECT_TRUE(
      mark_cells_to_tolerance(triangulation, squared, parameters, 2.));
    for (const auto &cell : triangulation.active_cell_iterators())
      cell->clear_refine_flag();
    // If no cell can be refined, none is coarsened either.
    parameters.maximal_level = 0;
    EXPECT_FALSE(
      mark_cells_to_tolerance(triangulation, squared, parameters, 2., any));
  }



  TYPED_TEST(Marking, RespectsTheBudget)
  {
    constexpr int        dim = TypeParam::value;
    Body<dim>            body(box_with<dim>("set Role = clamped\n"));
    RefinementParameters parameters;
    parameters.refinement_fraction = 0.9;
    parameters.coarsening_fraction = 0.02;
    parameters.cell_budget         = 300;
    std::vector<unsigned int> n_cells;
    for (unsigned int round = 0; round < 8; ++round)
      {
        // The estimate has a corner singularity that no mesh resolves.
        Vector<double> estimate(body.triangulation.n_active_cells());
        for (const auto &cell : body.triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            {
              const Point<dim> x = cell->center();
              estimate[cell->active_cell_index()] =
                cell->measure() / (x[0] + 0.5 * x[1] + 0.2 * x[dim - 1]);
            }
        mark_cells(body.triangulation, estimate, parameters);
        body.triangulation.execute_coarsening_and_refinement();
        n_cells.push_back(body.triangulation.n_global_active_cells());
      }
    // The budget is exceeded only by cells that grade the mesh.
    EXPECT_GT(n_cells.back(), 280u);
    for (const unsigned int n : n_cells)
      EXPECT_LT(n, 315u);
  }



  TYPED_TEST(Marking, IsThatOfTheWholeMesh)
  {
    // Flags are the same on a distributed mesh and on a serial one.
    constexpr int dim = TypeParam::value;
    using Mesh        = parallel::distributed::Triangulation<dim>;
    Mesh       shared(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
    const auto number = [](const Point<dim> &x, const double seed) {
      const double value =
        4711. * std::sin(seed + 37. * x[0] + 91. * x[1] + 53. * x[dim - 1]);
      return value - std::floor(value);
    };
    for (Mesh *mesh : {&shared, &alone})
      GridGenerator::subdivided_hyper_cube(*mesh, 3);
    for (unsigned int round = 0; round < (dim == 2 ? 25 : 5); ++round)
      {
        for (Mesh *mesh : {&shared, &alone})
          {
            for (const auto &cell : mesh->active_cell_iterators())
              if (cell->is_locally_owned())
                {
                  if (cell->level() < 4 && number(cell->center(), round) < 0.1)
                    cell->set_refine_flag();
                  else if (cell->level() > 0 &&
                           number(cell->parent()->center(), round) < 0.8)
                    cell->set_coarsen_flag();
                }
            prepare_mesh_change(*mesh);
            mesh->execute_coarsening_and_refinement();
          }
        ASSERT_EQ(shared.n_global_active_cells(), alone.n_active_cells())
          << round;
      }
    EXPECT_GT(alone.n_active_cells(), 100u);
    std::vector<CellId> ids;
    for (const auto &cell : alone.active_cell_iterators())
      ids.push_back(cell->id());
    for (const auto &cell : shared.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          EXPECT_NE(std::find(ids.begin(), ids.end(), cell->id()), ids.end());
        }
  }
} // namespace
