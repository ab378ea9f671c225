// SPDX-License-Identifier: LGPL-2.1-or-later

// The solution at one point with friction, against a grid search.

#include "random.h"
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/contact/contact_points.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  /// 1/2 lambda . C lambda - q . lambda.
  double
  dual_energy(const Tensor<2, 2> &C,
              const Tensor<1, 2> &q,
              const Tensor<1, 2> &multiplier)
  {
    return 0.5 * (multiplier * (C * multiplier)) - q * multiplier;
  }



  /// The minimizer of dual_energy() with |lambda| = bound, by refined grids.
  Tensor<1, 2>
  best_on_circle(const Tensor<2, 2> &C,
                 const Tensor<1, 2> &q,
                 const double        bound)
  {
    const auto at = [bound](const double angle) {
      Tensor<1, 2> result;
      result[0] = bound * std::cos(angle);
      result[1] = bound * std::sin(angle);
      return result;
    };
    double best = 0., width = numbers::PI;
    for (unsigned int zoom = 0; zoom < 12; ++zoom)
      {
        const double center = best;
        double       lowest = std::numeric_limits<double>::max();
        const int    n      = zoom == 0 ? 2000 : 20;
        for (int i = -n; i <= n; ++i)
          {
            const double angle  = center + width * i / n;
            const double energy = dual_energy(C, q, at(angle));
            if (energy < lowest)
              {
                lowest = energy;
                best   = angle;
              }
          }
        width *= zoom == 0 ? 2. / n : 0.2;
      }
    return at(best);
  }



  TEST(FrictionPoint, TwoTangentsAgainstAGridSearch)
  {
    Random       random(1);
    unsigned int n_slipping = 0;
    for (unsigned int trial = 0; trial < 300; ++trial)
      {
        // Flexibilities with condition numbers up to 1e6.
        const double a     = random.logarithmic(1e-3, 1e3);
        const double b     = random.logarithmic(1e-3, 1e3);
        const double angle = random.uniform(0., 3.);
        const double c = std::cos(angle), s = std::sin(angle);
        Tensor<2, 2> C;
        C[0][0] = a * c * c + b * s * s;
        C[1][1] = a * s * s + b * c * c;
        C[0][1] = C[1][0] = (a - b) * c * s;
        Tensor<1, 2> q;
        q[0] = random.uniform();
        q[1] = random.uniform();

        const Tensor<1, 2>  stick = invert(C) * q;
        const double        bound = stick.norm() * random.logarithmic(1e-8, 3.);
        const PointSolution solution = solve_friction_point(C, q, 2, bound);
        ASSERT_EQ(solution.sticks, stick.norm() <= bound);
        if (solution.sticks)
          {
            EXPECT_LT((solution.multiplier - stick).norm(),
                      1e-9 * stick.norm());
            continue;
          }
        ++n_slipping;
        const Tensor<1, 2> slip = q - C * solution.multiplier;
        EXPECT_NEAR(solution.multiplier.norm() / bound, 1., 1e-14);
        EXPECT_GT(slip * solution.multiplier, 0.);
        // The slip may be as small as rounding in q - C lambda.
        const double rounding = 1e-15 * (q.norm() + C.norm() * bound);
        EXPECT_LT((slip - slip.norm() * solution.multiplier / bound).norm(),
                  1e-8 * slip.norm() + 100. * rounding)
          << "trial " << trial;
        const Tensor<1, 2> grid   = best_on_circle(C, q, bound);
        const double       energy = dual_energy(C, q, solution.multiplier);
        EXPECT_LE(energy,
                  dual_energy(C, q, grid) + 1e-12 * std::abs(energy) +
                    rounding * bound)
          << "trial " << trial;
      }
    EXPECT_GT(n_slipping, 100u);
  }



  TEST(FrictionPoint, OneTangent)
  {
    Random random(2);
    for (unsigned int trial = 0; trial < 100; ++trial)
      {
        Tensor<2, 2> C;
        C[0][0] = random.logarithmic(1e-6, 1e6);
        Tensor<1, 2> q;
        q[0]                         = random.uniform();
        const double        stick    = q[0] / C[0][0];
        const double        bound    = random.uniform(0., 2.) * std::abs(stick);
        const PointSolution solution = solve_friction_point(C, q, 1, bound);
        EXPECT_EQ(solution.sticks, std::abs(stick) <= bound);
        EXPECT_DOUBLE_EQ(solution.multiplier[0],
                         std::max(-bound, std::min(bound, stick)));
        EXPECT_EQ(solution.multiplier[1], 0.);
      }
  }



  TEST(FrictionPoint, ZeroAndInfiniteBounds)
  {
    Tensor<2, 2> C;
    C[0][0] = 2.;
    C[1][1] = 3.;
    C[0][1] = C[1][0] = 1.;
    Tensor<1, 2> q;
    q[0] = 1.;
    q[1] = -4.;
    for (const unsigned int n_tangents : {1, 2})
      {
        const PointSolution free = solve_friction_point(C, q, n_tangents, 0.);
        EXPECT_EQ(free.multiplier.norm(), 0.);
        EXPECT_FALSE(free.sticks);
        const PointSolution glued = solve_friction_point(
          C, q, n_tangents, std::numeric_limits<double>::infinity());
        EXPECT_TRUE(glued.sticks);
        EXPECT_NEAR((C * glued.multiplier)[0], q[0], 1e-14);
        const PointSolution unloaded =
          solve_friction_point(C, Tensor<1, 2>(), n_tangents, 1.);
        EXPECT_TRUE(unloaded.sticks);
        EXPECT_EQ(unloaded.multiplier.norm(), 0.);
      }
  }



  TEST(FrictionPoint, BoundsWhoseSquaresVanish)
  {
    Tensor<2, 2> C;
    C[0][0] = 2.;
    C[1][1] = 1.;
    C[0][1] = C[1][0] = 0.5;
    Tensor<1, 2> q;
    q[0] = 3.;
    q[1] = 4.;
    for (const double bound : {1e-150, 1e-170, 1e-300})
      {
        const PointSolution solution = solve_friction_point(C, q, 2, bound);
        EXPECT_FALSE(solution.sticks);
        EXPECT_NEAR(solution.multiplier[0] / bound, 0.6, 1e-14);
        EXPECT_NEAR(solution.multiplier[1] / bound, 0.8, 1e-14);
      }
  }



  TEST(FrictionPoint, NormsWhoseSquaresVanish)
  {
    Tensor<1, 2> v;
    v[0] = 3.;
    v[1] = 4.;
    for (const double size : {0., 1e-310, 1e-300, 1e-160, 1., 1e160, 1e300})
      EXPECT_NEAR(stable_norm(v * size), 5. * size, 1e-13 * size) << size;
    v /= 7.;
    EXPECT_EQ(stable_norm(v), v.norm());
  }
} // namespace
