// SPDX-License-Identifier: LGPL-2.1-or-later

// The space of admissible displacements: nodal frames, pieces that meet,
// hanging nodes on oblique contact planes; and the friction points on it.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_tools.h>

#include "body.h"
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



  /// A quadrilateral (times (0,1)) with a corner of 150 degrees at the origin;
  /// the sides there are boundaries 0 and 2, the others 1 and 3 (4 and 5).
  template <int dim>
  std::string
  corner()
  {
    const double      c = std::cos(5. * numbers::PI / 6.);
    std::stringstream text;
    text.precision(17);
    for (const unsigned int z : {0, 1})
      if (z == 0 || dim == 3)
        {
          const std::string end =
            dim == 3 ? ", " + std::to_string(z) : std::string();
          text << (z == 1 ? "; " : "") << "0, 0" << end << "; 1, 0" << end
               << "; " << c << ", 0.5" << end << "; 0.25, 1.25" << end;
        }
    text << " : true";
    return geometry("general_cell", text.str());
  }



  const std::string tresca = "set Role = contact\nset Friction law = tresca\n"
                             "set Friction bound = 1\n";
  const std::string coulomb =
    "set Role = contact\nset Friction law = coulomb\n"
    "set Friction coefficient = 0.5\nset Normal stress = -1\n";



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



  template <int dim>
  bool
  on_edge(const Point<dim> &x)
  {
    return x[0] * x[0] + x[1] * x[1] < 1e-20;
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
            // Symmetry at z = 0 takes the rest of the edge's end.
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
                    // Both pieces rub along the edge: their bounds add up.
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
    // Both normal displacements are prescribed at the corner, not their mean:
    // the displacement there is the one that has them.
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



  /// A rotated box, refined near one corner of its contact face (boundary 2).
  template <int dim>
  std::unique_ptr<Body<dim>>
  rotated_body(const std::string &contact,
               const std::string &top = "set Role = clamped")
  {
    std::string text = box<dim>(2, oblique<dim>());
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text += boundary(id,
                       id == 2 ? contact :
                       id == 3 ? top :
                                 "set Role = free");
    auto             body   = std::make_unique<Body<dim>>(text);
    const Point<dim> marked = body->triangulation.begin(0)->vertex(0);
    for (const double radius : {0.9, 0.5})
      body->refine_where([&marked, radius](const Point<dim> &x) {
        return (x - marked).norm() < radius;
      });
    body->set_up();
    return body;
  }



  /// Call visit(x, dof) for each vertex of owned faces of a boundary.
  template <int dim, typename Visitor>
  void
  for_each_vertex_on(const Body<dim>         &body,
                     const types::boundary_id id,
                     const Visitor           &visit)
  {
    for (const auto &cell : body.dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->at_boundary(f) && cell->face(f)->boundary_id() == id)
            for (const unsigned int v : cell->face(f)->vertex_indices())
              visit(cell->face(f)->vertex(v),
                    cell->face(f)->vertex_dof_index(v, 0));
  }



  TYPED_TEST(Frames, HangingNodesOnAnObliquePlaneKeepTheNormalDisplacement)
  {
    constexpr int dim = TypeParam::value;
    // Linear in space: hanging nodes can have it exactly.
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
    // The clamped side, too.
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

    // Frames are rotations: in 3D and 2D some node has one, and none changes
    // lengths.
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
    // The work of a load on an admissible displacement does not depend on the
    // form they have.
    constexpr int           dim  = TypeParam::value;
    const auto              body = rotated_body<dim>(tresca);
    const DistributedVector u    = body->rough_vector(0.2);
    // Shares of the owned cells, 1 + dof mod 7 for each owned entry.
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
    // Friction does not hold a body.
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
    // One component held at two sides.
    refuse(
      [](const unsigned int id) {
        return id < 2 ? dim == 2 ? "set Role = displacement\n"
                                   "set Displacement = 0; free" :
                                   "set Role = displacement\n"
                                   "set Displacement = 0; free; 0" :
                        "set Role = free";
      },
      "leave a rigid motion free: translation along y.");
    // Enough.
    std::string text = box<dim>(2);
    for (unsigned int id = 0; id < 2 * dim; ++id)
      text +=
        boundary(id, id % 2 == 0 ? "set Role = symmetry" : "set Role = free");
    EXPECT_EQ(message_of([&] { Body<dim>(text).set_up(); }), "");
  }



  TYPED_TEST(Frames, RigidBodyModesCostNoEnergy)
  {
    constexpr int dim = TypeParam::value;
    // No condition but on one corner cell's side: rows far from it are free.
    const auto        body = rotated_body<dim>(coulomb);
    DistributedMatrix matrix;
    assemble_elastic_matrix(*body->space, *body->moduli, false, matrix);
    const auto modes = body->space->rigid_body_modes();
    EXPECT_EQ(modes.size(), dim == 2 ? 3u : 6u);
    for (const auto &mode : modes)
      {
        // Where no neighbor is clamped, K times the mode vanishes: the modes
        // are zero on excluded components only.
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

  template <typename Dimension>
  class FrictionPoints : public testing::Test
  {};
  TYPED_TEST_SUITE(FrictionPoints, Dimensions, );



  TYPED_TEST(FrictionPoints, BoundsAddUpToTheIntegralWithHangingNodes)
  {
    constexpr int dim = TypeParam::value;
    // Linear in space: two Gauss points integrate rho phi exactly.
    const auto body =
      rotated_body<dim>("set Role = contact\nset Friction law = tresca\n"
                        "set Friction bound = (1.5 + 0.2*x - 0.1*y)*t");
    const ContactFace<dim> &face = *body->face;

    double            integral = 0., area = 0.;
    FEFaceValues<dim> values(body->fe,
                             QGauss<dim - 1>(3),
                             update_quadrature_points | update_JxW_values);
    for (const auto &cell : body->dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->at_boundary(f) && cell->face(f)->boundary_id() == 2)
            {
              values.reinit(cell, f);
              for (const unsigned int q : values.quadrature_point_indices())
                {
                  const Point<dim> x = values.quadrature_point(q);
                  integral += (1.5 + 0.2 * x[0] - 0.1 * x[1]) * values.JxW(q);
                  area += values.JxW(q);
                }
            }
    integral = Utilities::MPI::sum(integral, MPI_COMM_WORLD);
    area     = Utilities::MPI::sum(area, MPI_COMM_WORLD);

    EXPECT_NEAR(area, 2., 1e-12);
    const auto sum = [](const std::vector<double> &v) {
      double result = 0.;
      for (const double x : v)
        result += x;
      return Utilities::MPI::sum(result, MPI_COMM_WORLD);
    };
    EXPECT_NEAR(sum(face.weights()), area, 1e-12);
    EXPECT_NEAR(sum(face.bounds(1.)), integral, 1e-12);
    EXPECT_NEAR(sum(face.bounds(2.)), 2. * integral, 1e-12);
    for (const double weight : face.weights())
      EXPECT_GT(weight, 0.);

    // Hanging nodes carry no point: the points are the other vertices.
    std::set<types::global_dof_index> vertices;
    for_each_vertex_on(*body, 2, [&](const Point<dim> &, const auto dof) {
      if (!body->space->cartesian_hanging_nodes().is_constrained(dof) &&
          body->space->owned.is_element(dof))
        vertices.insert(dof);
    });
    EXPECT_EQ(vertices.size(), face.layout().points.size());
    EXPECT_EQ(Utilities::MPI::sum(vertices.size(), MPI_COMM_WORLD),
              face.n_global_points());
    EXPECT_EQ(face.layout().n_dofs(), face.layout().points.size() * (dim - 1));
  }



  TYPED_TEST(FrictionPoints, BoundsFollowTime)
  {
    constexpr int dim = TypeParam::value;
    for (const bool constant : {true, false})
      {
        const auto body = rotated_body<dim>(
          std::string("set Role = contact\nset Friction law = coulomb\n"
                      "set Friction coefficient = 0.3\nset Normal stress = ") +
          (constant ? "-2" : "-2*t"));
        for (const double t : {1., 3., 2.})
          {
            const auto bounds = body->face->bounds(t);
            for (unsigned int p = 0; p < bounds.size(); ++p)
              EXPECT_NEAR(bounds[p],
                          body->face->weights()[p] * 0.6 * (constant ? 1. : t),
                          1e-14);
          }
      }
  }



  TYPED_TEST(FrictionPoints, PiecesThatMeetShareTheEdge)
  {
    // The corner of 150 degrees with bounds 1 and 3: in 3D the edge has the
    // bounds of both, in 2D nobody has its share.
    constexpr int dim = TypeParam::value;
    Body<dim>     body(
      corner<dim>() + boundary(0, tresca) + boundary(1, "set Role = free") +
      boundary(2,
               "set Role = contact\nset Friction law = tresca\n"
                   "set Friction bound = 3") +
      boundary(3, "set Role = free") +
      (dim == 3 ?
             boundary(4, "set Role = symmetry") + boundary(5, "set Role = free") :
             ""));
    body.triangulation.refine_global(2);
    body.set_up();
    double       total = 0., edge = 0.;
    const auto   bounds = body.face->bounds(0.);
    const auto  &points = body.face->layout().points;
    unsigned int n_edge = 0;
    for (unsigned int p = 0; p < points.size(); ++p)
      {
        total += bounds[p];
        if (on_edge(body.face->position(points[p].node)))
          {
            edge += bounds[p];
            ++n_edge;
          }
      }
    total  = Utilities::MPI::sum(total, MPI_COMM_WORLD);
    edge   = Utilities::MPI::sum(edge, MPI_COMM_WORLD);
    n_edge = Utilities::MPI::sum(n_edge, MPI_COMM_WORLD);
    // Sides of length 1 in four cells; lost at the corner is 1/8 a side, and in
    // 3D what the edge's end at the symmetry plane has, 1/8 of that.
    if (dim == 2)
      {
        EXPECT_EQ(n_edge, 0u);
        EXPECT_NEAR(total, 4. * 7. / 8., 1e-12);
      }
    else
      {
        EXPECT_EQ(n_edge, 4u);
        EXPECT_NEAR(edge, 4. / 8. * 7. / 8., 1e-12);
        EXPECT_NEAR(total, 4. - 4. / 64., 1e-12);
      }
  }



  TYPED_TEST(FrictionPoints, SlipsForcesAndDensitiesAgree)
  {
    constexpr int dim = TypeParam::value;
    for (const std::string &contact : {tresca, coulomb})
      {
        const auto              body   = rotated_body<dim>(contact);
        const ContactFace<dim> &face   = *body->face;
        const Tensor<1, dim>    normal = body->scene.boundary.at(2).normal;
        const unsigned int      n      = face.layout().points.size();

        FrictionState     state(face.bounds(0.));
        Tensor<1, dim>    sum;
        DistributedVector in_frames = body->space->owned_vector();
        body->space->to_frames(body->rough_vector(), in_frames);
        const auto slips = face.slips(in_frames, {});
        for (unsigned int p = 0; p < n; ++p)
          {
            for (unsigned int i = 0; i < dim - 1; ++i)
              state.multiplier[p][i] = std::sin(1. + 3. * p + i);
            const Tensor<1, dim> force = face.cartesian(p, state.multiplier[p]);
            EXPECT_NEAR(force * normal, 0., 1e-14);
            EXPECT_NEAR(force.norm(), state.multiplier[p].norm(), 1e-14);
            // The slip is the tangential part of the displacement there.
            Tensor<1, dim> u;
            for (unsigned int d = 0; d < dim; ++d)
              u[d] = std::sin(37. * face.position(p)[0] +
                              53. * (d + 1.) * face.position(p)[1] +
                              71. * face.position(p)[dim - 1] + d);
            EXPECT_LT((face.cartesian(p, slips[p]) -
                       (u - (u * normal) * normal))
                        .norm(),
                      1e-13);
            sum += force;
          }
        sum = Utilities::MPI::sum(sum, MPI_COMM_WORLD);
        EXPECT_LT((sum - face.resultant(state)).norm(), 1e-12);

        const auto back = face.multipliers(face.density(state));
        for (unsigned int p = 0; p < n; ++p)
          EXPECT_LT((back[p] - state.multiplier[p]).norm(), 1e-13);
      }
  }
} // namespace
