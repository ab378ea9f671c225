// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/node_minimum.h>

#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// Slip or violation below this part of the node's motion is rounding.
    constexpr double rounding = 1e-14;



    /// Minimizes J over one node with some of its points held.
    class NodeProblem
    {
    public:
      /// A possible minimizer of J, and which points are held there.
      struct Candidate
      {
        Tensor<1, 3>      x;
        std::vector<bool> is_held;
      };

      NodeProblem(const ContactLayout &face,
                  const unsigned int   node,
                  const Tensor<2, 3>  &stiffness,
                  const Tensor<1, 3>  &force,
                  const ContactState  &state);

      /// The points that can be held: those with friction, and rigid obstacles.
      std::vector<unsigned int> holders;

      /// Hold the holders i with held[i]. Returns false if they cannot be held
      /// at once, or if a glued point is not among them.
      bool
      hold(const std::vector<bool> &held);

      /// The minimum with the present points held; nothing if another point
      /// with friction is at rest there, or an obstacle is entered.
      std::optional<Candidate>
      minimum() const;

      /// J(to) - J(from), evaluated without cancellation.
      double
      difference(const Candidate &from, const Candidate &to) const;

    private:
      /// The gradient of J and, if asked for, its Hessian, with the norm of
      /// slip replaced by a parabola in the range of rounding.
      Tensor<1, 3>
      gradient(const Tensor<1, 3> &x, Tensor<2, 3> *hessian = nullptr) const;

      /// At a kink of J, where the slip of a point is zero: the direction of
      /// descent along which it starts to slip, or nothing if it sticks.
      std::optional<Tensor<1, 3>>
      departure(const Tensor<1, 3> &x) const;

      /// The Newton step in the free directions; @p downhill: minus the
      /// gradient.
      Tensor<1, 3>
      newton_direction(Tensor<2, 3>        hessian,
                       const Tensor<1, 3> &downhill) const;

      /// The step from @p x that minimizes J along a direction of descent.
      double
      step_length(const Tensor<1, 3> &x, const Tensor<1, 3> &direction) const;

      bool
      has_friction(const unsigned int p) const
      {
        return p < obstacle && state.bound[p] > 0.;
      }

      ContactLayout::Range
      obstacles() const
      {
        return {obstacle, end};
      }

      double
      penetration(const unsigned int o, const Tensor<1, 3> &x) const
      {
        return slip(face.points[o], x)[0] - state.gap(o);
      }

      const ContactLayout &face;
      const unsigned int   begin, obstacle, end;
      const Tensor<2, 3>  &stiffness;
      const Tensor<1, 3>  &force;
      const ContactState  &state;
      /// Motions of the node below this length are rounding.
      double negligible;

      std::vector<bool> is_held; // point by point
      /// With the points held, x is in `start` + the range of the projector.
      Tensor<1, 3> start;
      Tensor<2, 3> projector;
    };



    NodeProblem::NodeProblem(const ContactLayout &face,
                             const unsigned int   node,
                             const Tensor<2, 3>  &stiffness,
                             const Tensor<1, 3>  &force,
                             const ContactState  &state)
      : face(face)
      , begin(face.first_point[node])
      , obstacle(face.first_obstacle(node))
      , end(face.first_point[node + 1])
      , stiffness(stiffness)
      , force(force)
      , state(state)
      , is_held(end - begin)
    {
      double size = (invert(stiffness) * force).norm();
      for (unsigned int p = begin; p < end; ++p)
        {
          const ContactLayout::Point &point = face.points[p];
          size                              = std::max(size,
                          (p < obstacle ? state.foundation_step[p].norm() :
                                                                       -state.gap(p)) /
                            point.map[0].norm());
          if (p < obstacle ? has_friction(p) : point.compliance.is_rigid())
            holders.push_back(p);
        }
      negligible = std::max(rounding * size, 1e-100);
    }



    bool
    NodeProblem::hold(const std::vector<bool> &held)
    {
      is_held.assign(end - begin, false);
      start     = Tensor<1, 3>();
      projector = Tensor<2, 3>();
      for (unsigned int d = 0; d < face.n_node_dofs(face.points[begin].node);
           ++d)
        projector[d][d] = 1.;
      for (unsigned int i = 0; i < held.size(); ++i)
        if (held[i])
          {
            const unsigned int          p     = holders[i];
            const ContactLayout::Point &point = face.points[p];
            is_held[p - begin]                = true;
            for (unsigned int row = 0; row < point.n_tangents; ++row)
              {
                const Tensor<1, 3> &map = point.map[row];
                const double missing = state.place(point, p)[row] - map * start;
                // The part of this direction that is still free.
                Tensor<1, 3> q    = projector * map;
                const double size = q.norm();
                if (size > 1e-8 * map.norm())
                  {
                    q /= size;
                    start += missing / size * q;
                    projector -= outer_product(q, q);
                  }
                else if (std::abs(missing) > negligible * map.norm())
                  return false;
              }
          }
        else if (has_friction(holders[i]) && state.bound[holders[i]] > 1e300)
          return false; // a glued point
      return true;
    }



    Tensor<1, 3>
    NodeProblem::gradient(const Tensor<1, 3> &x, Tensor<2, 3> *hessian) const
    {
      Tensor<1, 3> result = stiffness * x - force;
      if (hessian != nullptr)
        *hessian = stiffness;
      for (unsigned int p = begin; p < obstacle; ++p)
        if (has_friction(p) && !is_held[p - begin])
          {
            const ContactLayout::Point &point = face.points[p];
            const Tensor<1, 2>          s     = state.slip_with(point, p, x);
            const double                size  = s.norm();
            const double spring = state.bound[p] / std::max(size, negligible);
            result += spring * node_force(point, s);
            if (hessian == nullptr)
              continue;
            if (size <= negligible)
              for (unsigned int i = 0; i < point.n_tangents; ++i)
                *hessian += spring * outer_product(point.map[i], point.map[i]);
            else if (point.n_tangents == 2)
              {
                const Tensor<1, 3> across =
                  (s[0] * point.map[1] - s[1] * point.map[0]) / size;
                *hessian += spring * outer_product(across, across);
              }
          }
      for (const unsigned int o : face.compliant(obstacles()))
        {
          const ContactLayout::Point &point = face.points[o];
          const double                w     = penetration(o, x);
          result += point.compliance.force(w) * point.map[0];
          if (hessian != nullptr)
            *hessian += point.compliance.slope(w) *
                        outer_product(point.map[0], point.map[0]);
        }
      return result;
    }



    Tensor<1, 3>
    NodeProblem::newton_direction(Tensor<2, 3>        hessian,
                                  const Tensor<1, 3> &downhill) const
    {
      double scale = 0.;
      for (unsigned int d = 0; d < 3; ++d)
        scale = std::max(scale, stiffness[d][d]);
      hessian = projector * hessian * projector;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          hessian[i][j] += scale * ((i == j) - projector[i][j]);
      return projector * (invert(hessian) * downhill);
    }



    std::optional<Tensor<1, 3>>
    NodeProblem::departure(const Tensor<1, 3> &x) const
    {
      for (unsigned int p = begin; p < end; ++p)
        if (has_friction(p) && !is_held[p - begin] &&
            !(state.slip_with(face.points[p], p, x).norm() > 10. * negligible))
          {
            // The gradient of J without the friction of this point.
            ContactState without(state);
            without.bound[p] = 0.;
            NodeProblem others(
              face, face.points[p].node, stiffness, force, without);
            others.is_held   = is_held;
            others.projector = projector;
            Tensor<2, 3>       hessian;
            const Tensor<1, 3> downhill =
              -1. * projector * others.gradient(x, &hessian);
            const Tensor<1, 2> wanted =
              nearest_multiplier(face.points[p], downhill);
            if (!(wanted.norm() > state.bound[p] * (1. + rounding)))
              return {}; // it sticks
            const Tensor<1, 3> rest =
              downhill -
              projector * node_force(face.points[p],
                                     wanted * (state.bound[p] / wanted.norm()));
            return newton_direction(hessian, rest);
          }
      return {};
    }



    double
    NodeProblem::step_length(const Tensor<1, 3> &x,
                             const Tensor<1, 3> &direction) const
    {
      const auto slope = [&](const double step) {
        return gradient(x + step * direction) * direction;
      };
      double left = 0., right = 1.;
      if (std::abs(slope(1.)) <= 1e-8 * std::abs(slope(0.)))
        return 1.;
      while (right < 1e6 && slope(right) < 0.)
        {
          left = right;
          right *= 2.;
        }
      for (unsigned int i = 0; i < 60; ++i)
        {
          const double middle                 = 0.5 * (left + right);
          (slope(middle) < 0. ? left : right) = middle;
        }
      return left;
    }



    std::optional<NodeProblem::Candidate>
    NodeProblem::minimum() const
    {
      // Newton's method from the minimum without contact. If it ends early, the
      // candidate is merely a worse one: the contact solver goes on if the
      // duality gap does not accept the best.
      Tensor<1, 3> x = start + projector * (invert(stiffness) * force - start);
      double       scale = 0.;
      for (unsigned int d = 0; d < 3; ++d)
        scale = std::max(scale, stiffness[d][d]);
      for (unsigned int iteration = 0; iteration < 60 && projector.norm() > 0.5;
           ++iteration)
        {
          Tensor<2, 3>       hessian;
          const Tensor<1, 3> downhill = -1. * projector * gradient(x, &hessian);
          Tensor<1, 3>       direction = newton_direction(hessian, downhill);
          if (!(direction.norm() > negligible))
            if (const auto leaving = departure(x))
              direction = *leaving;
          if (!(direction.norm() > negligible) || !(direction * downhill > 0.))
            break;
          const double step = step_length(x, direction);
          x += step * direction;
          if (step == 0.)
            break;
        }

      Candidate  result{x, is_held};
      const auto room = [&](const unsigned int p) {
        return negligible * face.points[p].map[0].norm();
      };
      for (unsigned int p = begin; p < obstacle; ++p)
        if (has_friction(p) && !is_held[p - begin] &&
            !(state.slip_with(face.points[p], p, x).norm() > room(p)))
          return {};
      for (const unsigned int o : face.rigid(obstacles()))
        if (!is_held[o - begin])
          {
            const double s = slip(face.points[o], x)[0];
            if (s > state.gap(o) + room(o))
              return {};
            // An obstacle that is touched without being held may press, too.
            result.is_held[o - begin] = s >= state.gap(o) - room(o);
          }
      return result;
    }



    double
    NodeProblem::difference(const Candidate &from, const Candidate &to) const
    {
      const Tensor<1, 3> change = to.x - from.x;
      double             result = change * (stiffness * from.x - force) +
                      0.5 * change * (stiffness * change);
      for (unsigned int p = begin; p < obstacle; ++p)
        {
          const auto slip_of = [&](const Candidate &candidate) {
            return candidate.is_held[p - begin] ?
                     Tensor<1, 2>() :
                     state.slip_with(face.points[p], p, candidate.x);
          };
          const Tensor<1, 2> s_from = slip_of(from), s_to = slip_of(to);
          if (const double sum = s_from.norm() + s_to.norm();
              has_friction(p) && sum > 0.)
            result +=
              state.bound[p] * ((s_from + s_to) * (s_to - s_from)) / sum;
        }
      for (const unsigned int o : face.compliant(obstacles()))
        result += face.points[o].compliance.energy(penetration(o, to.x)) -
                  face.points[o].compliance.energy(penetration(o, from.x));
      return result;
    }
  } // namespace



  std::optional<Tensor<1, 3>>
  minimize_at_node(const ContactLayout &face,
                   const unsigned int   node,
                   const Tensor<2, 3>  &stiffness,
                   const Tensor<1, 3>  &force,
                   ContactState        &state)
  {
    NodeProblem        problem(face, node, stiffness, force, state);
    const unsigned int n_sets = 1u << problem.holders.size();
    std::optional<NodeProblem::Candidate> best;
    std::vector<bool>                     held(problem.holders.size());
    for (unsigned int set = 0; set < n_sets; ++set)
      {
        for (unsigned int i = 0; i < held.size(); ++i)
          held[i] = (set >> i & 1) != 0;
        if (!problem.hold(held))
          continue;
        const auto candidate = problem.minimum();
        if (candidate && (!best || problem.difference(*best, *candidate) < 0.))
          best = candidate;
      }
    if (!best)
      return {};
    for (const unsigned int p : face.node_points(node))
      {
        const ContactLayout::Point &point = face.points[p];
        const Tensor<1, 2>          s     = state.slip_with(point, p, best->x);
        state.sticks[p]                   = point.compliance.is_rigid() ?
                                              best->is_held[p - face.first_point[node]] :
                                              s[0] > state.gap(p);
        state.multiplier[p]               = Tensor<1, 2>();
        if (state.slips(point, p))
          state.multiplier[p] = s * (state.bound[p] / s.norm());
      }
    return best->x;
  }
} // namespace Viscoplastic
