// SPDX-License-Identifier: LGPL-2.1-or-later

// Coulomb's law at one node: solutions satisfy the law at random nodes, and are
// among all solutions in the plane, found by brute force.

#include "random.h"
#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/coulomb_law.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace Viscoplastic;
using namespace Viscoplastic::Testing;

namespace
{
  CoulombNode
  random_node(Random                 &random,
              const unsigned int      n_tangents,
              const NormalCompliance &compliance)
  {
    Tensor<2, 3> root, flexibility;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        root[i][j] = std::max(i, j) <= n_tangents ? random.uniform() : 0.;
    flexibility = root * transpose(root);
    for (unsigned int i = 0; i <= n_tangents; ++i)
      flexibility[i][i] += 0.1;
    CoulombNode node{
      flexibility, {}, n_tangents, 0., random.uniform(0., 2.), compliance, 0.};
    for (unsigned int i = 0; i <= n_tangents; ++i)
      node.free_motion[i] = random.uniform();
    if (random.integer(0, 3) == 0)
      node.given = random.uniform(0., 0.3);
    // Limit cases: nodes that just touch, are just held, or lack friction.
    switch (random.integer(0, 9))
      {
        case 0:
          node.free_motion[0] = 0.;
          break;
        case 1:
          {
            Tensor<1, 3> force;
            force[0]         = random.uniform(0., 1.);
            force[1]         = node.coefficient * force[0] + node.given;
            node.free_motion = flexibility * force;
            break;
          }
        case 2:
          node.coefficient = 0.;
          break;
        case 3:
          for (unsigned int i = 1; i <= n_tangents; ++i)
            node.free_motion[i] = 0.;
          break;
      }
    return node;
  }



  /// The violation of the laws by the pressure p with its friction.
  double
  violation(const CoulombNode &node, const double p)
  {
    Tensor<2, 2> W_tt;
    Tensor<1, 2> q_t;
    for (unsigned int i = 0; i < node.n_tangents; ++i)
      {
        q_t[i] = node.free_motion[1 + i] - node.flexibility[1 + i][0] * p;
        for (unsigned int j = 0; j < node.n_tangents; ++j)
          W_tt[i][j] = node.flexibility[1 + i][1 + j];
      }
    const double       bound = node.given + node.coefficient * p;
    const Tensor<1, 2> lambda =
      solve_friction_point(W_tt, q_t, node.n_tangents, bound).multiplier;
    const Tensor<1, 2> s = q_t - W_tt * lambda;
    double             w = node.free_motion[0] - node.flexibility[0][0] * p;
    for (unsigned int i = 0; i < node.n_tangents; ++i)
      w -= node.flexibility[0][1 + i] * lambda[i];
    double result = std::max(-p, lambda.norm() - bound);
    result        = std::max(result, std::abs(bound * s.norm() - lambda * s));
    if (!node.compliance.is_rigid())
      return std::max(result, std::abs(node.compliance.force(w) - p));
    return std::max({result, w, -w * p});
  }
} // namespace



TEST(CoulombNode, ObeysTheLaw)
{
  for (unsigned int seed = 0; seed < 4000; ++seed)
    {
      Random           random(seed);
      NormalCompliance compliance;
      if (seed % 4 == 3)
        compliance.add(random.logarithmic(1e-2, 1e4),
                       power_pressure(random.uniform(1., 2.)));
      const CoulombNode node = random_node(random, 1 + seed % 2, compliance);
      const double      p    = coulomb_pressure(node);
      EXPECT_LT(violation(node, p), 1e-11 * (1. + p)) << "seed " << seed;
      if (!compliance.is_rigid())
        continue;
      // The pressure scales with the unit of force.
      constexpr double unit = 1ull << 40;
      CoulombNode      other(node);
      other.flexibility /= unit;
      other.given *= unit;
      EXPECT_NEAR(coulomb_pressure(other) / unit, p, 1e-12 * p)
        << "seed " << seed;
    }
}



TEST(CoulombNode, IsASolutionThatBruteForceFinds)
{
  // In the plane, a node on a rigid foundation is open, sticks, or slips.
  const NormalCompliance rigid;
  unsigned int           n_several = 0;
  for (unsigned int seed = 0; seed < 2000; ++seed)
    {
      Random              random(seed);
      const CoulombNode   node = random_node(random, 1, rigid);
      const auto         &W    = node.flexibility;
      const auto         &q    = node.free_motion;
      const double        g = node.given, mu = node.coefficient;
      std::vector<double> pressures;
      constexpr double    tie         = 1e-12;
      const double        determinant = W[0][0] * W[1][1] - W[0][1] * W[1][0];
      const double stuck   = (W[1][1] * q[0] - W[0][1] * q[1]) / determinant,
                   holding = (W[0][0] * q[1] - W[1][0] * q[0]) / determinant;
      if (stuck >= -tie && std::abs(holding) <= g + mu * stuck + tie)
        pressures.push_back(stuck);
      for (const double side : {-1., 1.})
        {
          const double p =
            (q[0] - side * W[0][1] * g) / (W[0][0] + side * mu * W[0][1]);
          const double s = q[1] - W[1][0] * p - side * W[1][1] * (g + mu * p);
          if (p >= -tie && s * side >= -tie)
            pressures.push_back(p);
          if (q[0] - W[0][1] * side * g <= tie &&
              (q[1] - W[1][1] * side * g) * side >= -tie)
            pressures.push_back(0.);
        }
      if (std::abs(q[1]) <= W[1][1] * g + tie &&
          q[0] - W[0][1] * q[1] / W[1][1] <= tie)
        pressures.push_back(0.);
      ASSERT_FALSE(pressures.empty());
      const double found   = coulomb_pressure(node);
      double       nearest = 1e300, spread = 0.;
      for (const double p : pressures)
        {
          nearest = std::min(nearest, std::abs(p - found));
          spread  = std::max(spread, std::abs(p - pressures[0]));
        }
      EXPECT_LT(nearest, 1e-11 * (1. + found)) << "seed " << seed;
      n_several += spread > 1e-6;
    }
  // With friction coefficients up to 2 some nodes have several solutions.
  EXPECT_GT(n_several, 0);
}
