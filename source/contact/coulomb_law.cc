// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/coulomb_law.h>
#include <viscoplastic_contact/contact/node_forces.h>

#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace Viscoplastic
{
  namespace
  {
    /// A gap of less than this part of the motion of the free node is rounding.
    constexpr double rounding_of_gap = 1e-12;
  } // namespace



  unsigned int
  CoulombLaw::own_obstacle(const ContactLayout &face,
                           const unsigned int   point) const
  {
    const unsigned int node   = face.points[point].node;
    const unsigned int begin  = face.first_obstacle(node);
    unsigned int       result = numbers::invalid_unsigned_int;
    double             most   = 0.;
    for (const unsigned int o : face.obstacles(node))
      {
        bool is_across = true;
        for (unsigned int i = 0; i < face.points[point].n_tangents; ++i)
          is_across = is_across && std::abs(face.points[point].map[i] *
                                            face.points[o].map[0]) < 1e-10;
        if (is_across && of_pressure[point][o - begin] > most)
          {
            most   = of_pressure[point][o - begin];
            result = o;
          }
      }
    return result;
  }



  double
  CoulombLaw::own_pressure(const ContactLayout &face,
                           const unsigned int   p,
                           const unsigned int   o,
                           const Tensor<2, 3>  &inverse_diagonal,
                           const Tensor<1, 3>  &force,
                           const ContactState  &state) const
  {
    const ContactLayout::Point       &friction = face.points[p];
    const std::array<Tensor<1, 3>, 3> rows{
      {face.points[o].map[0], friction.map[0], friction.map[1]}};
    const double coefficient =
                   of_pressure[p][o - face.first_obstacle(friction.node)],
                 present = state.multiplier[o][0];
    CoulombNode        problem{{},
                        {},
                        friction.n_tangents,
                        std::max(0.,
                                 bound(face, state, p) - coefficient * present),
                        coefficient,
                        face.points[o].compliance,
                        state.sticks[o] ? present : 0.};
    const Tensor<1, 3> free  = inverse_diagonal * force;
    problem.free_motion[0]   = rows[0] * free - state.gap(o);
    const Tensor<1, 2> slips = state.slip_with(friction, p, free);
    for (unsigned int i = 0; i <= friction.n_tangents; ++i)
      {
        if (i > 0)
          problem.free_motion[i] = slips[i - 1];
        for (unsigned int j = 0; j <= friction.n_tangents; ++j)
          problem.flexibility[i][j] = rows[i] * (inverse_diagonal * rows[j]);
      }
    return coulomb_pressure(problem);
  }



  std::optional<Tensor<1, 3>>
  CoulombLaw::relax_node(const ContactLayout &face,
                         const unsigned int   node,
                         const Tensor<2, 3>  &inverse_diagonal,
                         const Tensor<1, 3>  &force,
                         ContactState        &state,
                         const bool           must_settle) const
  {
    constexpr unsigned int max_sweeps = 100;
    const unsigned int     begin      = face.first_point[node],
                       end            = face.first_point[node + 1],
                       obstacle       = face.first_obstacle(node);
    const bool many_sweeps =
      end - obstacle > 1 || !face.has_plain_friction(node);
    std::vector<std::tuple<Tensor<1, 2>, double, bool>> old;
    for (unsigned int p = begin; many_sweeps && p < end; ++p)
      old.emplace_back(state.multiplier[p], state.bound[p], state.sticks[p]);
    Tensor<1, 3> remaining = force;
    double       change, size;
    const auto   take_away = [&](const unsigned int p) {
      remaining += node_force(face.points[p], state.multiplier[p]);
    };
    const auto set = [&](const unsigned int p, const PointSolution &solution) {
      change += (solution.multiplier - state.multiplier[p]).norm();
      size += solution.multiplier.norm();
      state.multiplier[p] = solution.multiplier;
      state.sticks[p]     = solution.sticks;
      remaining -= node_force(face.points[p], solution.multiplier);
    };
    for (unsigned int p = begin; p < end; ++p)
      remaining -= node_force(face.points[p], state.multiplier[p]);

    // Gauss-Seidel over the pieces until their forces settle.
    bool has_settled = false;
    for (unsigned int sweep = 0; sweep < max_sweeps && !has_settled; ++sweep)
      {
        std::vector<bool> is_done(end - begin, false);
        change = size = 0.;
        for (unsigned int p = begin; p < end; ++p)
          {
            if (is_done[p - begin])
              continue;
            take_away(p);
            if (p < obstacle)
              if (const unsigned int o = own_obstacle(face, p); o < end)
                {
                  take_away(o);
                  PointSolution pressed{{}, false};
                  pressed.multiplier[0] = own_pressure(
                    face, p, o, inverse_diagonal, remaining, state);
                  pressed.sticks = pressed.multiplier[0] > 0.;
                  set(o, pressed);
                  is_done[o - begin] = true;
                }
            if (p < obstacle)
              state.bound[p] = bound(face, state, p);
            set(p, solve_point(face, p, inverse_diagonal, remaining, state));
          }
        has_settled = !many_sweeps || change <= 1e-14 * size;
      }
    if (must_settle && !has_settled)
      {
        for (unsigned int p = begin; p < end; ++p)
          {
            const auto &[multiplier, bound, sticks] = old[p - begin];
            state.multiplier[p]                     = multiplier;
            state.bound[p]                          = bound;
            state.sticks[p]                         = sticks;
          }
        return {};
      }
    // With the bounds of its pressures, the minimum of J at the node obeys
    // Coulomb's law. The misfit of bounds that have not settled is measured
    // later (CoulombBounds::measure()).
    const Tensor<1, 3> x =
      Viscoplastic::relax_node(face, node, inverse_diagonal, force, state);
    // If friction wedges a node between two pieces, one of them suffices to
    // hold it. Mark both as touched, since each friction bound needs the
    // pressure of its own piece.
    if (end - obstacle > 1)
      {
        const double gap = rounding_of_gap * (inverse_diagonal * force).norm();
        for (const unsigned int o : face.rigid(face.obstacles(node)))
          if (std::abs(face.points[o].map[0] * x - state.gap(o)) <= gap)
            state.sticks[o] = true;
      }
    return x;
  }



  void
  CoulombLaw::tilt(const ContactLayout             &face,
                   const ContactState              &state,
                   const std::vector<Tensor<2, 3>> &inverse_diagonal,
                   FaceTruncation                  &truncation,
                   const double                     stiffest) const
  {
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        const unsigned int        obstacle = face.first_obstacle(node);
        std::optional<NodeForces> forces;
        std::vector<Tensor<1, 3>> of_force;
        for (const unsigned int p : face.friction_points(node))
          for (const unsigned int o : face.obstacles(node))
            {
              const double coefficient = of_pressure[p][o - obstacle];
              if (state.sticks[p] || !(state.slip[p].norm() > 0.) ||
                  !(coefficient > 0.) || !(state.multiplier[o][0] > 0.))
                continue;
              if (truncation.tilt.empty())
                truncation.tilt.assign(face.n_nodes(), identity());
              if (!forces)
                {
                  forces.emplace(face, node, state, this);
                  of_force = forces->pressures_of_force();
                }
              truncation.tilt[node] -=
                coefficient *
                outer_product(node_force(face.points[p],
                                         state.slip[p] / state.slip[p].norm()),
                              of_force[o - obstacle]);
            }
        // Tilt the turning springs, too, since slip that turns presses the
        // other pieces. Springs of compliant obstacles are pressures already.
        if (forces && !face.has_plain_friction(node))
          {
            const Tensor<2, 3> turning =
              turning_spring(face, node, state, inverse_diagonal, stiffest);
            const Tensor<2, 3> &projector = truncation.projector[node];
            const Tensor<2, 3>  spring =
              projector * truncation.tilt[node] * turning * projector;
            if (trace(spring) >= 0.)
              truncation.spring[node] += spring - turning;
          }
      }
  }



  void
  CoulombLaw::predict_bounds(const ContactLayout  &face,
                             const Vector<double> &residual,
                             ContactState         &state) const
  {
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        const NodeForces forces(face, node, state, this);
        if (!forces.is_free() && !face.has_plain_friction(node))
          continue;
        const auto pressures =
          forces.pressures(face.node_values(residual, node));
        for (const unsigned int p : face.friction_points(node))
          {
            state.bound[p] = given[p];
            for (unsigned int k = 0; k < pressures.size(); ++k)
              state.bound[p] += of_pressure[p][k] * pressures[k];
          }
      }
  }



  double
  CoulombLaw::largest_coefficient(const ContactLayout &face) const
  {
    double result = 0.;
    for (const unsigned int p : face.friction_points())
      result = std::max(result,
                        std::accumulate(of_pressure[p].begin(),
                                        of_pressure[p].end(),
                                        0.));
    return Utilities::MPI::max(result, face.communicator);
  }



  namespace
  {
    /// The tangential parts of a node's problem: the flexibility W_tt, the free
    /// motion q_t and the coupling W_tn.
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
      return q_n - t.coupling * friction(p).multiplier - W_nn * p -
             node.compliance.penetration(p);
    };

    const bool may_open = !(excess(0.) > 0.);
    if (may_open && !(node.present > 0.))
      return 0.;

    // Try stick: eliminate the tangential components.
    constexpr double glued = std::numeric_limits<double>::max();
    const auto       held  = [&](const Tensor<1, 2> &motion) {
      return solve_friction_point(t.flexibility, motion, node.n_tangents, glued)
        .multiplier;
    };
    const double stuck =
      node.compliance.stopping_force(W_nn - t.coupling * held(t.coupling),
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

    // Bracket the root of excess() by low and high.
    double low =
      node.present > 0. && excess(node.present) > 0. ? node.present : 0.;
    if (may_open && low == 0.)
      return 0.;
    // The given part of friction sets a scale, too, since it may cause the only
    // pressure. The excess falls without bound, since the flexibility is
    // positive definite. NaNs end the search and are detected in residuals.
    double high = std::max({2. * low,
                            stuck,
                            node.compliance.stopping_force(W_nn, q_n),
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
