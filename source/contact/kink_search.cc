// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/kink_search.h>

#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// The functional of friction j(v) = sum_c rho_c |v_c| and the energy of
    /// compliant obstacles along a line: their change and its right derivative.
    /// Collective.
    struct FaceAlongLine
    {
      struct Friction
      {
        double       bound;
        Tensor<1, 2> slip, change;
      };
      struct Spring
      {
        const NormalCompliance &compliance;
        double                  penetration, change;
      };
      const ContactLayout  &face;
      std::vector<Friction> terms; // of this rank
      std::vector<Spring>   springs;

      double
      value(const double step) const
      {
        double sum = 0.;
        for (const Friction &term : terms)
          sum += term.bound *
                 ((term.slip + step * term.change).norm() - term.slip.norm());
        for (const Spring &spring : springs)
          sum += spring.compliance.energy(spring.penetration +
                                          step * spring.change) -
                 spring.compliance.energy(spring.penetration);
        return face.sum(sum);
      }

      double
      derivative(const double step) const
      {
        double sum = 0.;
        for (const Spring &spring : springs)
          sum +=
            spring.compliance.force(spring.penetration + step * spring.change) *
            spring.change;
        for (const Friction &term : terms)
          {
            const Tensor<1, 2> s    = term.slip + step * term.change;
            const double       size = s.norm();
            sum += term.bound * (size > 1e-14 * term.change.norm() ?
                                   (s * term.change) / size :
                                   term.change.norm());
          }
        return face.sum(sum);
      }
    };



    FaceAlongLine
    face_along(const ContactLayout  &face,
               const ContactState   &state,
               const Vector<double> &direction)
    {
      FaceAlongLine line{face, {}, {}};
      for (unsigned int p = 0; p < face.points.size(); ++p)
        {
          const ContactLayout::Point &point  = face.points[p];
          const auto                  change = [&] {
            return slip(point, face.node_values(direction, point.node));
          };
          if (point.gives_way())
            line.springs.push_back(
              {point.compliance, state.penetration(p), change()[0]});
          else if (state.slips(point, p))
            line.terms.push_back({state.bound[p], state.slip[p], change()});
        }
      return line;
    }



    /// How far a node may go, and goes with a correction, toward an obstacle
    /// that it does not touch yet; it meets the obstacle if `goes` > `may`.
    struct Approach
    {
      double may, goes;
    };

    Approach
    approach(const ContactLayout  &face,
             const ContactState   &state,
             const Vector<double> &w,
             const unsigned int    p)
    {
      const ContactLayout::Point &point = face.points[p];
      return {std::max(0., state.bound[p] - state.slip[p][0]),
              slip(point, face.node_values(w, point.node))[0]};
    }



    /// Whether a correction takes a node beyond the rigid obstacle @p p. False
    /// at corners, where points share a node: they are left to the line search.
    bool
    meets(const ContactLayout  &face,
          const ContactState   &state,
          const Vector<double> &w,
          const unsigned int    p)
    {
      const unsigned int node = face.points[p].node;
      if (state.sticks[p] || face.points[p].gives_way() ||
          face.first_point[node + 1] - face.first_obstacle(node) != 1 ||
          !(face.first_point[node] == p || face.has_plain_friction(node)))
        return false;
      const Approach to = approach(face, state, w, p);
      return to.goes > to.may;
    }



    /// The largest step up to @p most that enters no rigid obstacle.
    /// Collective.
    double
    largest_step(const ContactLayout  &face,
                 const ContactState   &state,
                 const Vector<double> &w,
                 const double          most)
    {
      double result = most;
      if (!face.has_obstacles)
        return result;
      for (unsigned int p = 0; p < face.points.size(); ++p)
        if (face.points[p].is_rigid_obstacle() && !state.sticks[p])
          {
            const Approach to = approach(face, state, w, p);
            if (to.goes > 0.)
              result = std::min(result, to.may / to.goes);
          }
      return Utilities::MPI::min(result, face.communicator);
    }



    /// Whether a correction @p w reverses the slip of a node. False at corners,
    /// where points share a node: they are left to the line search.
    bool
    reverses(const ContactLayout  &face,
             const ContactState   &state,
             const Vector<double> &w,
             const unsigned int    node)
    {
      const unsigned int p = face.first_point[node];
      if (!face.has_plain_friction(node) || state.sticks[p] ||
          state.bound[p] == 0.)
        return false;
      const Tensor<1, 2> end =
        state.slip[p] + slip(face.points[p], face.node_values(w, node));
      return state.slip[p] * end < 0.;
    }



    /// If a correction @p w takes a node beyond a kink of J, let the change @p
    /// here of the node end at the kink: slip that would reverse comes to rest,
    /// motion into an obstacle ends at it. Returns whether the node stops.
    bool
    stop_node_at_kinks(const ContactLayout  &face,
                       const ContactState   &state,
                       const Vector<double> &x,
                       const Vector<double> &w,
                       const unsigned int    node,
                       Tensor<1, 3>         &here)
    {
      const unsigned int p              = face.first_point[node],
                         end            = face.first_point[node + 1],
                         first_obstacle = face.first_obstacle(node);
      bool stops                        = false;
      if (reverses(face, state, w, node))
        {
          if (first_obstacle == end)
            here = motion_with_slip(face.points[p], state.foundation_step[p]) -
                   face.node_values(x, node);
          else
            here -=
              motion_with_slip(face.points[p],
                               state.slip[p] + slip(face.points[p], here));
          stops = true;
        }
      for (unsigned int o = first_obstacle; o < end; ++o)
        if (meets(face, state, w, o))
          {
            const Tensor<1, 3> &normal = face.points[o].map[0];
            here += (approach(face, state, w, o).may - normal * here) /
                    normal.norm_square() * normal;
            stops = true;
          }
      return stops;
    }



    /// The step up to @p largest that minimizes J along the correction; 1 if
    /// that is as good up to inexact linear solves, 0 if there is no descent.
    SearchResult
    line_search(const ContactSolve::SearchTerms &bulk,
                const FaceAlongLine             &face,
                const double                     largest)
    {
      const auto at = [&](const double step) {
        return SearchResult{step,
                            (0.5 * bulk.curvature * step - bulk.slope) * step +
                              face.value(step)};
      };
      const auto derivative = [&](const double step) {
        return bulk.curvature * step - bulk.slope + face.derivative(step);
      };
      const double initial = derivative(0.);
      if (!(initial < 0.) || !(bulk.curvature >= 0.))
        return {0., 0.};
      double left = 0., right = std::min(1., largest);
      if (right == 1. && std::abs(derivative(1.)) <= 0.1 * std::abs(initial) &&
          at(1.).energy_change <= 0.)
        return at(1.);
      if (derivative(right) < 0.)
        {
          do
            {
              left  = right;
              right = std::min(2. * right, largest);
            }
          while (right < largest && derivative(right) < 0.);
          if (right == largest && derivative(right) < 0.)
            return at(right);
        }
      // To full relative accuracy, since the step may be much smaller than 1.
      for (unsigned int bisection = 0;
           bisection < 200 &&
           right - left > std::numeric_limits<double>::epsilon() * right;
           ++bisection)
        {
          const double middle                      = 0.5 * (left + right);
          (derivative(middle) < 0. ? left : right) = middle;
        }
      return at(left);
    }
  } // namespace



  SearchResult
  search_along(ContactSolve         &bulk,
               const ContactLayout  &face,
               const ContactState   &state,
               const Vector<double> &w)
  {
    return line_search(bulk.search_terms(w),
                       face_along(face, state, w),
                       largest_step(face, state, w, 2.));
  }



  double
  repetitions(const ContactSolve::SearchTerms &terms,
              const ContactLayout             &face,
              const ContactState              &state,
              const Vector<double>            &w)
  {
    // terms.slope is that of all of J, and line_search() takes the bulk's.
    const FaceAlongLine line = face_along(face, state, w);
    return line_search({terms.slope + line.derivative(0.), terms.curvature},
                       line,
                       largest_step(face, state, w, 1e9))
      .step;
  }



  bool
  stop_at_kinks(const ContactLayout  &face,
                const ContactState   &state,
                const Vector<double> &x,
                Vector<double>       &w)
  {
    bool any = false;
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        Tensor<1, 3> here = face.node_values(w, node);
        if (!stop_node_at_kinks(face, state, x, w, node, here))
          continue;
        face.set_node_values(here, node, w);
        any = true;
      }
    return face.any(any);
  }



  double
  bring_to_kinks(const ContactLayout  &face,
                 const Vector<double> &w,
                 Vector<double>       &x,
                 ContactState         &state,
                 Vector<double>       &change)
  {
    const ContactState   old_state     = state;
    const Vector<double> old_x         = x;
    double               energy_change = 0.;
    change.reinit(x.size());
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        Tensor<1, 3> step;
        if (!stop_node_at_kinks(face, old_state, old_x, w, node, step))
          continue;
        const unsigned int p = face.first_point[node];
        if (reverses(face, old_state, w, node))
          {
            energy_change -= state.bound[p] * state.slip[p].norm();
            state.sticks[p] = true;
            state.slip[p]   = Tensor<1, 2>();
          }
        for (unsigned int o = face.first_obstacle(node);
             o < face.first_point[node + 1];
             ++o)
          if (meets(face, old_state, w, o))
            {
              state.sticks[o]  = true;
              state.slip[o][0] = state.bound[o];
            }
        face.set_node_values(step, node, change);
        face.set_node_values(face.node_values(x, node) + step, node, x);
      }
    return face.sum(energy_change);
  }



  std::optional<KinkStep>
  step_from_kinks(ContactSolve                    &bulk,
                  const ContactLayout             &face,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal,
                  const Vector<double>            &residual,
                  const Vector<double>            &w,
                  const double                     tolerance,
                  Vector<double>                  &x,
                  ContactState                    &state)
  {
    const ContactState   old_state = state;
    const Vector<double> old_x     = x;
    Vector<double>       stop;
    const double         change_of_j = bring_to_kinks(face, w, x, state, stop);
    bulk.move_face(stop);
    const Vector<double> new_residual = bulk.face_residual();
    Vector<double>       force(x.size());
    // The energy of the bulk is quadratic: the mean of its slopes is exact.
    const double energy_change =
      change_of_j -
      0.5 * (face.dot(stop, residual) + face.dot(stop, new_residual));

    fit_multipliers(face, new_residual, state, force);
    bulk.set_truncation(make_truncation(face, state, inverse_diagonal),
                        /* may_rebuild = */ false);
    KinkStep result;
    result.linear_iterations = 0;
    // The face has moved with the bulk at rest. Where that enlarges the
    // residual much, as in nearly incompressible bodies, the same absolute
    // accuracy takes a smaller relative tolerance.
    const double made = std::sqrt(face.dot(residual, residual) /
                                  face.dot(new_residual, new_residual));
    for (const double reduction :
         {tolerance, tolerance * std::clamp(made, 1e-6, 1.)})
      {
        result.correction.reinit(x.size());
        result.linear_iterations +=
          bulk.correct(force, reduction, result.correction);
        stop_at_kinks(face, state, x, result.correction);
        result.search = search_along(bulk, face, state, result.correction);
        if (energy_change + result.search.energy_change < 0.)
          return result;
        if (bulk.is_exact)
          break;
      }

    Vector<double> back(x.size());
    face.add(-1., stop, back);
    bulk.move_face(back);
    x     = old_x;
    state = old_state;
    return {};
  }



  KinkStep
  step_past_obstacles(ContactSolve                    &bulk,
                      const ContactLayout             &face,
                      const std::vector<Tensor<2, 3>> &inverse_diagonal,
                      const FaceTruncation            &truncation,
                      const Vector<double>            &force,
                      const double                     tolerance,
                      const double                     least,
                      const ContactState              &state)
  {
    // Hold obstacles that are met within this many times the way to the first
    // one; a larger factor would hold all of a body that falls far.
    constexpr double near = 2.;
    KinkStep         result;
    result.linear_iterations = 0;
    result.correction.reinit(face.n_dofs());
    const auto solve = [&](const FaceTruncation &blocked) {
      bulk.set_truncation(blocked, /* may_rebuild = */ false);
      result.linear_iterations +=
        bulk.correct(force, tolerance, result.correction);
      result.search = search_along(bulk, face, state, result.correction);
    };
    solve(truncation);

    FaceTruncation best = truncation;
    ContactState   held = state;
    for (;;)
      {
        const double first = largest_step(face, held, result.correction, 1.);
        if (!(first < least))
          return result;
        for (unsigned int p = 0; p < face.points.size(); ++p)
          if (face.points[p].is_rigid_obstacle() && !held.sticks[p])
            {
              const Approach to = approach(face, state, result.correction, p);
              held.sticks[p] = to.goes > 0. && to.may <= near * first * to.goes;
            }
        const double   before = result.search.energy_change;
        FaceTruncation next   = make_truncation(face, held, inverse_diagonal);
        solve(next);
        if (!(result.search.energy_change < before))
          {
            solve(best);
            return result;
          }
        best = std::move(next);
      }
  }
} // namespace Viscoplastic
