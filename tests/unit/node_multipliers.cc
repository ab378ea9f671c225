// SPDX-License-Identifier: LGPL-2.1-or-later

// The multipliers of single nodes, and blocked force components.

#include "dense_bulk.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  TEST(ContactSolver, MultipliersOfLeastNormWhereTheyAreNotUnique)
  {
    // At a node with two planes in 3D, four multiplier components make three
    // force components: shares along the edge are not unique.
    Random random(700);
    for (const double degrees : {90., 30., 150.})
      for (unsigned int trial = 0; trial < 40; ++trial)
        {
          SCOPED_TRACE("degrees " + std::to_string(degrees) + ", trial " +
                       std::to_string(trial));
          Problem problem;
          problem.add_node(3, planes_at_an_angle(3, degrees));
          // The residual is the force of known multipliers within the bounds,
          // in half of the trials without clipping.
          problem.bounds = {1., 1.};
          if (trial % 2 == 1)
            problem.bounds = {random.uniform(0.3, 1.), random.uniform(0.3, 1.)};
          std::vector<Tensor<1, 2>> known(2);
          for (unsigned int p = 0; p < 2; ++p)
            {
              for (unsigned int i = 0; i < 2; ++i)
                known[p][i] = random.uniform();
              const double share =
                trial % 2 == 1 ? random.uniform(0.5, 1.) : 0.2;
              known[p] *= share * problem.bounds[p] / known[p].norm();
            }
          Vector<double> residual(3), force(3);
          for (unsigned int p = 0; p < 2; ++p)
            {
              const Tensor<1, 3> f =
                node_force(problem.face.points[p], known[p]);
              for (unsigned int i = 0; i < 3; ++i)
                residual[i] += f[i];
            }
          ContactState state(problem.bounds);
          fit_multipliers(problem.face, residual, state, force);
          force -= residual;
          EXPECT_LT(force.l2_norm(), 1e-9);

          // Move along the null space of the map from multipliers to forces:
          // (0, t) at one plane, (0, -t) at the other.
          double best = std::numeric_limits<double>::max();
          for (int i = -20000; i <= 20000; ++i)
            {
              auto moved = known;
              moved[0][1] += 1e-4 * i;
              moved[1][1] -= 1e-4 * i;
              if (moved[0].norm() <= problem.bounds[0] * (1. + 1e-9) &&
                  moved[1].norm() <= problem.bounds[1] * (1. + 1e-9))
                best =
                  std::min(best,
                           moved[0].norm_square() + moved[1].norm_square());
            }
          const double fitted = state.multiplier[0].norm_square() +
                                state.multiplier[1].norm_square();
          EXPECT_LE(state.multiplier[0].norm(),
                    problem.bounds[0] * (1 + 1e-14));
          EXPECT_LE(state.multiplier[1].norm(),
                    problem.bounds[1] * (1 + 1e-14));
          EXPECT_NEAR(fitted, best, 1e-3);
        }
  }



  TEST(ContactSolver, RoundingOfBlockedForcesIsBlocked)
  {
    // As for a body in equilibrium on an oblique foundation, no iteration can
    // reduce a residual outside of the unblocked space.
    Problem            problem;
    const Tensor<1, 3> normal({0.7, 0.3, 0.9});
    for (unsigned int node = 0; node < 10; ++node)
      problem.add_node(3, {}, {normal / normal.norm()});
    ContactState state(std::vector<double>(10, 0.));
    state.sticks.assign(10, true);
    const FaceTruncation truncation = make_truncation(problem.face, state, {});
    Random               random(7);
    Vector<double>       x(30);
    for (unsigned int node = 0; node < 10; ++node)
      problem.face.set_node_values(random.uniform() * normal, node, x);
    const double blocked = x.l2_norm();
    truncation.project(problem.face, x);
    EXPECT_LT(x.l2_norm(), 1e-15 * blocked);
    Vector<double> again(x);
    truncation.project(problem.face, again);
    again -= x;
    EXPECT_LT(again.l2_norm(), 1e-14 * x.l2_norm());
  }
} // namespace
