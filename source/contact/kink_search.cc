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
      const auto    change = [&](const unsigned int p) {
        const ContactLayout::Point &point = face.points[p];
        return slip(point, face.node_values(direction, point.node));
      };
      for (const unsigned int p : face.friction_points())
        if (state.slips(face.points[p], p))
          line.terms.push_back({state.bound[p], state.slip[p], change(p)});
      for (const unsigned int o : face.compliant(face.obstacles()))
        line.springs.push_back(
          {face.points[o].compliance, state.penetration(o), change(o)[0]});
      return line;
    }



    /// How far a correction takes a node toward an obstacle.
    double
    approach(const ContactLayout  &face,
             const Vector<double> &w,
             const unsigned int    o)
    {
      return slip(face.points[o], face.node_values(w, face.points[o].node))[0];
    }



    /// Whether a correction takes a node beyond the rigid obstacle @p o. False
    /// at corners, where points share a node: they are left to the line search.
    bool
    meets(const ContactLayout  &face,
          const ContactState   &state,
          const Vector<double> &w,
          const unsigned int    o)
    {
      return face.is_plain(face.points[o].node) &&
             approach(face, w, o) > state.room(face.points[o], o);
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
      for (const unsigned int o : face.obstacles())
        if (const double goes = approach(face, w, o); goes > 0.)
          result = std::min(result, state.room(face.points[o], o) / goes);
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
      const unsigned int p     = face.first_point[node];
      bool               stops = false;
      if (reverses(face, state, w, node))
        {
          if (face.obstacles(node).empty())
            here = motion_with_slip(face.points[p], state.foundation_step[p]) -
                   face.node_values(x, node);
          else
            here -=
              motion_with_slip(face.points[p],
                               state.slip[p] + slip(face.points[p], here));
          stops = true;
        }
      for (const unsigned int o : face.obstacles(node))
        if (meets(face, state, w, o))
          {
            const Tensor<1, 3> &normal = face.points[o].map[0];
            here += (state.room(face.points[o], o) - normal * here) /
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
        for (const unsigned int o : face.obstacles(node))
          if (meets(face, old_state, w, o))
            {
              state.sticks[o]  = true;
              state.slip[o][0] = state.gap(o);
            }
        face.set_node_values(step, node, change);
        face.add_node_values(step, node, x);
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
        for (const unsigned int o : face.obstacles())
          if (const double goes = approach(face, result.correction, o);
              goes > 0. && state.room(face.points[o], o) <= near * first * goes)
            held.sticks[o] = true;
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
