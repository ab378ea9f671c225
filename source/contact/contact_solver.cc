// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/timer.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/heartbeat.h>
#include <viscoplastic_contact/contact/contact_solver.h>
#include <viscoplastic_contact/contact/coulomb_bounds.h>
#include <viscoplastic_contact/contact/kink_search.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// The relative tolerance of linear solves as long as the sets change.
    constexpr double loose_tolerance = 0.05;
    /// A linear solve that shall bring the error below the tolerance aims at
    /// this part of it.
    constexpr double safety = 0.3;
    /// A correction that stops at reversing slips is taken as it is if it goes
    /// that far; otherwise something better is tried.
    constexpr double least_limited_step = 0.5;
    /// The least decrease of J in a correction, relative to the duality gap.
    constexpr double least_descent = 0.1;
    /// After so many iterations that have not halved the error, it may be what
    /// rounding leaves of the residual, or some times as much, since rounding
    /// of each term counts. More than this part of the solution is refused.
    constexpr unsigned int stalled_after   = 15;
    constexpr double       rounding_margin = 10., largest_rounding = 1e-3;
    /// An error that is this part of its tolerance by the estimate of a
    /// preconditioner is below the tolerance by any: that takes one whose
    /// condition number is less than 1e6.
    constexpr double beyond_doubt = 1e-3;
    /// So many corrections may begin with nodes where pieces meet that have not
    /// settled: that finds sets; later it takes the node from a solution.
    constexpr unsigned int unsettled_corrections = 5;
    /// Where no solution is found, it is sought along those for these parts of
    /// the friction coefficients, to this tolerance.
    constexpr std::array<double, 4> parts_of_friction{{0., 0.25, 0.5, 0.75}};
    constexpr double                tolerance_of_parts = 1e-3;
    /// Estimates found too low are not taken for more than so many times too
    /// low: others will be less so.
    constexpr double largest_misjudgment = 10.;



    /// Gauss-Seidel; more sweeps when the corrections do not finish.
    unsigned int
    sweeps_of_iteration(const unsigned int iteration)
    {
      return iteration < 10 ? 1 : iteration < 30 ? 5 : 50;
    }



    /// Update slips from the increment; a slipping point that does not move
    /// sticks.
    void
    update_slips(const ContactLayout  &face,
                 const Vector<double> &x,
                 ContactState         &state)
    {
      for (unsigned int p = 0; p < face.points.size(); ++p)
        {
          const ContactLayout::Point &point = face.points[p];
          state.slip[p]                     = Tensor<1, 2>();
          if (!state.sticks[p] || point.is_obstacle)
            state.slip[p] =
              state.slip_with(point, p, face.node_values(x, point.node));
          if (point.gives_way())
            state.sticks[p] = state.penetration(p) > 0.;
          if (!point.is_obstacle && state.bound[p] > 0. &&
              state.slip[p].norm() == 0.)
            state.sticks[p] = true;
        }
    }



    /// Bring points to rest whose slip is nothing but rounding, an error of the
    /// size of @p rounding in the energy norm: its direction means nothing, but
    /// would be that of a force of the size of the bound. @p change takes part.
    void
    stop_rounding(const ContactLayout             &face,
                  const std::vector<Tensor<2, 3>> &diagonal,
                  const double                     rounding,
                  Vector<double>                  &x,
                  Vector<double>                  &change,
                  ContactState                    &state)
    {
      for (unsigned int node = 0; node < face.n_nodes(); ++node)
        {
          const unsigned int p = face.first_point[node];
          if (!face.has_plain_friction(node) || state.sticks[p] ||
              state.bound[p] == 0.)
            continue;
          const Tensor<1, 3> here = face.node_values(x, node);
          const Tensor<1, 3> part =
            motion_with_slip(face.points[p],
                             state.slip_with(face.points[p], p, here));
          if (part * (diagonal[node] * part) >
              Utilities::fixed_power<2>(rounding))
            continue;
          face.set_node_values(here - part, node, x);
          face.set_node_values(face.node_values(change, node) - part,
                               node,
                               change);
          state.sticks[p] = true;
        }
    }



    /// Whether all points with friction do the same, stick or slip, and all
    /// obstacles are touched or none. Collective.
    bool
    all_do_the_same(const ContactLayout &face, const ContactState &state)
    {
      std::array<bool, 4> any{};
      for (unsigned int p = 0; p < state.n_points(); ++p)
        if (face.points[p].is_obstacle)
          any[state.sticks[p] ? 2 : 3] = true;
        else if (state.bound[p] > 0.)
          any[state.sticks[p] ? 0 : 1] = true;
      for (unsigned int kind = 0; kind < (face.has_obstacles ? 4 : 2); ++kind)
        any[kind] = face.any(any[kind]);
      return !(any[0] && any[1]) && !(any[2] && any[3]);
    }
  } // namespace



  /// One solve: what it works on, and the phases of its iterations.
  class ContactSolver::Iteration
  {
  public:
    Iteration(ContactSolve        &bulk,
              const ContactLayout &face,
              const double         tolerance,
              Vector<double>      &x,
              ContactState        &state,
              const CoulombLaw    *law,
              const bool           is_near = false);

    ContactReport
    solve(const unsigned int max_iterations);

    /// All of it but what completes the displacement.
    void
    iterate(const unsigned int max_iterations);

  private:
    /// (1) Nonlinear Gauss-Seidel over the face nodes.
    void
    relax(const unsigned int n_sweeps);

    /// The Gauss-Seidel step at one node; adds it to @p change.
    void
    relax_node(const unsigned int node, Vector<double> &change);

    /// Whether the error bound is within the tolerance; then the multipliers
    /// are those that prove it.
    bool
    is_solved();

    /// Whether the iteration has come to rest above the tolerance with an error
    /// that is rounding of the residual; then this is the rounding error of the
    /// bulk.
    bool
    is_rounding(const Certificate &certificate);

    /// The bound on the error that a dual norm of the residual means, for the
    /// report.
    double
    bound(const double dual_norm, const Certificate &certificate);

    /// (2) The linear solve on the truncated space: a correction w.
    void
    correct();

    /// (3) Go along w as far as J decreases, no slip further than to rest and
    /// no node further than to its obstacle.
    /// Returns the change of J.
    double
    search();

    /// (4) Let the bulk follow the face.
    void
    follow();

    void
    give_up();

    /// What a solve without friction would have taken.
    double
    plain_seconds(const double seconds_to_finish) const;

    ContactSolve        &bulk;
    const ContactLayout &face;
    const double         tolerance;
    /// The increment of the face, and what contact does there.
    Vector<double> &x;
    ContactState   &state;
    /// Coulomb's law of the step's own pressure; null where bounds are given.
    const CoulombLaw *const law;

    const FaceMatrix         &matrix;
    std::vector<Tensor<2, 3>> diagonal, inverse_diagonal; // node by node
    std::vector<double>       rounding; // of steps of nodes, relative
    /// With a law.
    std::optional<CoulombBounds> bounds;

    /// l - A u, the forces of the multipliers that fit it, and a correction, on
    /// the face.
    Vector<double> residual, force, w;
    /// The present one, and whether the last correction was made with the same
    /// sticking points.
    FaceTruncation truncation;
    bool           same_sets = false;
    /// The sets of the start, and where there are obstacles those of the last
    /// correction.
    const std::vector<bool> first_sets;
    std::vector<bool>       last_sets;
    /// Bound on the error and size of the solution in the energy norm.
    double error = 0., size = 0.;
    /// The dual norm over its estimate when this was found too low.
    double misjudged  = 1.;
    double best_error = std::numeric_limits<double>::max();
    /// The iteration that has halved that last, and that before which rounding
    /// is not to be asked for again.
    unsigned int last_gain = 0, next_question = stalled_after;
    /// The error of the start over the tolerance.
    double first_ratio = 0.;
    /// Wall time of the corrections, and by how many powers of ten they were to
    /// reduce their residuals.
    double correction_seconds = 0., decades = 0.;

    ContactReport report;
  };



  ContactSolver::Iteration::Iteration(ContactSolve        &bulk,
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
  ContactSolver::Iteration::iterate(const unsigned int max_iterations)
  {
    for (unsigned int iteration = 0;; ++iteration)
      {
        Heartbeat::count(Loop::contact);
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
        // Gauss-Seidel with the bulk at rest and corrections that a kink of J
        // stops may jam. Then the bulk follows the face: with (1) a descent
        // over two blocks, which converges since only the face has kinks.
        if (!(-energy_change > least_descent * report.duality_gap))
          follow();
      }
  }



  ContactReport
  ContactSolver::Iteration::solve(const unsigned int max_iterations)
  {
    iterate(max_iterations);
    const Timer timer;
    report.linear_iterations += bulk.finish();
    if (bounds)
      {
        report.bound_iterations = bounds->n_moves();
        report.contraction      = bounds->largest_loss();
        report.doubt            = bounds->doubt();
      }
    report.plain_seconds = plain_seconds(timer.wall_time());
    return report;
  }



  double
  ContactSolver::Iteration::plain_seconds(const double seconds_to_finish) const
  {
    if (bulk.is_exact)
      return seconds_to_finish;
    return decades > 0. && first_ratio > 1. ?
             correction_seconds / decades * std::log10(first_ratio / safety) :
             0.;
  }



  void
  ContactSolver::Iteration::relax(const unsigned int n_sweeps)
  {
    residual = bulk.face_residual();
    AssertThrow(!face.any(std::any_of(residual.begin(),
                                      residual.end(),
                                      [](const double r) {
                                        return !std::isfinite(r);
                                      })),
                ExcMessage("The contact solver met a residual that is not "
                           "finite."));
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
    // rounding_error is a hundred units of rounding.
    stop_rounding(
      face, diagonal, 0.01 * bulk.scale.rounding_error, x, change, state);
    bulk.move_face(change);
    residual = bulk.face_residual();
    update_slips(face, x, state);
  }



  void
  ContactSolver::Iteration::relax_node(const unsigned int node,
                                       Vector<double>    &change)
  {
    const auto sets = [&] {
      unsigned int mask = 0;
      for (unsigned int p = face.first_point[node];
           p < face.first_point[node + 1];
           ++p)
        mask = 2 * mask + state.sticks[p];
      return mask;
    };
    const unsigned int old_sets = sets();
    const Tensor<1, 3> old      = face.node_values(x, node);
    const Tensor<1, 3> r        = face.node_values(residual, node);
    const Tensor<1, 3> f        = r + diagonal[node] * old;
    const auto         now =
      bounds && bounds->nodes_obey_law() ?
                law->relax_node(face,
                        node,
                        inverse_diagonal[node],
                        f,
                        state,
                        report.iterations >= unsettled_corrections) :
                Viscoplastic::relax_node(face, node, inverse_diagonal[node], f, state);
    if (!now)
      return;
    const Tensor<1, 3> step = *now - old;
    // What rounding makes is no step: the bulk would have to follow it. Deep
    // penetration of soft ground rounds the motions that it is the sum of.
    double size = old.norm();
    for (unsigned int p = face.first_point[node];
         p < face.first_point[node + 1];
         ++p)
      if (const ContactLayout::Point &point = face.points[p]; point.gives_way())
        size = std::max(size, std::abs(state.bound[p]) / point.map[0].norm());
    if (step.norm() <= rounding[node] * size && sets() == old_sets)
      return;
    face.set_node_values(*now, node, x);
    face.set_node_values(face.node_values(change, node) + step, node, change);
    matrix.subtract(node, step, residual);
  }



  double
  ContactSolver::Iteration::bound(const double       dual_norm,
                                  const Certificate &certificate)
  {
    report.duality_gap =
      0.5 * Utilities::fixed_power<2>(dual_norm) + certificate.defect;
    const double result =
      0.5 * (dual_norm + std::sqrt(Utilities::fixed_power<2>(dual_norm) +
                                   4. * certificate.defect));
    const double with_bounds =
      bounds ? bounds->error_with_bounds(result) : result;
    report.relative_error = size > 0. ? with_bounds / size : 0.;
    return with_bounds;
  }



  bool
  ContactSolver::Iteration::is_solved()
  {
    const bool follow = bounds && bounds->follow();
    fit_multipliers(face, residual, state, force, follow ? law : nullptr);
    if (bounds)
      bounds->measure(state);
    FaceTruncation last = std::move(truncation);
    truncation          = make_truncation(face, state, inverse_diagonal);
    if (follow)
      law->tilt(face, state, truncation);
    // A face that sticks or slips altogether, and whose slip does not turn,
    // makes a linear problem: unless the first sweep has found otherwise, it
    // takes no more than a plain solve.
    same_sets =
      report.iterations == 0 ?
        !face.any(state.sticks != first_sets) && all_do_the_same(face, state) &&
          !truncation.has_springs(face) :
        truncation.blocks_as(last, face) &&
          // Obstacles that give way do not block.
          !(face.has_obstacles && face.any(state.sticks != last_sets));
    if (face.has_obstacles)
      last_sets = state.sticks;
    bulk.set_truncation(truncation);
    const Certificate certificate = certify(
      face, residual, diagonal, state, force, bulk.scale.rounding_error);
    size = std::max(bulk.size(), bulk.scale.rounding_error / tolerance);
    const double estimate = bulk.dual_norm(certificate.force);
    error                 = bound(misjudged * estimate, certificate);
    if (error <= tolerance * size && error > beyond_doubt * tolerance * size)
      {
        // Above this, the bound is above the tolerance.
        const double limit = tolerance * size /
                             (bounds ? bounds->error_with_bounds(1.) -
                                         bounds->error_with_bounds(0.) :
                                       1.);
        const double confirmed =
          bulk.confirmed_dual_norm(certificate.force,
                                   limit,
                                   report.linear_iterations);
        error = bound(confirmed, certificate);
        if (estimate > 0.)
          misjudged = std::clamp(confirmed / estimate, 1., largest_misjudgment);
      }
    AssertThrow(std::isfinite(error),
                ExcMessage("The contact solver met a value that is not "
                           "finite."));
    if (report.relative_error < 0.5 * best_error)
      {
        last_gain     = report.iterations;
        next_question = last_gain + stalled_after;
      }
    best_error = std::min(best_error, report.relative_error);
    if (report.iterations == 0 && size > 0.)
      first_ratio = error / (tolerance * size);
    if (error > tolerance * size && !is_rounding(certificate))
      return false;
    report.error = error;
    for (const auto &[point, multiplier] : certificate.replaced)
      state.multiplier[point] = multiplier;
    // What presses by rounding does not touch: Coulomb's law would make bounds
    // of it.
    for (unsigned int p = 0; p < face.points.size(); ++p)
      if (face.points[p].is_obstacle)
        {
          const ContactLayout::Point &point = face.points[p];
          const double                stiffness =
            point.map[0] * (diagonal[point.node] * point.map[0]);
          // Of soft ground, rounding of displacements makes less.
          const double share =
            point.gives_way() ?
              std::min(1.,
                       point.compliance.slope(state.penetration(p)) /
                         stiffness) :
              1.;
          if (state.multiplier[p][0] <=
              share * bulk.scale.rounding_error * std::sqrt(stiffness))
            {
              state.multiplier[p][0] = 0.;
              state.sticks[p]        = false;
            }
        }
    return true;
  }



  bool
  ContactSolver::Iteration::is_rounding(const Certificate &certificate)
  {
    if (report.iterations < next_question)
      return false;
    next_question += stalled_after;
    const double rounding = bulk.rounding_of_residual();
    error =
      bound(bulk.confirmed_dual_norm(certificate.force,
                                     std::numeric_limits<double>::infinity(),
                                     report.linear_iterations),
            certificate);
    if (rounding > largest_rounding * size)
      give_up();
    if (error > rounding_margin * rounding)
      return false;
    // Data are no better known than that.
    error                     = std::max(error, rounding);
    report.relative_error     = error / size;
    bulk.scale.rounding_error = std::max(bulk.scale.rounding_error, error);
    return true;
  }



  void
  ContactSolver::Iteration::give_up()
  {
    std::ostringstream message;
    message << "The active set iteration did not converge in "
            << report.iterations << " iterations: the relative error bound is "
            << best_error << " at best, and the tolerance is " << tolerance
            << " ('Solver/Contact tolerance'); ";
    if (bounds)
      AssertThrow(false, NoCoulombSolution(message.str() + bounds->failure()));
    // Rounding of displacements makes forces of all sizes of it.
    constexpr double beyond_rounding = 1e13;
    double           stiffest        = 0.;
    for (unsigned int p = 0; p < face.points.size(); ++p)
      if (const ContactLayout::Point &point = face.points[p]; point.gives_way())
        stiffest = std::max(stiffest,
                            point.compliance.slope(state.penetration(p)) *
                              (point.map[0] *
                               (inverse_diagonal[point.node] * point.map[0])));
    stiffest = Utilities::MPI::max(stiffest, face.communicator);
    if (stiffest > beyond_rounding)
      message << "the foundation is " << stiffest
              << " times as stiff as the body, which no number resolves: give "
                 "a smaller 'Compliance', or 'Contact law' = unilateral, its "
                 "limit.";
    else if (const double rounding =
               report.iterations >= last_gain + stalled_after ?
                 bulk.rounding_of_residual() / size :
                 0.;
             // Exact solvers come to rest for no other reason.
             rounding > 0. && (bulk.is_exact || best_error < 1e3 * rounding))
      {
        message << "it has come to rest there, and rounding alone makes "
                << rounding
                << " or more of it. Cells that are less flat, stiffness that "
                   "differs less or Poisson's ratio farther from 1/2 mend that"
                << (rounding > largest_rounding ? "." :
                                                  ", or a larger tolerance.");
      }
    else
      message << (bulk.is_exact ? "" :
                                  "use 'Solver/Linear solver' = direct, on "
                                  "one rank, ")
              << "raise 'Solver/Maximal contact iterations' or the tolerance.";
    AssertThrow(false, ExcMessage(message.str()));
  }



  void
  ContactSolver::Iteration::correct()
  {
    // Loosely while the sets still change, and as far as needed once they do
    // not.
    // From zero, the first solution sets the scale.
    double reduction =
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
  ContactSolver::Iteration::search()
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
        // When a whole zone reverses, the rest of the body must adapt to its
        // stop before J descends far.
        w      = rest->correction;
        result = rest->search;
        report.linear_iterations += rest->linear_iterations;
      }
    else
      {
        // The correction as it is descends, because it solves a positive
        // definite system with the gradient of J.
        bulk.set_truncation(truncation);
        report.linear_iterations += bulk.correct(force, loose_tolerance, w);
        result = along(w);
      }
    bulk.take_step(result.step);
    face.add(result.step, w, x);
    return result.energy_change;
  }



  void
  ContactSolver::Iteration::follow()
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



  ContactSolver::ContactSolver(const unsigned int max_iterations)
    : max_iterations(max_iterations)
  {}



  ContactReport
  ContactSolver::solve(ContactSolve        &bulk,
                       const ContactLayout &face,
                       const double         tolerance,
                       Vector<double>      &x,
                       ContactState        &state,
                       const CoulombLaw    *law) const
  {
    AssertDimension(x.size(), face.n_dofs());
    AssertDimension(state.n_points(), face.points.size());
    if (law == nullptr)
      return Iteration(bulk, face, tolerance, x, state, nullptr)
        .solve(max_iterations);
    const Vector<double> first_x(x);
    const ContactState   first(state);
    try
      {
        return Iteration(bulk, face, tolerance, x, state, law)
          .solve(max_iterations);
      }
    catch (const ExceptionBase &)
      {
        // Once more from the start, without friction at first, and then with
        // more and more of it, each time near the last solution.
        const std::exception_ptr failure = std::current_exception();
        Vector<double>           back(first_x);
        face.add(-1., x, back);
        bulk.move_face(back);
        x     = first_x;
        state = first;
        try
          {
            for (const double part : parts_of_friction)
              {
                const CoulombLaw weaker = law->with_part(part);
                Iteration(bulk,
                          face,
                          std::max(tolerance, tolerance_of_parts),
                          x,
                          state,
                          &weaker,
                          part > 0.)
                  .iterate(max_iterations);
              }
            ContactReport report =
              Iteration(bulk, face, tolerance, x, state, law, true)
                .solve(max_iterations);
            if (report.doubt.empty())
              report.doubt = "from the last step no solution was found, but "
                             "one along those for smaller friction "
                             "coefficients";
            return report;
          }
        catch (const ExceptionBase &)
          {
            std::rethrow_exception(failure);
          }
      }
  }
} // namespace Viscoplastic
