// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/timer.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/contact/contact_iteration.h>
#include <viscoplastic_contact/contact/kink_search.h>

#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// The relative tolerance of linear solves as long as the sets change: what
    /// a set needs to be replaced by a better one.
    constexpr double loose_tolerance = 0.2;
    /// A correction that stops at reversing slips is taken if the line search
    /// goes this far along it; otherwise others are tried.
    constexpr double least_limited_step = 0.5;
    /// If a correction lowers J by less than this part of the duality gap, the
    /// bulk follows the face.
    constexpr double least_descent = 0.1;
    /// For this many corrections, sweeps move nodes where pieces meet even if
    /// their laws have not settled: that finds sets, but later leads away from
    /// a solution.
    constexpr unsigned int unsettled_corrections = 5;



    /// The number of Gauss-Seidel sweeps: more if corrections do not converge.
    unsigned int
    sweeps_of_iteration(const unsigned int iteration)
    {
      return iteration < 10 ? 1 : iteration < 30 ? 5 : 50;
    }



    /// Bring points to rest whose slip is at most @p rounding in the energy
    /// norm, since its meaningless direction would be that of a force of the
    /// size of the bound. Changes @p x and @p change alike.
    void
    stop_rounding(const ContactLayout             &face,
                  const std::vector<Tensor<2, 3>> &diagonal,
                  const double                     rounding,
                  Vector<double>                  &x,
                  Vector<double>                  &change,
                  ContactState                    &state)
    {
      for (unsigned int p = 0; p < face.points.size(); ++p)
        {
          const ContactLayout::Point &point = face.points[p];
          if (!state.slips(point, p))
            continue;
          const unsigned int node = point.node;
          const Tensor<1, 3> here = face.node_values(x, node);
          const Tensor<1, 3> part =
            motion_with_slip(point, state.slip_with(point, p, here));
          if (part * (diagonal[node] * part) >
              Utilities::fixed_power<2>(rounding))
            continue;
          state.sticks[p] = true;
          // Where pieces meet, other points may hold the node.
          if (!face.has_plain_friction(node))
            continue;
          face.set_node_values(here - part, node, x);
          face.add_node_values(-part, node, change);
        }
    }
  } // namespace



  ContactIteration::ContactIteration(ContactSolve        &bulk,
                                     const ContactLayout &face,
                                     const double         tolerance,
                                     Vector<double>      &x,
                                     ContactState        &state,
                                     const CoulombLaw    *law,
                                     const bool           is_near)
    : bulk(bulk)
    , face(face)
    , tolerance(tolerance)
    , x(x)
    , state(state)
    , law(law)
    , matrix(bulk.face_matrix())
    , diagonal(face.n_nodes())
    , inverse_diagonal(face.n_nodes())
    , rounding(face.n_nodes())
    , residual(face.n_dofs())
    , force(face.n_dofs())
    , w(face.n_dofs())
    , first_sets(state.sticks)
  {
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        diagonal[node]         = matrix.diagonal_block(node);
        inverse_diagonal[node] = invert(diagonal[node]);
        rounding[node]         = 4. * std::numeric_limits<double>::epsilon() *
                         diagonal[node].norm() * inverse_diagonal[node].norm();
      }
    if (law != nullptr)
      bounds.emplace(*law, face, inverse_diagonal);
    if (bounds && is_near)
      bounds->begin_near_solution();
    report.tolerance = tolerance;
  }


  void
  ContactIteration::iterate(const unsigned int max_iterations)
  {
    for (unsigned int iteration = 0;; ++iteration)
      {
        relax(sweeps_of_iteration(iteration));
        if (is_solved())
          break;
        if (iteration == max_iterations)
          give_up();
        if (bounds && bounds->damp(error, report.iterations, state))
          continue;
        correct();
        const double energy_change = search();
        ++report.iterations;
        // Gauss-Seidel with the bulk at rest and corrections that stop at kinks
        // of J may stall. With relax(), follow() makes a block descent over
        // face and bulk, which converges since only the face has kinks.
        if (!(-energy_change > least_descent * report.duality_gap))
          follow();
      }
  }


  ContactReport
  ContactIteration::solve(const unsigned int max_iterations)
  {
    iterate(max_iterations);
    const Timer timer;
    report.linear_iterations += bulk.finish();
    if (bounds)
      {
        report.bound_iterations = bounds->n_moves();
        report.contraction      = bounds->largest_loss();
        report.doubt            = bounds->doubt();
        // Without corrections, an earlier solve has examined the same sets.
        if (report.doubt.empty() && report.iterations > 0 &&
            bounds->may_be_singular() && bulk.has_negative_determinant())
          report.doubt = "a pivot of the slipping points has changed its sign";
      }
    report.plain_seconds = plain_seconds(timer.wall_time());
    return report;
  }


  double
  ContactIteration::plain_seconds(const double seconds_to_finish) const
  {
    if (bulk.is_exact)
      return seconds_to_finish;
    return decades > 0. && first_ratio > 1. ?
             correction_seconds / decades * std::log10(first_ratio / safety) :
             0.;
  }


  void
  ContactIteration::relax(const unsigned int n_sweeps)
  {
    residual = bulk.face_residual();
    if (face.any(std::any_of(residual.begin(),
                             residual.end(),
                             [](const double r) { return !std::isfinite(r); })))
      refuse("The contact solver met a residual that is not finite.");
    const auto    &stages = matrix.stages();
    Vector<double> change(face.n_dofs());
    const auto relax_stage = [&](const unsigned int s, const bool backward) {
      const auto    &nodes = stages[s];
      Vector<double> change_in_stage(face.n_dofs());
      for (unsigned int i = 0; i < nodes.size(); ++i)
        relax_node(nodes[backward ? nodes.size() - 1 - i : i], change_in_stage);
      matrix.subtract_changes_elsewhere(s, change_in_stage, residual);
      face.add(1., change_in_stage, change);
    };
    for (unsigned int sweep = 0; sweep < n_sweeps; ++sweep)
      {
        for (unsigned int s = 0; s < stages.size(); ++s)
          relax_stage(s, false);
        for (unsigned int s = stages.size(); s-- > 0;)
          relax_stage(s, true);
      }
    // rounding_error is a hundred times the rounding of a solution.
    stop_rounding(
      face, diagonal, 0.01 * bulk.scale.rounding_error, x, change, state);
    bulk.move_face(change);
    residual = bulk.face_residual();
    for (unsigned int p = 0; p < face.points.size(); ++p)
      state.set_slip(face.points[p],
                     p,
                     face.node_values(x, face.points[p].node));
  }


  void
  ContactIteration::relax_node(const unsigned int node, Vector<double> &change)
  {
    const auto sets = [&] {
      unsigned int mask = 0;
      for (const unsigned int p : face.node_points(node))
        mask = 2 * mask + state.sticks[p];
      return mask;
    };
    const unsigned int          old_sets = sets();
    const Tensor<1, 3>          old      = face.node_values(x, node);
    const Tensor<1, 3>          r        = face.node_values(residual, node);
    const Tensor<1, 3>          f        = r + diagonal[node] * old;
    const Tensor<2, 3>         &inverse  = inverse_diagonal[node];
    std::optional<Tensor<1, 3>> now;
    // Where pieces meet and one is compliant, what each piece holds drifts in
    // sweeps with Coulomb's law at the node, which serve to find the sets.
    // Every other sweep has fixed bounds and leaves the rest to corrections.
    const auto compliant   = face.compliant(face.obstacles(node));
    const bool bounds_rest = report.iterations >= unsettled_corrections &&
                             report.iterations % 2 == 1 &&
                             !face.has_plain_friction(node) &&
                             !compliant.empty();
    if (!bounds || !bounds->nodes_obey_law() || bounds_rest)
      now = Viscoplastic::relax_node(face, node, inverse, f, state);
    else
      now = law->relax_node(face,
                            node,
                            inverse,
                            f,
                            state,
                            report.iterations >= unsettled_corrections);
    if (!now)
      return;
    const Tensor<1, 3> step = *now - old;
    // Skip steps that are rounding, which the bulk would have to follow.
    // Rounding is relative to the penetration, too, if that is deep.
    double size = old.norm();
    for (const unsigned int o : compliant)
      size =
        std::max(size, std::abs(state.gap(o)) / face.points[o].map[0].norm());
    if (step.norm() <= rounding[node] * size && sets() == old_sets)
      return;
    face.set_node_values(*now, node, x);
    face.add_node_values(step, node, change);
    matrix.subtract(node, step, residual);
  }


  void
  ContactIteration::correct()
  {
    // Loosely while the sets still change, as far as needed once they do not.
    // With a zero start, errors are relative to the first solution.
    const double reduction =
      same_sets ? std::clamp(safety * tolerance * size / error,
                             std::min(safety * tolerance, loose_tolerance),
                             loose_tolerance) :
                  loose_tolerance;
    const Timer timer;
    report.linear_iterations += bulk.correct(force, reduction, w);
    correction_seconds += timer.wall_time();
    decades -= std::log10(reduction);
    if (bounds && bounds->follow())
      bounds->predict(bulk, truncation, residual, w, state);
  }


  double
  ContactIteration::search()
  {
    const auto along = [&](const Vector<double> &direction) {
      return search_along(bulk, face, state, direction);
    };
    Vector<double> limited(w);
    const bool     any_stops = stop_at_kinks(face, state, x, limited);
    SearchResult   result    = along(limited);
    if (!any_stops || result.step >= least_limited_step)
      w = limited;
    else if (const auto rest = step_from_kinks(bulk,
                                               face,
                                               inverse_diagonal,
                                               residual,
                                               w,
                                               loose_tolerance,
                                               x,
                                               state))
      {
        // When a whole zone reverses, J descends far only after the rest of the
        // body has adapted to the zone at rest.
        w      = rest->correction;
        result = rest->search;
        report.linear_iterations += rest->linear_iterations;
      }
    else
      {
        // The unmodified correction descends, since it solves a positive
        // definite system with the gradient of J; obstacles may limit the step.
        const KinkStep past = step_past_obstacles(bulk,
                                                  face,
                                                  inverse_diagonal,
                                                  truncation,
                                                  force,
                                                  loose_tolerance,
                                                  least_limited_step,
                                                  state);
        w                   = past.correction;
        result              = past.search;
        report.linear_iterations += past.linear_iterations;
      }
    bulk.take_step(result.step);
    face.add(result.step, w, x);
    return result.energy_change;
  }


  void
  ContactIteration::follow()
  {
    FaceTruncation held;
    held.projector.resize(face.n_nodes());
    held.spring.resize(face.n_nodes());
    bulk.set_truncation(held, /* may_rebuild = */ false);
    report.linear_iterations += bulk.correct(force, loose_tolerance, w);
    const ContactSolve::SearchTerms terms = bulk.search_terms(w);
    if (terms.curvature > 0.)
      bulk.take_step(terms.slope / terms.curvature);
  }
} // namespace Viscoplastic
