// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/node_forces.h>
#include <viscoplastic_contact/contact/node_minimum.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// Solve (C + shift I) x = q for the leading n x n block, n = 1 or 2.
    Tensor<1, 2>
    solve_block(const Tensor<2, 2> &C,
                const double        shift,
                const Tensor<1, 2> &q,
                const unsigned int  n)
    {
      Tensor<1, 2> x;
      if (n == 1)
        x[0] = q[0] / (C[0][0] + shift);
      else
        {
          const double a = C[0][0] + shift, b = C[0][1], d = C[1][1] + shift;
          const double determinant = a * d - b * b;
          x[0]                     = (d * q[0] - b * q[1]) / determinant;
          x[1]                     = (a * q[1] - b * q[0]) / determinant;
        }
      return x;
    }



    Tensor<1, 2>
    clip(const Tensor<1, 2> &multiplier, const double bound)
    {
      const double size = stable_norm(multiplier);
      return size <= bound ? multiplier : multiplier * (bound / size);
    }



    /// The nearest admissible multiplier: in the ball of a friction point,
    /// nonnegative at an obstacle.
    Tensor<1, 2>
    clip(const ContactLayout::Point &point,
         const Tensor<1, 2>         &multiplier,
         const double                bound)
    {
      if (!point.is_obstacle)
        return clip(multiplier, bound);
      Tensor<1, 2> result;
      result[0] = std::max(0., multiplier[0]);
      return result;
    }
  } // namespace



  PointSolution
  solve_friction_point(const Tensor<2, 2> &flexibility,
                       const Tensor<1, 2> &free_slip,
                       const unsigned int  n_tangents,
                       const double        bound)
  {
    const Tensor<1, 2> stick =
      solve_block(flexibility, 0., free_slip, n_tangents);
    const double stick_size = stable_norm(stick);
    // Without friction a point counts as slipping, even if it does not move.
    if (bound == 0.)
      return {Tensor<1, 2>(), false};
    if (!(stick_size > bound * (1. + 1e-14)))
      return {stick, true};
    if (n_tangents == 1)
      {
        Tensor<1, 2> multiplier;
        multiplier[0] = std::copysign(bound, free_slip[0]);
        return {multiplier, false};
      }

    // A force too small to influence the slip, whose square would underflow.
    if (bound < 1e-100 * stick_size)
      return {free_slip * (bound / stable_norm(free_slip)), false};

    // |(C + m I)^{-1} q| = rho for m = |s|/rho > 0: Newton's method on the
    // reciprocal of the norm is monotone from m = 0 (More, Sorensen). It takes
    // some 20 iterations; for condition numbers of 1e8 and more it stalls at
    // rounding times these. The length of the result is exact.
    double       m          = 0.;
    Tensor<1, 2> multiplier = stick;
    for (unsigned int iteration = 0; iteration < 100; ++iteration)
      {
        const double size = multiplier.norm();
        if (std::abs(size - bound) <= 1e-15 * bound)
          break;
        const double slope =
          multiplier * solve_block(flexibility, m, multiplier, n_tangents);
        const double change =
          (size / bound - 1.) * Utilities::fixed_power<2>(size) / slope;
        if (!(m + change > m))
          break;
        m += change;
        multiplier = solve_block(flexibility, m, free_slip, n_tangents);
      }
    return {multiplier * (bound / multiplier.norm()), false};
  }



  PointSolution
  solve_point(const ContactLayout &face,
              const unsigned int   p,
              const Tensor<2, 3>  &flexibility,
              const Tensor<1, 3>  &force,
              const ContactState  &state,
              const Tensor<1, 3>  &start)
  {
    const ContactLayout::Point &point = face.points[p];
    Tensor<2, 2>                of_point;
    for (unsigned int i = 0; i < point.n_tangents; ++i)
      for (unsigned int j = 0; j < point.n_tangents; ++j)
        of_point[i][j] = point.map[i] * (flexibility * point.map[j]);
    const Tensor<1, 2> free_motion =
      state.slip_with(point, p, start + flexibility * force);
    if (!point.is_obstacle)
      return solve_friction_point(of_point,
                                  free_motion,
                                  point.n_tangents,
                                  state.bound[p]);
    const double  free_w = free_motion[0] - state.gap(p);
    PointSolution solution{{}, free_w > 0.};
    solution.multiplier[0] =
      point.compliance.stopping_force(of_point[0][0], free_w);
    return solution;
  }



  namespace
  {
    /// Minimize J over @p x = @p start + y, with y in the range of the
    /// symmetric @p flexibility, by duality: in sweeps over the points (also
    /// obstacles) from @p begin to @p end, exact for a single point. Returns
    /// whether they converge, which they hardly do where points act against
    /// each other along one direction: x is then a start for minimize_at_node()
    /// or for the next sweep over the face, and its error is part of the
    /// certificate.
    bool
    relax_points(const ContactLayout &face,
                 const unsigned int   begin,
                 const unsigned int   end,
                 const Tensor<2, 3>  &flexibility,
                 const Tensor<1, 3>  &start,
                 const Tensor<1, 3>  &force,
                 ContactState        &state,
                 Tensor<1, 3>        &x)
    {
      constexpr unsigned int max_sweeps = 100;
      bool                   has_ended  = false;
      Tensor<1, 3>           remaining  = force;
      for (unsigned int p = begin; p < end; ++p)
        remaining -= node_force(face.points[p], state.multiplier[p]);
      for (unsigned int sweep = 0; sweep < max_sweeps && !has_ended; ++sweep)
        {
          double change = 0., size = 0.;
          for (unsigned int p = begin; p < end; ++p)
            {
              const ContactLayout::Point &point = face.points[p];
              remaining += node_force(point, state.multiplier[p]);
              const PointSolution solution =
                solve_point(face, p, flexibility, remaining, state, start);
              change += (solution.multiplier - state.multiplier[p]).norm();
              size += solution.multiplier.norm();
              state.multiplier[p] = solution.multiplier;
              state.sticks[p]     = solution.sticks;
              remaining -= node_force(point, solution.multiplier);
            }
          has_ended = end - begin <= 1 || change <= 1e-14 * size;
        }
      x = start + flexibility * remaining;
      return has_ended;
    }
  } // namespace



  Tensor<1, 3>
  relax_node(const ContactLayout &face,
             const unsigned int   node,
             const Tensor<2, 3>  &inverse_diagonal,
             const Tensor<1, 3>  &force, // residual + D x
             ContactState        &state)
  {
    const unsigned int begin    = face.first_point[node];
    const unsigned int end      = face.first_point[node + 1];
    const unsigned int obstacle = face.first_obstacle(node);
    const Tensor<1, 3> nothing;
    const bool has_single_obstacle = face.is_plain(node) && obstacle < end;

    Tensor<1, 3> x, normal;
    double       distance = 0.;
    if (has_single_obstacle && face.points[obstacle].compliance.is_rigid())
      {
        // J is convex, so the obstacle is touched if the minimum without it is
        // beyond it, and has no influence otherwise.
        const ContactLayout::Point &point = face.points[obstacle];
        relax_points(
          face, begin, obstacle, inverse_diagonal, nothing, force, state, x);
        state.multiplier[obstacle] = Tensor<1, 2>();
        state.sticks[obstacle]     = slip(point, x)[0] > state.gap(obstacle);
        if (state.sticks[obstacle])
          {
            // Minimize on the plane of the obstacle.
            const Tensor<1, 3> response = inverse_diagonal * point.map[0];
            const double       size     = point.map[0] * response;
            distance                    = state.gap(obstacle);
            normal = point.map[0] / point.map[0].norm_square();
            relax_points(face,
                         begin,
                         obstacle,
                         inverse_diagonal -
                           outer_product(response, response) / size,
                         response * (distance / size),
                         force,
                         state,
                         x);
            Tensor<1, 3> remaining = force;
            for (unsigned int p = begin; p < obstacle; ++p)
              remaining -= node_force(face.points[p], state.multiplier[p]);
            state.multiplier[obstacle][0] =
              std::max(0., (response * remaining - distance) / size);
            x += (distance - point.map[0] * x) * normal;
          }
      }
    else
      {
        if (!relax_points(
              face, begin, end, inverse_diagonal, nothing, force, state, x))
          if (const auto minimum = minimize_at_node(
                face, node, invert(inverse_diagonal), force, state))
            x = *minimum;
        // The penetration of a stiff compliant obstacle is more accurate if it
        // is computed from its force.
        if (has_single_obstacle && state.multiplier[obstacle][0] > 0.)
          {
            const ContactLayout::Point &point = face.points[obstacle];
            const double                end_of_way =
              state.gap(obstacle) +
              point.compliance.penetration(state.multiplier[obstacle][0]);
            x += (end_of_way - point.map[0] * x) / point.map[0].norm_square() *
                 point.map[0];
          }
      }

    // A node all of whose components are held moves with the foundation,
    // without rounding: not at all if the foundation is at rest.
    if (face.has_plain_friction(node) && state.sticks[begin] &&
        face.points[begin].n_tangents + (normal.norm() > 0. ? 1 : 0) ==
          face.n_node_dofs(node))
      return distance * normal +
             motion_with_slip(face.points[begin], state.foundation_step[begin]);
    return x;
  }



  void
  fit_multipliers(const ContactLayout       &face,
                  const Vector<double>      &residual,
                  ContactState              &state,
                  Vector<double>            &force,
                  const CoulombCoefficients *law)
  {
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        const Tensor<1, 3> total   = face.node_values(residual, node);
        Tensor<1, 3>       missing = total;
        if (face.is_plain(node))
          // The rows of the points are orthogonal: clip the residual, at
          // obstacles first, since bounds depend on their pressures.
          for (unsigned int p = face.first_point[node + 1];
               p-- > face.first_point[node];)
            {
              const ContactLayout::Point &point      = face.points[p];
              Tensor<1, 2>               &multiplier = state.multiplier[p];
              if (law != nullptr && !point.is_obstacle)
                state.bound[p] = law->bound(face, state, p);
              multiplier = state.blocks(point, p) ?
                             clip(point,
                                  nearest_multiplier(point, missing),
                                  state.bound[p]) :
                             state.multiplier_of_slip(point, p);
              missing -= node_force(point, multiplier);
            }
        else
          missing = NodeForces(face, node, state, law).fit(total, state);
        face.set_node_values(total - missing, node, force);
      }
  }



  namespace
  {
    /// Divide the misfit between the residual and the force of a compliant
    /// obstacle in the ratio of stiffnesses: one part is added to the force, at
    /// the price of a complementarity defect, the other one stays in the
    /// residual. This minimizes the sum of both errors.
    void
    share_misfit(const ContactLayout             &face,
                 const Vector<double>            &residual,
                 const std::vector<Tensor<2, 3>> &diagonal,
                 const ContactState              &state,
                 const unsigned int               p,
                 Certificate                     &certificate)
    {
      const ContactLayout::Point &point = face.points[p];
      const double                w     = state.penetration(p);
      if (!(w > 0.))
        return;
      const Tensor<1, 3> &normal = point.map[0];
      const Tensor<1, 3>  force =
        face.node_values(certificate.force, point.node);
      const double missing = normal *
                             (face.node_values(residual, point.node) - force) /
                             normal.norm_square();
      const double spring = point.compliance.slope(w),
                   bulk   = normal * (diagonal[point.node] * normal) /
                          (normal.norm_square() * normal.norm_square()),
                   old = state.multiplier[p][0];
      Tensor<1, 2> multiplier;
      multiplier[0] = std::max(0., old + spring / (spring + bulk) * missing);
      if (multiplier[0] == old)
        return;
      certificate.defect += point.compliance.defect(w, multiplier[0]);
      certificate.replaced.emplace_back(p, multiplier);
      face.add_node_values((multiplier[0] - old) * normal,
                           point.node,
                           certificate.force);
    }
  } // namespace



  Certificate
  certify(const ContactLayout             &face,
          const Vector<double>            &residual,
          const std::vector<Tensor<2, 3>> &diagonal,
          const ContactState              &state,
          const Vector<double>            &force,
          const double                     rounding)
  {
    Certificate result;
    result.force = force;
    // Rounding blurs the force of a stiff compliant obstacle, too.
    for (const unsigned int o : face.compliant(face.obstacles()))
      share_misfit(face, residual, diagonal, state, o, result);
    for (unsigned int p = 0; p < face.points.size(); ++p)
      {
        const ContactLayout::Point &point = face.points[p];
        if (point.n_tangents != 2 || !state.slips(point, p))
          continue;
        const Tensor<1, 3> here = face.node_values(result.force, point.node);
        const Tensor<1, 2> missing =
          nearest_multiplier(point,
                             face.node_values(residual, point.node) - here);
        const double bound = state.bound[p], size = state.slip[p].norm(),
                     stiffness = diagonal[point.node].norm();
        Tensor<1, 2> multiplier;
        if (face.has_plain_friction(point.node))
          {
            const double misses = missing.norm();
            const double blur   = rounding / (std::sqrt(stiffness) * size);
            if (misses > std::max(1e-5, blur) * bound ||
                misses <= stiffness * size)
              continue;
            multiplier = clip(state.multiplier[p] + missing, bound);
            result.defect +=
              std::max(0., bound * size - multiplier * state.slip[p]);
          }
        else
          {
            const Tensor<1, 2> direction = state.slip[p] / size,
                               across =
                                 missing - (missing * direction) * direction;
            // Only where contact forces far exceed those of the body.
            if (bound < 10. * face.node_values(residual, point.node).norm() ||
                across.norm() > 1e-9 * bound || stiffness * size >= bound)
              continue;
            multiplier = state.multiplier[p] + across;
            multiplier *= bound / multiplier.norm();
            // bound |s| (1 - cos theta), theta = |across| / bound.
            result.defect += 0.51 * size * across.norm_square() / bound;
          }
        result.replaced.emplace_back(p, multiplier);
        face.set_node_values(here +
                               node_force(point,
                                          multiplier - state.multiplier[p]),
                             point.node,
                             result.force);
      }
    result.defect = face.sum(result.defect);
    return result;
  }
} // namespace Viscoplastic
