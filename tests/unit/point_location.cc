// SPDX-License-Identifier: LGPL-2.1-or-later

// Points are found in one cell of one rank for any number of ranks, and points
// outside of the mesh at the nearest place on its boundary.

#include <deal.II/fe/mapping_q1.h>
#include <deal.II/grid/grid_tools.h>

#include "meshes.h"
#include <viscoplastic_contact/mesh/cell_order.h>
#include <viscoplastic_contact/mesh/point_location.h>

#include <cmath>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class MeshPoints : public testing::Test
  {};
  TYPED_TEST_SUITE(MeshPoints, Dimensions, );



  /// A cube with hanging nodes, distorted by a smooth map where @p shear > 0.
  template <int dim>
  std::unique_ptr<Mesh<dim>>
  locally_refined(const double shear)
  {
    GeometryParameters geometry;
    geometry.generator          = "hyper_cube";
    geometry.arguments          = "0 : 1 : true";
    geometry.global_refinements = 2;
    auto mesh                   = make<dim>(geometry);
    for (const auto &cell : mesh->active_cell_iterators())
      if (cell->is_locally_owned() && cell->center().norm() < 0.6)
        cell->set_refine_flag();
    mesh->execute_coarsening_and_refinement();
    if (shear > 0.)
      GridTools::transform(
        [shear](const Point<dim> &x) {
          Point<dim> y = x;
          y[0] += shear * x[1] * x[dim - 1];
          y[dim - 1] += shear * x[0] * x[0];
          return y;
        },
        *mesh);
    return mesh;
  }



  /// The place at which a point has been found, gathered from all ranks.
  template <int dim>
  struct Found
  {
    int            n_ranks;
    Point<dim>     x;
    Tensor<1, dim> center;
  };

  template <int dim>
  Found<dim>
  seen_by_all(const Mesh<dim> &mesh, const CellPoint<dim> &place)
  {
    Tensor<1, dim> x, center;
    if (place.is_mine())
      {
        const auto cell = owned_cells<Triangulation<dim>>(mesh)[place.cell];
        x      = MappingQ1<dim>().transform_unit_to_real_cell(cell, place.unit);
        center = cell->center();
      }
    return {Utilities::MPI::sum(place.is_mine() ? 1 : 0, MPI_COMM_WORLD),
            Point<dim>(Utilities::MPI::sum(x, MPI_COMM_WORLD)),
            Utilities::MPI::sum(center, MPI_COMM_WORLD)};
  }



  TYPED_TEST(MeshPoints, AreInOneCell)
  {
    constexpr int dim = TypeParam::value;
    for (const double shear : {0., 0.3})
      {
        const auto              mesh = locally_refined<dim>(shear);
        std::vector<Point<dim>> points;
        // Take vertices, which are corners of several cells, and other points.
        for (const auto &vertex : mesh->get_vertices())
          if (points.size() < 5 && vertex.norm() > 0.)
            points.push_back(vertex);
        for (unsigned int i = 1; i < 40; ++i)
          {
            Point<dim> x;
            for (unsigned int d = 0; d < dim; ++d)
              x[d] = std::fmod(0.37 + 0.618034 * i * (d + 1), 1.);
            if (shear > 0.)
              {
                const Point<dim> y = x;
                x[0] += shear * y[1] * y[dim - 1];
                x[dim - 1] += shear * y[0] * y[0];
              }
            points.push_back(x);
          }
        // All ranks ask for the same points.
        for (Point<dim> &x : points)
          x = Point<dim>(Utilities::MPI::broadcast(MPI_COMM_WORLD, x, 0));
        unsigned int n_inside = 0;
        const auto   found    = locate_points(*mesh, points);
        for (std::size_t i = 0; i < points.size(); ++i)
          {
            const Found<dim> place = seen_by_all(*mesh, found.points[i]);
            EXPECT_EQ(place.n_ranks, 1);
            // Cells have straight sides where the distorted body is curved.
            if (shear > 0. && found.distances[i] > 0.)
              {
                EXPECT_LT(found.distances[i], 0.02);
                EXPECT_NEAR(place.x.distance(points[i]),
                            found.distances[i],
                            1e-12);
                continue;
              }
            ++n_inside;
            EXPECT_EQ(found.distances[i], 0.);
            EXPECT_LT(place.x.distance(points[i]), 1e-9);
          }
        EXPECT_GT(n_inside, 3 * points.size() / 4);
      }
  }



  TYPED_TEST(MeshPoints, BetweenCellsBelongToTheOneWithTheLeastCenter)
  {
    constexpr int dim  = TypeParam::value;
    const auto    mesh = locally_refined<dim>(0.);
    Point<dim>    node, edge, hanging;
    for (unsigned int d = 0; d < dim; ++d)
      node[d] = 0.75;
    // The point is between a fine cell on the left and a coarse one.
    hanging    = Point<dim>();
    hanging[0] = 0.5;
    hanging[1] = 0.3;
    if (dim == 3)
      hanging[2] = 0.05;
    edge                 = node;
    edge[1]              = 0.6;
    const auto     found = locate_points(*mesh, {node, edge, hanging});
    Tensor<1, dim> expected_node, expected_edge;
    for (unsigned int d = 0; d < dim; ++d)
      expected_node[d] = expected_edge[d] = 0.625;
    const auto at = [&](const unsigned int i) {
      return seen_by_all(*mesh, found.points[i]).center;
    };
    EXPECT_LT((at(0) - expected_node).norm(), 1e-12);
    EXPECT_LT((at(1) - expected_edge).norm(), 1e-12);
    EXPECT_LT(std::abs(at(2)[0] - 0.4375), 1e-12); // center of the fine cell
    // A neighbor's center has the larger x, whatever its size.
    EXPECT_LT(at(2)[0], hanging[0]);
  }



  TYPED_TEST(MeshPoints, OutsideAreAtTheNearestPlace)
  {
    constexpr int           dim  = TypeParam::value;
    const auto              mesh = locally_refined<dim>(0.);
    std::vector<Point<dim>> points(3), nearest(3);
    for (unsigned int d = 0; d < dim; ++d)
      {
        points[0][d]  = d == 0 ? 1.5 : 0.3; // beside a face
        nearest[0][d] = d == 0 ? 1. : 0.3;
        points[1][d]  = -2.; // beyond a corner
        nearest[1][d] = 0.;
        points[2][d] = nearest[2][d] = 0.4; // inside
      }
    const auto   found = locate_points(*mesh, points);
    const double distances[]{0.5, 2. * std::sqrt(dim), 0.};
    for (unsigned int i = 0; i < 3; ++i)
      {
        const Found<dim> place = seen_by_all(*mesh, found.points[i]);
        EXPECT_EQ(place.n_ranks, 1);
        EXPECT_LT(place.x.distance(nearest[i]), 1e-9);
        EXPECT_NEAR(found.distances[i], distances[i], 1e-9);
      }
    std::ostringstream sentence;
    sentence << "'Output/Points': the point (" << points[0]
             << ") does not lie in the body; the nearest place that does is ("
             << nearest[0] << ").";
    expect_refusal([&] { check_points(*mesh, points, "Output/Points"); },
                   sentence.str());
    check_points(*mesh, {points[2]}, "Output/Points");
  }



  TYPED_TEST(MeshPoints, AreOnTheBoundaryThatIsAskedFor)
  {
    constexpr int dim = TypeParam::value;
    // The mesh is distorted in 3D only: the map bends the square's lower side.
    const auto mesh  = locally_refined<dim>(dim == 3 ? 0.3 : 0.);
    const auto cells = owned_cells<Triangulation<dim>>(*mesh);
    // Points in the plane x_1 = 0, which the map leaves flat, and off it.
    std::vector<Point<dim>> points(3);
    points[0][0] = 0.7;
    points[1][0] = 0.25; // a vertex
    points[2]    = points[0];
    points[2][1] = 0.01;
    if (dim == 3)
      for (Point<dim> &x : points)
        x[2] = 0.3 * x[0] * x[0] + 0.5;
    const auto found = locate_on_boundary(*mesh, points, {2});
    for (unsigned int i = 0; i < 3; ++i)
      {
        const Found<dim> place = seen_by_all(*mesh, found.points[i]);
        EXPECT_EQ(place.n_ranks, i < 2 ? 1 : 0);
        EXPECT_EQ(found.distances[i] == 0., i < 2);
        if (found.points[i].is_mine())
          {
            EXPECT_EQ(cells[found.points[i].cell]
                        ->face(found.points[i].face)
                        ->boundary_id(),
                      2u);
            EXPECT_LT(place.x.distance(points[i]), 1e-7);
          }
      }
    for (const auto &place : locate_on_boundary(*mesh, points, {3}).points)
      EXPECT_FALSE(place.is_mine());
  }
} // namespace
