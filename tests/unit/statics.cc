// SPDX-License-Identifier: LGPL-2.1-or-later

// Bodies that only contact holds: whether it can balance loads, with a proof.

#include "random.h"
#include <viscoplastic_contact/contact/statics.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  constexpr double accuracy = 1e-9;

  /// A rigid body with an obstacle and a point of friction at each node.
  struct RigidBody
  {
    const unsigned int               dim;
    ContactLayout                    face;
    std::vector<Tensor<1, 3>>        positions;
    std::vector<double>              bounds;
    std::vector<std::vector<double>> bounds_of_pressure;

    explicit RigidBody(const unsigned int dim)
      : dim(dim)
    {
      face.has_obstacles = true;
    }

    void
    add_node(const Tensor<1, 3> &position,
             const Tensor<1, 3> &normal,
             const double        bound,
             const double        coefficient)
    {
      ContactLayout::Point friction, obstacle;
      friction.node = obstacle.node = face.n_nodes();
      friction.n_tangents           = dim - 1;
      obstacle.n_tangents           = 1;
      obstacle.is_obstacle          = true;
      obstacle.map[0]               = normal;
      if (dim == 2)
        {
          friction.map[0][0] = -normal[1];
          friction.map[0][1] = normal[0];
        }
      else
        {
          Tensor<1, 3> other;
          other[std::abs(normal[0]) < 0.6 ? 0 : 1] = 1.;
          friction.map[0] = cross_product_3d(normal, other);
          friction.map[0] /= friction.map[0].norm();
          friction.map[1] = cross_product_3d(normal, friction.map[0]);
        }
      face.first_dof.push_back(face.first_dof.back() + dim);
      face.points.push_back(friction);
      face.points.push_back(obstacle);
      face.first_point.push_back(face.points.size());
      positions.push_back(position);
      bounds.insert(bounds.end(), {bound, 0.});
      bounds_of_pressure.push_back({coefficient});
      bounds_of_pressure.push_back({0.});
    }

    HeldBody
    with_load(const std::vector<double> &load) const
    {
      HeldBody result{face, {}, load, 0.};
      for (const double work : load)
        result.load_size += std::abs(work);
      for (unsigned int k = 0; k < n_motions(); ++k)
        {
          Vector<double> motion(face.n_dofs());
          for (unsigned int n = 0; n < face.n_nodes(); ++n)
            face.set_node_values(displacement(k, positions[n]), n, motion);
          result.motions.push_back(motion);
        }
      return result;
    }

    unsigned int
    n_motions() const
    {
      return dim == 2 ? 3 : 6;
    }

    Tensor<1, 3>
    displacement(const unsigned int k, const Tensor<1, 3> &x) const
    {
      Tensor<1, 3> u, axis;
      if (k < dim)
        u[k] = 1.;
      else
        {
          axis[dim == 2 ? 2 : k - 3] = 1.;
          u                          = cross_product_3d(axis, x);
        }
      return u;
    }

    Tensor<1, 3>
    displacement(const std::vector<double> &motion, const Tensor<1, 3> &x) const
    {
      Tensor<1, 3> u;
      for (unsigned int k = 0; k < n_motions(); ++k)
        u += motion[k] * displacement(k, x);
      return u;
    }
  };



  TEST(Statics, EachAnswerIsProven)
  {
    Random random(1);
    for (unsigned int trial = 0; trial < 1500; ++trial)
      {
        SCOPED_TRACE("trial " + std::to_string(trial));
        const unsigned int dim        = 2 + trial % 2;
        const bool         is_flat    = random.uniform(0., 1.) < 0.5;
        const bool         is_coulomb = random.uniform(0., 1.) < 0.5;
        const bool         is_made    = random.uniform(0., 1.) < 0.5;
        const bool         on_edge    = random.uniform(0., 1.) < 0.5;
        RigidBody          body(dim);
        const unsigned int n_nodes = random.uniform(1., 12.);
        for (unsigned int n = 0; n < n_nodes; ++n)
          {
            Tensor<1, 3> x, normal;
            for (unsigned int d = 0; d < dim; ++d)
              {
                x[d]      = random.uniform(-1., 1.);
                normal[d] = random.uniform(-1., 1.);
              }
            if (is_flat)
              {
                normal    = 0.;
                normal[0] = 1.;
                x[0]      = 0.;
              }
            body.add_node(x,
                          normal / normal.norm(),
                          is_coulomb ? 0. : random.uniform(0., 2.),
                          is_coulomb ? random.uniform(0., 1.) : 0.);
          }
        if (!is_coulomb)
          body.bounds_of_pressure.clear();

        // The load is that of contact forces within their bounds, or random.
        std::vector<double> load(body.n_motions());
        for (double &work : load)
          work = is_made ? 0. : random.uniform(-1., 1.);
        if (is_made)
          for (unsigned int n = 0; n < n_nodes; ++n)
            {
              const double p = std::max(0., random.uniform(-1., 1.));
              const double bound =
                (is_coulomb ? body.bounds_of_pressure[2 * n][0] * p :
                              body.bounds[2 * n]) *
                (on_edge ? 1. : random.uniform(0., 1.));
              const double angle = random.uniform(0., 6.);
              Tensor<1, 2> multiplier;
              multiplier[0] =
                bound * (dim == 2 ? (angle > 3. ? 1. : -1.) : std::cos(angle));
              if (dim == 3)
                multiplier[1] = bound * std::sin(angle);
              for (unsigned int k = 0; k < load.size(); ++k)
                {
                  const auto u = body.displacement(k, body.positions[n]);
                  load[k] += p * (body.face.points[2 * n + 1].map[0] * u) +
                             multiplier * slip(body.face.points[2 * n], u);
                }
            }
        const HeldBody held = body.with_load(load);
        const Statics  statics =
          balance(held, body.bounds, body.bounds_of_pressure, accuracy);
        if (is_made)
          {
            EXPECT_TRUE(statics.is_balanced);
          }
        if (statics.is_balanced)
          {
            for (const double p : statics.pressures)
              EXPECT_GE(p, 0.);
            continue;
          }
        double work = 0., size = 0.;
        for (unsigned int k = 0; k < load.size(); ++k)
          {
            work += statics.motion[k] * load[k];
            size += std::abs(statics.motion[k]);
          }
        for (unsigned int n = 0; n < n_nodes; ++n)
          {
            const auto u = body.displacement(statics.motion, body.positions[n]);
            const double s       = slip(body.face.points[2 * n], u).norm();
            double       entered = body.face.points[2 * n + 1].map[0] * u;
            if (is_coulomb)
              entered += body.bounds_of_pressure[2 * n][0] * s;
            else
              work -= body.bounds[2 * n] * s;
            EXPECT_LT(entered, 1e-6 * size);
          }
        EXPECT_GT(work, 0.);
      }
  }



  TEST(Statics, BlockOnTheGround)
  {
    // Nodes are from -1 to 1 on y = 0; the last load is the moment about 0.
    RigidBody block(2);
    for (int i = -4; i <= 4; ++i)
      {
        Tensor<1, 3> x, down;
        x[0]    = i / 4.;
        down[1] = -1.;
        block.add_node(x, down, 0., 0.5);
      }
    const auto is_balanced = [&](const std::vector<double> &load,
                                 const double               bound) {
      return balance(block.with_load(load),
                     std::vector<double>(block.bounds.size(), bound),
                     bound > 0. ? std::vector<std::vector<double>>() :
                                  block.bounds_of_pressure,
                     accuracy)
        .is_balanced;
    };
    for (const double scale : {1e-30, 1., 1e30})
      {
        const auto times = [scale](std::vector<double> load) {
          for (double &work : load)
            work *= scale;
          return load;
        };
        EXPECT_TRUE(is_balanced(times({0., -1., 0.}), 0.));
        EXPECT_FALSE(is_balanced(times({0., 1e-5, 0.}), 0.));
        EXPECT_TRUE(is_balanced(times({0.5, -1., 0.}), 0.));
        EXPECT_FALSE(is_balanced(times({0.50001, -1., 0.}), 0.));
        EXPECT_TRUE(is_balanced(times({0.49, -1., 0.999}), 0.));
        EXPECT_FALSE(is_balanced(times({0.1, -1., 1.00001}), 0.));
        // The resultant is beyond the end of the block by little, or by less
        // than the accuracy.
        EXPECT_FALSE(is_balanced(times({0., -1., 1. + 1e-8}), 0.));
        EXPECT_TRUE(is_balanced(times({0., -1., 1. + 1e-10}), 0.));
        // Unlimited friction does not keep the block from tipping over.
        const double infinite = std::numeric_limits<double>::infinity();
        for (const double bound : {infinite, scale * 1e20})
          {
            EXPECT_TRUE(is_balanced(times({5., -1., 0.999}), bound));
            EXPECT_FALSE(is_balanced(times({5., -1., 1.00001}), bound));
          }
      }
    // Rounding of loads that cancel does not count.
    HeldBody nearly = block.with_load({0., 1e-16, 0.});
    EXPECT_FALSE(
      balance(nearly, block.bounds, block.bounds_of_pressure, accuracy)
        .is_balanced);
    nearly.load_size = 1.;
    EXPECT_TRUE(
      balance(nearly, block.bounds, block.bounds_of_pressure, accuracy)
        .is_balanced);
  }



  TEST(Statics, BodySettlesOnSoftGround)
  {
    // Each of two springs carries its part by the lever rule.
    for (const double exponent : {1., 1.5, 10.})
      for (const double depth : {1e-3, 3.}) // at the start
        {
          RigidBody beam(2);
          for (const double at : {-1., 1.})
            {
              Tensor<1, 3> x, down;
              x[0]    = at;
              down[1] = -1.;
              beam.add_node(x, down, 0., 0.);
              beam.face.points.back().compliance.add(1e-9,
                                                     power_pressure(exponent));
            }
          const std::vector<double> load{0., -4e-3, 1e-3};
          ContactState              contact(std::vector<double>(4, -depth));
          contact.sticks = {false, false, false, false};
          const std::vector<double> motion =
            settle(beam.with_load(load), contact, std::vector<Tensor<1, 2>>(4));
          double force = 0., moment = 0.;
          for (unsigned int n = 0; n < 2; ++n)
            {
              const auto   u = beam.displacement(motion, beam.positions[n]);
              const double p =
                beam.face.points[2 * n + 1].compliance.force(depth - u[1]);
              force += p;
              moment += beam.positions[n][0] * p;
            }
          EXPECT_NEAR(force, 4e-3, 1e-12);
          EXPECT_NEAR(moment, -1e-3, 1e-12);
        }
  }
} // namespace
