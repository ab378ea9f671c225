// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact_solver.h>

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    double
    square(const double a)
    {
      return a * a;
    }



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



    /**
     * The nonlinear Gauss-Seidel step at one node: minimise J over the node's
     * components. By duality, block by block over the node's points; exact at
     * once for a single point, i.e. away from corners.
     */
    Tensor<1, 3>
    relax_node(const FrictionFace        &face,
               const unsigned int         node,
               const Tensor<2, 3>        &inverse_diagonal,
               const Tensor<1, 3>        &force, // residual + D x
               const std::vector<double> &bounds,
               FrictionState             &state)
    {
      const unsigned int     begin      = face.first_point[node];
      const unsigned int     end        = face.first_point[node + 1];
      constexpr unsigned int max_sweeps = 1000;

      Tensor<1, 3> remaining = force;
      for (unsigned int p = begin; p < end; ++p)
        remaining -= node_force(face.points[p], state.multiplier[p]);
      for (unsigned int sweep = 0; sweep < max_sweeps; ++sweep)
        {
          double change = 0., size = 0.;
          for (unsigned int p = begin; p < end; ++p)
            {
              const FrictionFace::Point &point = face.points[p];
              remaining += node_force(point, state.multiplier[p]);
              Tensor<2, 2> flexibility;
              for (unsigned int i = 0; i < point.n_tangents; ++i)
                for (unsigned int j = 0; j < point.n_tangents; ++j)
                  flexibility[i][j] =
                    point.map[i] * (inverse_diagonal * point.map[j]);
              const PointSolution solution =
                solve_friction_point(flexibility,
                                     slip(point, inverse_diagonal * remaining),
                                     point.n_tangents,
                                     bounds[p]);
              change += (solution.multiplier - state.multiplier[p]).norm();
              size += solution.multiplier.norm();
              state.multiplier[p] = solution.multiplier;
              state.sticks[p]     = solution.sticks;
              remaining -= node_force(point, solution.multiplier);
            }
          if (end - begin == 1 || change <= 1e-14 * size)
            break;
        }

      // A node whose only point holds all its components does not move at all,
      // not even by rounding.
      if (end - begin == 1 && state.sticks[begin] &&
          face.points[begin].n_tangents == face.n_node_dofs(node))
        return Tensor<1, 3>();
      return inverse_diagonal * remaining;
    }



    /// The force of slipping points at the current slip: rho s/|s|.
    Tensor<1, 2>
    slipping_multiplier(const double bound, const Tensor<1, 2> &s)
    {
      return bound == 0. ? Tensor<1, 2>() : s * (bound / s.norm());
    }



    /// Update slips from the increment; a slipping point that does not move
    /// sticks.
    void
    update_slips(const FrictionFace        &face,
                 const std::vector<double> &bounds,
                 const Vector<double>      &x,
                 FrictionState             &state)
    {
      for (unsigned int p = 0; p < face.points.size(); ++p)
        {
          state.slip[p] = Tensor<1, 2>();
          if (!state.sticks[p])
            state.slip[p] =
              slip(face.points[p], face.node_values(x, face.points[p].node));
          if (bounds[p] > 0. && state.slip[p].norm() == 0.)
            state.sticks[p] = true;
        }
    }



    FaceTruncation
    make_truncation(const FrictionFace              &face,
                    const std::vector<double>       &bounds,
                    const FrictionState             &state,
                    const std::vector<Tensor<2, 3>> &inverse_diagonal)
    {
      FaceTruncation truncation;
      truncation.projector.resize(face.n_nodes());
      truncation.spring.resize(face.n_nodes());
      for (unsigned int node = 0; node < face.n_nodes(); ++node)
        {
          Tensor<2, 3> &projector = truncation.projector[node];
          for (unsigned int d = 0; d < 3; ++d)
            projector[d][d] = 1.;
          for (unsigned int p = face.first_point[node];
               p < face.first_point[node + 1];
               ++p)
            {
              const FrictionFace::Point &point = face.points[p];
              if (state.sticks[p])
                for (unsigned int i = 0; i < point.n_tangents; ++i)
                  {
                    // Remove what is left of this direction.
                    Tensor<1, 3> q = projector * point.map[i];
                    if (q.norm() > 1e-8 * point.map[i].norm())
                      {
                        q /= q.norm();
                        projector -= outer_product(q, q);
                      }
                  }
              else if (point.n_tangents == 2 && bounds[p] > 0.)
                {
                  // kappa P_e with kappa = rho/|s|, which tends to infinity as
                  // a point comes to rest; 1e10 times the diagonal is stick.
                  const double kappa =
                    std::min(bounds[p] / state.slip[p].norm(),
                             1e10 / inverse_diagonal[node].norm());
                  const Tensor<1, 2> e = state.slip[p] / state.slip[p].norm();
                  const Tensor<1, 3> across =
                    -e[1] * point.map[0] + e[0] * point.map[1];
                  truncation.spring[node] +=
                    kappa * outer_product(across, across);
                }
            }
          // Remove rounding, so that equal sets compare equal.
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              if (std::abs(projector[i][j]) < 1e-14)
                projector[i][j] = 0.;
        }
      return truncation;
    }



    /// J(u + step w) - J(u) and its derivative to the right, without the bulk
    /// terms: the sum over the points.
    struct FrictionAlongLine
    {
      struct Term
      {
        double       bound;
        Tensor<1, 2> slip, change;
      };
      std::vector<Term> terms;

      double
      value(const double step) const
      {
        double sum = 0.;
        for (const Term &term : terms)
          sum += term.bound *
                 ((term.slip + step * term.change).norm() - term.slip.norm());
        return sum;
      }

      double
      derivative(const double step) const
      {
        double sum = 0.;
        for (const Term &term : terms)
          {
            const Tensor<1, 2> s    = term.slip + step * term.change;
            const double       size = s.norm();
            sum += term.bound * (size > 1e-14 * term.change.norm() ?
                                   (s * term.change) / size :
                                   term.change.norm());
          }
        return sum;
      }
    };



    FrictionAlongLine
    friction_along(const FrictionFace        &face,
                   const std::vector<double> &bounds,
                   const FrictionState       &state,
                   const Vector<double>      &direction)
    {
      FrictionAlongLine friction;
      for (unsigned int p = 0; p < face.points.size(); ++p)
        if (!state.sticks[p] && bounds[p] > 0.)
          friction.terms.push_back(
            {bounds[p],
             state.slip[p],
             slip(face.points[p],
                  face.node_values(direction, face.points[p].node))});
      return friction;
    }



    /// Whether a correction @p w makes the slip of a node change sides. At
    /// corners, where points share a node, the line search alone decides.
    bool
    reverses(const FrictionFace        &face,
             const std::vector<double> &bounds,
             const FrictionState       &state,
             const Vector<double>      &w,
             const unsigned int         node)
    {
      const unsigned int p = face.first_point[node];
      if (face.n_node_points(node) != 1 || state.sticks[p] || bounds[p] == 0.)
        return false;
      const Tensor<1, 2> end =
        state.slip[p] + slip(face.points[p], face.node_values(w, node));
      return state.slip[p] * end < 0.;
    }



    /// Shorten a correction @p w where a slip would change sides, so that it
    /// ends at rest instead. Returns whether there is such a slip.
    bool
    stop_at_reversal(const FrictionFace        &face,
                     const std::vector<double> &bounds,
                     const FrictionState       &state,
                     const Vector<double>      &x,
                     Vector<double>            &w)
    {
      bool any = false;
      for (unsigned int node = 0; node < face.n_nodes(); ++node)
        if (reverses(face, bounds, state, w, node))
          {
            face.set_node_values(-1. * face.node_values(x, node), node, w);
            any = true;
          }
      return any;
    }



    /// A step along a line, and what it does to J.
    struct SearchResult
    {
      double step, energy_change;
    };



    /**
     * The step in (0, 2] that minimises J along the correction; 1 if that is as
     * good up to inexact linear solves, 0 if there is no descent.
     */
    SearchResult
    line_search(const BulkSolver::SearchTerms &bulk,
                const FrictionAlongLine       &friction)
    {
      const auto at = [&](const double step) {
        return SearchResult{step,
                            (0.5 * bulk.curvature * step - bulk.slope) * step +
                              friction.value(step)};
      };
      const auto derivative = [&](const double step) {
        return bulk.curvature * step - bulk.slope + friction.derivative(step);
      };
      const double initial = derivative(0.);
      if (!(initial < 0.) || !(bulk.curvature > 0.))
        return {0., 0.};
      if (std::abs(derivative(1.)) <= 0.1 * std::abs(initial) &&
          at(1.).energy_change <= 0.)
        return at(1.);
      double left = 0., right = 1.;
      if (derivative(1.) < 0.)
        {
          left  = 1.;
          right = 2.;
          if (derivative(2.) < 0.)
            return at(2.);
        }
      for (unsigned int bisection = 0; bisection < 60; ++bisection)
        {
          const double middle                      = 0.5 * (left + right);
          (derivative(middle) < 0. ? left : right) = middle;
        }
      return at(left);
    }



    /// A correction that begins with stopping the slips that would reverse.
    struct RestStep
    {
      Vector<double> correction;
      SearchResult   search;
      unsigned int   linear_iterations;
    };

    /**
     * Bring the points whose slip the correction @p w reverses to rest, solve
     * with them sticking, and search along that correction. If J is lower then,
     * the stop is made (@p x and @p state change) and the step is returned, to
     * be taken; otherwise everything is as before but the correction.
     */
    std::optional<RestStep>
    step_from_rest(BulkSolver                      &bulk,
                   const FrictionFace              &face,
                   const std::vector<double>       &bounds,
                   const std::vector<Tensor<2, 3>> &inverse_diagonal,
                   const Vector<double>            &residual,
                   const Vector<double>            &w,
                   Vector<double>                  &x,
                   FrictionState                   &state)
    {
      const FrictionState  old_state = state;
      const Vector<double> old_x     = x;
      Vector<double>       stop(x.size());
      double               energy_change = 0.;
      for (unsigned int node = 0; node < face.n_nodes(); ++node)
        {
          const unsigned int p = face.first_point[node];
          if (!reverses(face, bounds, state, w, node))
            continue;
          energy_change -= bounds[p] * state.slip[p].norm();
          state.sticks[p] = true;
          state.slip[p]   = Tensor<1, 2>();
          face.set_node_values(-1. * face.node_values(x, node), node, stop);
          face.set_node_values(Tensor<1, 3>(), node, x);
        }
      bulk.move_face(stop);
      Vector<double> new_residual(x.size()), force(x.size());
      bulk.face_residual(new_residual);
      // J is quadratic but for friction: its mean slope makes the change.
      energy_change -= 0.5 * (stop * residual + stop * new_residual);

      fit_multipliers(face, bounds, new_residual, state, force);
      bulk.set_truncation(
        make_truncation(face, bounds, state, inverse_diagonal),
        /* may_rebuild = */ false);
      RestStep result;
      result.correction.reinit(x.size());
      result.linear_iterations = bulk.correct(force, 0.05, result.correction);
      stop_at_reversal(face, bounds, state, x, result.correction);
      result.search =
        line_search(bulk.search_terms(result.correction),
                    friction_along(face, bounds, state, result.correction));
      if (energy_change + result.search.energy_change < 0.)
        return result;

      stop *= -1.;
      bulk.move_face(stop);
      x     = old_x;
      state = old_state;
      return {};
    }


    Tensor<1, 2>
    clip(const Tensor<1, 2> &multiplier, const double bound)
    {
      const double size = multiplier.norm();
      return size <= bound ? multiplier : multiplier * (bound / size);
    }



    /// Multipliers that bound the error: those of fit_multipliers() but for
    /// the points listed.
    struct Certificate
    {
      Vector<double> force;
      /// sum of rho |s| - lambda . s.
      double                                             defect = 0.;
      std::vector<std::pair<unsigned int, Tensor<1, 2>>> replaced;
    };

    /**
     * A point that has hardly begun to slip in the plane has a direction s/|s|
     * blurred by rounding: its multiplier rho s/|s| misses the residual by more
     * than its slip is worth. There the clipped residual is the better
     * multiplier, at the price of a small defect of complementarity. A miss of
     * more than 1e-5 of the bound is not rounding.
     */
    Certificate
    certify(const FrictionFace              &face,
            const std::vector<double>       &bounds,
            const Vector<double>            &residual,
            const std::vector<Tensor<2, 3>> &diagonal,
            const FrictionState             &state,
            const Vector<double>            &force)
    {
      Certificate result;
      result.force = force;
      for (unsigned int node = 0; node < face.n_nodes(); ++node)
        {
          const unsigned int         p     = face.first_point[node];
          const FrictionFace::Point &point = face.points[p];
          if (face.n_node_points(node) != 1 || point.n_tangents != 2 ||
              state.sticks[p] || bounds[p] == 0.)
            continue;
          const Tensor<1, 2> here =
            slip(point, face.node_values(residual, node));
          const double misses = (here - state.multiplier[p]).norm();
          if (misses > 1e-5 * bounds[p] ||
              misses <= diagonal[node].norm() * state.slip[p].norm())
            continue;
          const Tensor<1, 2> multiplier = clip(here, bounds[p]);
          result.defect += std::max(0.,
                                    bounds[p] * state.slip[p].norm() -
                                      multiplier * state.slip[p]);
          result.replaced.emplace_back(p, multiplier);
          face.set_node_values(node_force(point, multiplier),
                               node,
                               result.force);
        }
      return result;
    }



    /// Least-norm multipliers of the sticking points of a node with several
    /// points whose forces make up for @p missing, as far as the balls allow.
    void
    fit_node(const FrictionFace        &face,
             const unsigned int         begin,
             const unsigned int         end,
             const std::vector<double> &bounds,
             Tensor<1, 3>              &missing,
             FrictionState             &state)
    {
      // lambda = B (B^T B)^+ missing.
      SymmetricTensor<2, 3> gram;
      for (unsigned int p = begin; p < end; ++p)
        if (state.sticks[p])
          for (unsigned int i = 0; i < face.points[p].n_tangents; ++i)
            gram += symmetrize(
              outer_product(face.points[p].map[i], face.points[p].map[i]));
      const auto   pairs = eigenvectors(gram);
      Tensor<1, 3> solution;
      for (const auto &[value, vector] : pairs)
        if (value > 1e-12 * pairs[0].first)
          solution += (vector * missing) / value * vector;
      bool                      inside = true;
      std::vector<Tensor<1, 2>> lambda(end - begin), z, old;
      for (unsigned int p = begin; p < end; ++p)
        if (state.sticks[p])
          {
            const Tensor<1, 2> free = slip(face.points[p], solution);
            lambda[p - begin]       = clip(free, bounds[p]);
            inside &= free.norm() <= bounds[p];
          }
      // Where that leaves a ball: accelerated projected gradients.
      if (!inside)
        {
          const double L        = pairs[0].first;
          double       momentum = 1.;
          z                     = lambda;
          for (unsigned int step = 0; step < 3000; ++step)
            {
              old                 = lambda;
              Tensor<1, 3> remain = missing;
              for (unsigned int p = begin; p < end; ++p)
                remain -= node_force(face.points[p], z[p - begin]);
              double change = 0., size = 0., uphill = 0.;
              for (unsigned int p = begin; p < end; ++p)
                if (state.sticks[p])
                  {
                    auto &l = lambda[p - begin];
                    l = clip(z[p - begin] + slip(face.points[p], remain) / L,
                             bounds[p]);
                    uphill += (z[p - begin] - l) * (l - old[p - begin]);
                    change += (z[p - begin] - l).norm();
                    size += l.norm();
                  }
              if (change <= 1e-15 * size)
                break;
              const double next =
                uphill > 0. ?
                  1. :
                  0.5 * (1. + std::sqrt(1. + 4. * momentum * momentum));
              const double beta = uphill > 0. ? 0. : (momentum - 1.) / next;
              momentum          = next;
              for (unsigned int p = 0; p < lambda.size(); ++p)
                z[p] = lambda[p] + beta * (lambda[p] - old[p]);
            }
        }
      for (unsigned int p = begin; p < end; ++p)
        if (state.sticks[p])
          {
            state.multiplier[p] = lambda[p - begin];
            missing -= node_force(face.points[p], state.multiplier[p]);
          }
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
    const double stick_size = stick.norm();
    // A zero bound is no friction: the point moves, even if by nothing.
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

    // |(C + m I)^{-1} q| = rho for m = |s|/rho > 0: Newton's method on the
    // reciprocal of the norm is monotone from m = 0 (More, Sorensen).
    double       m          = 0.;
    Tensor<1, 2> multiplier = stick;
    for (unsigned int iteration = 0; iteration < 100; ++iteration)
      {
        const double size = multiplier.norm();
        if (std::abs(size - bound) <= 1e-15 * bound)
          break;
        const double slope =
          multiplier * solve_block(flexibility, m, multiplier, n_tangents);
        const double change = (size / bound - 1.) * square(size) / slope;
        if (!(m + change > m))
          break;
        m += change;
        multiplier = solve_block(flexibility, m, free_slip, n_tangents);
      }
    return {multiplier * (bound / multiplier.norm()), false};
  }



  void
  fit_multipliers(const FrictionFace        &face,
                  const std::vector<double> &bounds,
                  const Vector<double>      &residual,
                  FrictionState             &state,
                  Vector<double>            &force)
  {
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        const unsigned int begin   = face.first_point[node];
        const unsigned int end     = face.first_point[node + 1];
        unsigned int       n_stick = 0;
        Tensor<1, 3>       missing = face.node_values(residual, node);
        for (unsigned int p = begin; p < end; ++p)
          {
            if (state.sticks[p])
              {
                state.multiplier[p] = Tensor<1, 2>();
                ++n_stick;
              }
            else
              state.multiplier[p] =
                slipping_multiplier(bounds[p], state.slip[p]);
            missing -= node_force(face.points[p], state.multiplier[p]);
          }
        // One point of orthonormal rows: the residual, clipped.
        if (n_stick == 1 && end - begin == 1)
          {
            state.multiplier[begin] =
              clip(slip(face.points[begin], missing), bounds[begin]);
            missing -= node_force(face.points[begin], state.multiplier[begin]);
          }
        if (n_stick > 0 && end - begin > 1)
          fit_node(face, begin, end, bounds, missing, state);
        face.set_node_values(face.node_values(residual, node) - missing,
                             node,
                             force);
      }
  }



  ContactSolver::ContactSolver(const double       tolerance,
                               const unsigned int max_iterations)
    : tolerance(tolerance)
    , max_iterations(max_iterations)
  {}



  ContactReport
  ContactSolver::solve(BulkSolver                &bulk,
                       const FrictionFace        &face,
                       const std::vector<double> &bounds,
                       Vector<double>            &x,
                       FrictionState             &state) const
  {
    AssertDimension(bounds.size(), face.points.size());
    AssertDimension(x.size(), face.n_dofs());
    AssertDimension(state.sticks.size(), face.points.size());

    const FaceMatrix         &matrix = bulk.face_matrix();
    std::vector<Tensor<2, 3>> diagonal(face.n_nodes()), inverse(face.n_nodes());
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        diagonal[node] = matrix.diagonal_block(node);
        inverse[node]  = invert(diagonal[node]);
      }

    ContactReport  report;
    Vector<double> residual(face.n_dofs()), force(face.n_dofs()),
      change(face.n_dofs()), w(face.n_dofs());
    FaceTruncation last_truncation;
    double         best_error = std::numeric_limits<double>::max();
    for (unsigned int iteration = 0;; ++iteration)
      {
        // (1) Gauss-Seidel; more sweeps when the corrections do not finish.
        const unsigned int n_sweeps = iteration < 10 ? 1 :
                                      iteration < 30 ? 5 :
                                                       50;
        bulk.face_residual(residual);
        AssertThrow(std::isfinite(residual.l2_norm()),
                    ExcMessage("The contact solver met a residual that is not "
                               "finite."));
        change           = 0.;
        const auto relax = [&](const unsigned int node) {
          const Tensor<1, 3> old = face.node_values(x, node);
          const Tensor<1, 3> r   = face.node_values(residual, node);
          const Tensor<1, 3> now = relax_node(
            face, node, inverse[node], r + diagonal[node] * old, bounds, state);
          const Tensor<1, 3> step = now - old;
          if (step.norm() == 0.)
            return;
          face.set_node_values(now, node, x);
          face.set_node_values(face.node_values(change, node) + step,
                               node,
                               change);
          matrix.subtract(node, step, residual);
        };
        for (unsigned int sweep = 0; sweep < n_sweeps; ++sweep)
          {
            for (unsigned int node = 0; node < face.n_nodes(); ++node)
              relax(node);
            for (unsigned int node = face.n_nodes(); node-- > 0;)
              relax(node);
          }
        bulk.move_face(change);
        bulk.face_residual(residual);
        update_slips(face, bounds, x, state);

        // Where does that leave the error?
        fit_multipliers(face, bounds, residual, state, force);
        const FaceTruncation truncation =
          make_truncation(face, bounds, state, inverse);
        bulk.set_truncation(truncation);
        const Certificate certificate =
          certify(face, bounds, residual, diagonal, state, force);
        const double size  = bulk.energy_norm();
        const auto   bound = [&](const double dual_norm) {
          report.duality_gap = 0.5 * square(dual_norm) + certificate.defect;
          const double error =
            0.5 * (dual_norm +
                   std::sqrt(square(dual_norm) + 4. * certificate.defect));
          report.relative_error = size > 0. ? error / size : 0.;
          return error;
        };
        double error = bound(bulk.dual_norm(certificate.force));
        if (error <= tolerance * size)
          error = bound(bulk.confirmed_dual_norm(certificate.force,
                                                 report.linear_iterations));
        AssertThrow(std::isfinite(error),
                    ExcMessage("The contact solver met a value that is not "
                               "finite."));
        if (error <= tolerance * size)
          {
            for (const auto &[point, multiplier] : certificate.replaced)
              state.multiplier[point] = multiplier;
            break;
          }
        best_error = std::min(best_error, report.relative_error);
        if (iteration == max_iterations)
          {
            std::ostringstream message;
            message << "The active set iteration did not converge in "
                    << max_iterations
                    << " iterations: the relative error bound is " << best_error
                    << " at best, and 'Solver/Contact tolerance' is "
                    << tolerance
                    << "; raise 'Solver/Maximal contact iterations' or the "
                       "tolerance.";
            AssertThrow(false, ExcMessage(message.str()));
          }

        // (2) Solve loosely while the sets still change, and as far as needed
        // once they do not.
        const bool same_sets = iteration > 0 && truncation == last_truncation;
        last_truncation      = truncation;
        report.linear_iterations +=
          bulk.correct(force,
                       same_sets ?
                         std::min(0.05, 0.3 * tolerance * size / error) :
                         0.05,
                       w);

        // (3) A slip that would reverse stops at stick.
        const auto search = [&](const Vector<double> &direction) {
          return line_search(bulk.search_terms(direction),
                             friction_along(face, bounds, state, direction));
        };
        Vector<double> limited(w);
        const bool     any_reverses =
          stop_at_reversal(face, bounds, state, x, limited);
        SearchResult search_result = search(limited);
        if (!any_reverses || search_result.step >= 0.5)
          w = limited;
        else if (const auto rest = step_from_rest(
                   bulk, face, bounds, inverse, residual, w, x, state))
          {
            // When a whole zone reverses, the rest of the body must adapt to
            // its stop before J descends far.
            w             = rest->correction;
            search_result = rest->search;
            report.linear_iterations += rest->linear_iterations;
          }
        else
          {
            // The correction as it is descends, because it solves a positive
            // definite system with the gradient of J.
            bulk.set_truncation(truncation);
            report.linear_iterations += bulk.correct(force, 0.05, w);
            search_result = search(w);
          }
        bulk.take_step(search_result.step);
        x.add(search_result.step, w);
        ++report.iterations;

        // (4) Gauss-Seidel with the bulk at rest and corrections that a kink of
        // J stops may jam. Then the bulk follows the face: with (1) a descent
        // over two blocks, which converges since only the face has kinks.
        if (!(-search_result.energy_change > 0.1 * report.duality_gap))
          {
            FaceTruncation held;
            held.projector.resize(face.n_nodes());
            held.spring.resize(face.n_nodes());
            bulk.set_truncation(held, /* may_rebuild = */ false);
            report.linear_iterations += bulk.correct(force, 0.05, w);
            const BulkSolver::SearchTerms follow = bulk.search_terms(w);
            if (follow.curvature > 0.)
              bulk.take_step(follow.slope / follow.curvature);
          }
      }
    report.linear_iterations += bulk.finish();

    return report;
  }
} // namespace Viscoplastic
