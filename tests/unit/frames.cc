// SPDX-License-Identifier: LGPL-2.1-or-later

// The space of admissible displacements: nodal frames, pieces that meet,
// hanging nodes on oblique contact planes.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_tools.h>

#include "oblique_bodies.h"
#include "refusals.h"

#include <cmath>
#include <set>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class Frames : public testing::Test
  {};
  TYPED_TEST_SUITE(Frames, Dimensions, );



  template <int dim>
  Tensor<1, dim>
  column(const Tensor<2, dim> &matrix, const unsigned int j)
  {
    Tensor<1, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i] = matrix[i][j];
    return result;
  }



  template <int dim>
  std::string
  corner_scene(const std::string &contact, const std::string &elsewhere)
  {
    std::string text = corner<dim>() + boundary(0, contact) +
                       boundary(1, elsewhere) + boundary(2, contact) +
                       boundary(3, elsewhere);
    for (unsigned int id = 4; id < 2 * dim; ++id)
      text += boundary(id, id == 4 ? "set Role = symmetry" : "set Role = free");
    return text;
  }



  TYPED_TEST(Frames, BilateralCornerLeavesTheCommonEdge)
  {
    constexpr int dim = TypeParam::value;
    for (const unsigned int refinements : {0, 2})
      {
        Body<dim> body(corner_scene<dim>(tresca, "set Role = free"));
        body.triangulation.refine_global(refinements);
        body.set_up();
        unsigned int n_edge = 0, n_flat = 0;
        for (const auto &node : body.space->boundary_nodes())
          {
            const NodalFrame<dim> &frame = body.space->frame(node.frame);
            // Symmetry at z = 0 also holds the end of the edge.
            const bool at_end = dim == 3 && node.position[dim - 1] == 0.;
            if (on_edge(node.position))
              {
                ++n_edge;
                EXPECT_EQ(frame.n_fixed, at_end ? 3u : 2u);
                EXPECT_EQ(frame.planes.size(), dim == 3 && !at_end ? 1u : 0u);
                if (dim == 3 && !at_end && frame.planes.size() == 1)
                  {
                    const FrictionPlane<dim> &plane = frame.planes[0];
                    EXPECT_EQ(plane.n_tangents, 1u);
                    // The friction of both pieces along the edge adds up.
                    EXPECT_EQ(
                      std::set<types::boundary_id>(plane.boundary_ids.begin(),
                                                   plane.boundary_ids.end()),
                      (std::set<types::boundary_id>{0, 2}));
                    const Tensor<1, dim> slip_direction =
                      frame.directions * plane.map[0];
                    EXPECT_NEAR(std::abs(slip_direction[dim - 1]), 1., 1e-14);
                  }
              }
            else if (frame.planes.size() == 1 && !at_end)
              {
                ++n_flat;
                EXPECT_EQ(frame.n_fixed, 1u);
                EXPECT_EQ(frame.planes[0].n_tangents, dim - 1u);
              }
          }
        EXPECT_EQ(Utilities::MPI::sum(n_edge, MPI_COMM_WORLD),
                  dim == 2 ? 1u : 1u + (1u << refinements));
        EXPECT_GT(Utilities::MPI::sum(n_flat, MPI_COMM_WORLD), 0u);
      }
  }



  TYPED_TEST(Frames, BilateralCornerTakesBothFoundations)
  {
    // At the corner both normal displacements are prescribed, not a mean, which
    // determines the displacement there.
    constexpr int dim = TypeParam::value;
    Body<dim>     body(
      corner<dim>() +
      boundary(0, tresca + "set Foundation displacement = 0.3*t") +
      boundary(1, "set Role = free") +
      boundary(2, tresca + "set Foundation displacement = -0.1*t") +
      boundary(3, "set Role = free") +
      (dim == 3 ?
             boundary(4, "set Role = symmetry") + boundary(5, "set Role = free") :
             ""));
    body.set_up();
    DistributedVector in_frames = body.rough_unknowns();
    body.space->set_prescribed(2., in_frames);
    DistributedVector u = body.space->ghosted_vector();
    body.space->to_cartesian(in_frames, u);
    for (const auto &cell : body.dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int v : cell->vertex_indices())
          if (on_edge(cell->vertex(v)))
            {
              Tensor<1, dim> at_node;
              for (unsigned int d = 0; d < dim; ++d)
                at_node[d] = u(cell->vertex_dof_index(v, d));
              EXPECT_NEAR(at_node * body.scene.boundary.at(0).normal,
                          0.6,
                          1e-14);
              EXPECT_NEAR(at_node * body.scene.boundary.at(2).normal,
                          -0.2,
                          1e-14);
            }
  }



  TYPED_TEST(Frames, CornerWithGivenNormalStressHasAPointForEachPiece)
  {
    constexpr int dim = TypeParam::value;
    Body<dim>     body(corner_scene<dim>(coulomb, "set Role = clamped"));
    body.triangulation.refine_global(1);
    body.set_up();
    unsigned int n_edge = 0;
    for (const auto &node : body.space->boundary_nodes())
      if (on_edge(node.position) && (dim == 2 || node.position[dim - 1] > 0.))
        {
          ++n_edge;
          const NodalFrame<dim> &frame = body.space->frame(node.frame);
          EXPECT_EQ(frame.n_fixed, 0u);
          ASSERT_EQ(frame.planes.size(), 2u);
          for (const auto &plane : frame.planes)
            {
              ASSERT_EQ(plane.boundary_ids.size(), 1u);
              EXPECT_EQ(plane.n_tangents, dim - 1u);
              const Tensor<1, dim> normal =
                body.scene.boundary.at(plane.boundary_ids[0]).normal;
              for (unsigned int i = 0; i < plane.n_tangents; ++i)
                {
                  const Tensor<1, dim> row = frame.directions * plane.map[i];
                  EXPECT_NEAR(row * normal, 0., 1e-14);
                  EXPECT_NEAR(row.norm(), 1., 1e-14);
                }
            }
        }
    EXPECT_EQ(Utilities::MPI::sum(n_edge, MPI_COMM_WORLD), dim == 2 ? 1u : 2u);
  }



  TYPED_TEST(Frames, HangingNodesOnAnObliquePlaneKeepTheNormalDisplacement)
  {
    constexpr int dim = TypeParam::value;
    // A displacement that is linear in space is exact at hanging nodes.
    const auto body = rotated_body<dim>(
      tresca + "set Foundation displacement = (0.2 + 0.1*x - 0.3*y)*t");
    const auto d = [](const Point<dim> &x) {
      return (0.2 + 0.1 * x[0] - 0.3 * x[1]) * 1.5;
    };
    DistributedVector in_frames = body->rough_unknowns();
    body->space->set_prescribed(1.5, in_frames);
    DistributedVector u = body->space->ghosted_vector();
    body->space->to_cartesian(in_frames, u);

    const Tensor<1, dim> normal = body->scene.boundary.at(2).normal;
    unsigned int         n = 0, n_hanging = 0;
    double               tangential = 0.;
    for_each_vertex_on(*body, 2, [&](const Point<dim> &x, const auto dof) {
      Tensor<1, dim> at_node;
      for (unsigned int c = 0; c < dim; ++c)
        at_node[c] = u(dof + c);
      EXPECT_NEAR(at_node * normal, d(x), 1e-14);
      tangential += (at_node - (at_node * normal) * normal).norm();
      n_hanging += body->space->cartesian_hanging_nodes().is_constrained(dof);
      ++n;
    });
    EXPECT_GT(Utilities::MPI::sum(n, MPI_COMM_WORLD), 8u);
    EXPECT_GT(Utilities::MPI::sum(tangential, MPI_COMM_WORLD), 1.);
    if (dim == 3)
      {
        EXPECT_GT(Utilities::MPI::sum(n_hanging, MPI_COMM_WORLD), 0u);
      }
    // Vertices on the clamped side are exactly at rest.
    for_each_vertex_on(*body, 3, [&](const Point<dim> &, const auto dof) {
      for (unsigned int c = 0; c < dim; ++c)
        EXPECT_EQ(u(dof + c), 0.);
    });
  }



  TYPED_TEST(Frames, CartesianAndBack)
  {
    constexpr int           dim       = TypeParam::value;
    const auto              body      = rotated_body<dim>(tresca);
    const DistributedVector u         = body->rough_vector();
    DistributedVector       in_frames = body->space->owned_vector(),
                      back            = body->space->ghosted_vector();
    body->space->to_frames(u, in_frames);
    body->space->to_cartesian(in_frames, back);
    for (const auto i : body->space->relevant)
      EXPECT_NEAR(u(i), back(i), 1e-14);

    // Frames are rotations: some node is rotated, and no frame changes lengths.
    bool rotated = false;
    for (const auto &node : body->space->boundary_nodes())
      {
        const NodalFrame<dim> &frame = body->space->frame(node.frame);
        rotated |= !frame.is_cartesian;
        const Tensor<2, dim> product =
          transpose(frame.directions) * frame.directions;
        EXPECT_LT(
          (product - Tensor<2, dim>(unit_symmetric_tensor<dim>())).norm(),
          1e-14);
      }
    EXPECT_GT(Utilities::MPI::sum(rotated ? 1 : 0, MPI_COMM_WORLD), 0);
  }



  TYPED_TEST(Frames, AlongAxesNothingIsRotated)
  {
    constexpr int dim  = TypeParam::value;
    std::string   text = box<dim>(2);
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id,
                       id == 2 ? tresca :
                       id == 3 ? "set Role = clamped" :
                       id == 0 ? "set Role = symmetry" :
                                 "set Role = free");
    Body<dim> body(text);
    body.set_up();
    for (const auto &node : body.space->boundary_nodes())
      EXPECT_TRUE(body.space->frame(node.frame).is_cartesian);
  }



  TYPED_TEST(Frames, LoadsPassFromHangingNodesToTheirMasters)
  {
    // The work of a load on an admissible displacement is the same in Cartesian
    // components and in frames without hanging nodes.
    constexpr int           dim  = TypeParam::value;
    const auto              body = rotated_body<dim>(tresca);
    const DistributedVector u    = body->rough_vector(0.2);
    // The Cartesian load has 1 + dof mod 7 in each owned entry.
    std::vector<double> cartesian(body->space->relevant.n_elements());
    double              work = 0.;
    for (const auto i : body->space->owned)
      {
        const double share                                   = 1. + i % 7;
        cartesian[body->space->relevant.index_within_set(i)] = share;
        work += share * u(i);
      }
    DistributedVector load = body->space->owned_vector(), in_frames = load;
    body->space->add_cartesian_load(cartesian, load);
    body->space->to_frames(u, in_frames);
    EXPECT_NEAR(load * in_frames,
                Utilities::MPI::sum(work, MPI_COMM_WORLD),
                1e-11);
  }



  TYPED_TEST(Frames, RigidMotionsThatAreLeftAreNamed)
  {
    constexpr int dim = TypeParam::value;
    const auto    refuse =
      [](const std::function<std::string(unsigned int)> &entries,
         const std::string                              &motion) {
        std::string text = box<dim>(2);
        for (unsigned int id = 0; id < 2 * dim; ++id)
          text += boundary(id, entries(id));
        Body<dim> body(text);
        expect_refusal([&] { body.set_up(); }, motion);
      };
    // Friction alone does not hold a body.
    refuse(
      [](const unsigned int id) {
        return id == 2 ? tresca : std::string("set Role = free");
      },
      "translation along x");
    refuse(
      [](const unsigned int id) {
        return id == 2 ? "set Role = symmetry" : "set Role = free";
      },
      dim == 2 ? "leave a rigid motion free: translation along x." :
                 "rotation about y");
    refuse([](const unsigned int) { return "set Role = free"; },
           "rotation about z");
    // One component is held at two sides.
    refuse(
      [](const unsigned int id) {
        return id < 2 ? dim == 2 ? "set Role = displacement\n"
                                   "set Displacement = 0; free" :
                                   "set Role = displacement\n"
                                   "set Displacement = 0; free; 0" :
                        "set Role = free";
      },
      "leave a rigid motion free: translation along y.");
    // Planes of symmetry in all directions suffice.
    std::string text = box<dim>(2);
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text +=
        boundary(id, id % 2 == 0 ? "set Role = symmetry" : "set Role = free");
    EXPECT_EQ(message_of([&] { Body<dim>(text).set_up(); }), "");
  }



  TYPED_TEST(Frames, RigidBodyModesCostNoEnergy)
  {
    constexpr int dim = TypeParam::value;
    // Only one side of a corner cell has conditions: rows far from it are free.
    const auto        body = rotated_body<dim>(coulomb);
    DistributedMatrix matrix;
    assemble_elastic_matrix(*body->space, *body->moduli, false, matrix);
    const auto modes = body->space->rigid_body_modes();
    EXPECT_EQ(modes.size(), dim == 2 ? 3u : 6u);
    for (const auto &mode : modes)
      {
        // K times a mode vanishes except beside excluded components, on which
        // modes are zero.
        DistributedVector product = body->space->owned_vector();
        matrix.vmult(product, mode);
        const Tensor<1, dim> up = -body->scene.boundary.at(2).normal;
        const Point<dim>     origin =
          body->triangulation.begin(0)->vertex(0); // on the contact plane
        double far = 0., largest = 0.;
        for (const auto &cell : body->dof_handler.active_cell_iterators())
          if (cell->is_locally_owned())
            for (const unsigned int v : cell->vertex_indices())
              for (unsigned int d = 0; d < dim; ++d)
                {
                  const auto dof = cell->vertex_dof_index(v, d);
                  if (!body->space->owned.is_element(dof) ||
                      body->space
                        ->excluded()[body->space->owned.index_within_set(dof)])
                    continue;
                  largest = std::max(largest, std::abs(mode(dof)));
                  if ((cell->vertex(v) - origin) * up < 0.49)
                    far = std::max(far, std::abs(product(dof)));
                }
        EXPECT_LT(Utilities::MPI::max(far, MPI_COMM_WORLD), 1e-13);
        EXPECT_GT(Utilities::MPI::max(largest, MPI_COMM_WORLD), 0.1);
      }
  }



  // ---------------------------------------------------------- friction points
} // namespace
