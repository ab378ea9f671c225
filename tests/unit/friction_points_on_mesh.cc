// SPDX-License-Identifier: LGPL-2.1-or-later

// The points of friction on the mesh: bounds, slips and forces with hanging
// nodes and where pieces meet.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include "oblique_bodies.h"

#include <cmath>
#include <set>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class FrictionPoints : public testing::Test
  {};
  TYPED_TEST_SUITE(FrictionPoints, Dimensions, );



  TYPED_TEST(FrictionPoints, BoundsAddUpToTheIntegralWithHangingNodes)
  {
    constexpr int dim = TypeParam::value;
    // rho is linear in space: two Gauss points integrate rho phi exactly.
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
    // A corner of 150 degrees with bounds 1 and 3: in 3D its edge has the
    // bounds of both pieces, in 2D the corner has no friction.
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
    // Sides have length 1 and four cells. The corner lacks 1/8 of a side, in 3D
    // the end of the edge at the symmetry plane 1/8 of that.
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

        ContactState      state(face.bounds(0.));
        Tensor<1, dim>    sum;
        DistributedVector in_frames = body->space->owned_vector();
        body->space->to_frames(body->rough_vector(), in_frames);
        const auto slips = face.slips(in_frames);
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
