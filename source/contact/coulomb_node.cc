// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/coulomb_node.h>

#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <cstdint>

namespace Viscoplastic
{
  namespace
  {
    /// The parts of a node's problem along the foundation: W_tt, q_t, W_tn.
    struct Tangential
    {
      Tensor<2, 2> flexibility;
      Tensor<1, 2> free_motion, coupling;

      explicit Tangential(const CoulombNode &node)
      {
        for (unsigned int i = 0; i < node.n_tangents; ++i)
          {
            free_motion[i] = node.free_motion[1 + i];
            coupling[i]    = node.flexibility[1 + i][0];
            for (unsigned int j = 0; j < node.n_tangents; ++j)
              flexibility[i][j] = node.flexibility[1 + i][1 + j];
          }
      }
    };



    /// The pressure at which the foundation stops a motion to @p free_w beyond
    /// it.
    double
    stopping_force(const NormalCompliance &compliance,
                   const double            flexibility,
                   const double            free_w)
    {
      if (!(free_w > 0.))
        return 0.;
      return compliance.is_rigid() ?
               free_w / flexibility :
               compliance.force(compliance.penetration(flexibility, free_w));
    }
  } // namespace



  double
  coulomb_pressure(const CoulombNode &node)
  {
    const Tangential t(node);
    const double     W_nn = node.flexibility[0][0], q_n = node.free_motion[0];
    const auto       friction = [&](const double p) {
      return solve_friction_point(t.flexibility,
                                  t.free_motion - p * t.coupling,
                                  node.n_tangents,
                                  node.given + node.coefficient * p);
    };
    const auto excess = [&](const double p) {
      const double sinks = node.compliance.is_rigid() || p == 0. ?
                             0. :
                             node.compliance.penetration(p);
      return q_n - t.coupling * friction(p).multiplier - W_nn * p - sinks;
    };

    const bool may_open = !(excess(0.) > 0.);
    if (may_open && !(node.present > 0.))
      return 0.;

    // Held along the foundation: what couples is eliminated.
    constexpr double glued = std::numeric_limits<double>::max();
    const auto       held  = [&](const Tensor<1, 2> &motion) {
      return solve_friction_point(t.flexibility, motion, node.n_tangents, glued)
        .multiplier;
    };
    const double stuck = stopping_force(node.compliance,
                                        W_nn - t.coupling * held(t.coupling),
                                        q_n - t.coupling * held(t.free_motion));
    if (stuck > 0. && friction(stuck).sticks)
      return stuck;

    if (node.n_tangents == 1 && node.compliance.is_rigid())
      for (const double side : {1., -1.})
        {
          const double pivot = W_nn + side * node.coefficient * t.coupling[0];
          const double p = (q_n - side * t.coupling[0] * node.given) / pivot;
          if (pivot > 0. && p > 0.)
            if (const PointSolution solution = friction(p);
                !solution.sticks && solution.multiplier[0] * side >= 0.)
              return p;
        }

    // Between where the node is beyond its foundation and where it is not.
    double low =
      node.present > 0. && excess(node.present) > 0. ? node.present : 0.;
    if (may_open && low == 0.)
      return 0.;
    // Without any motion beyond the foundation what is given of friction
    // presses. The flexibility is positive definite: the excess falls without
    // bound. What is no number ends the search, and is met in residuals.
    double high = std::max({2. * low,
                            stuck,
                            stopping_force(node.compliance, W_nn, q_n),
                            node.given,
                            1e-300});
    for (unsigned int i = 0; i < 1000 && excess(high) > 0.; ++i)
      {
        low = high;
        high *= 2.;
      }
    const double at_low = excess(low), at_high = excess(high);
    if (!(at_low > 0.) || !(at_high < 0.))
      return at_low > 0. ? high : low;
    std::uintmax_t max_evaluations = 200;
    const auto     root            = boost::math::tools::toms748_solve(
      excess,
      low,
      high,
      at_low,
      at_high,
      [](const double a, const double b) { return b - a <= 2e-16 * b; },
      max_evaluations);
    return 0.5 * (root.first + root.second);
  }
} // namespace Viscoplastic
