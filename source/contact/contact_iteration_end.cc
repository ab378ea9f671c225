// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/contact/contact_iteration.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// A stalled error up to this many times the rounding of the residual is
    /// rounding. If that exceeds largest_rounding times the solution, it is
    /// refused.
    constexpr double rounding_margin = 10., largest_rounding = 1e-3;
    /// An error estimated by a preconditioner below this part of the tolerance
    /// needs no confirmation, if the preconditioned condition number is below
    /// 1e6.
    constexpr double beyond_doubt = 1e-3;
    /// If the error on the truncated space alone is more than this many times
    /// the tolerance, the full norm is not computed.
    constexpr double by_far = 10.;
    /// A limit for `misjudged`, since other estimates will be less wrong.
    constexpr double largest_misjudgment = 10.;



    /// Whether all friction points have one state, and all obstacles.
    /// Collective.
    bool
    all_do_the_same(const ContactLayout &face, const ContactState &state)
    {
      std::array<bool, 4> any{};
      for (const unsigned int o : face.obstacles())
        any[state.sticks[o] ? 2 : 3] = true;
      for (const unsigned int p : face.friction_points())
        if (state.bound[p] > 0.)
          any[state.sticks[p] ? 0 : 1] = true;
      for (unsigned int kind = 0; kind < (face.has_obstacles ? 4 : 2); ++kind)
        any[kind] = face.any(any[kind]);
      return !(any[0] && any[1]) && !(any[2] && any[3]);
    }
  } // namespace



  bool
  ContactIteration::is_solved()
  {
    const bool follow = bounds && bounds->follow();
    fit_multipliers(face, residual, state, force, follow ? law : nullptr);
    if (bounds)
      bounds->measure(state);
    FaceTruncation last = std::move(truncation);
    truncation          = make_truncation(face, state, inverse_diagonal);
    if (follow)
      law->tilt(face, state, inverse_diagonal, truncation);
    // The problem is linear if all points stick, or all slip without turning:
    // one accurate solve is enough unless the first sweep has changed the sets.
    same_sets =
      report.iterations == 0 ?
        !face.any(state.sticks != first_sets) && all_do_the_same(face, state) &&
          !truncation.has_springs(face) :
        truncation.blocks_as(last, face) &&
          // Projectors do not show the state of compliant obstacles.
          !(face.has_obstacles && face.any(state.sticks != last_sets));
    if (face.has_obstacles)
      last_sets = state.sticks;
    bulk.set_truncation(truncation);
    const Certificate certificate = certify(
      face, residual, diagonal, state, force, bulk.scale.rounding_error);
    size = std::max(bulk.size(), bulk.scale.rounding_error / tolerance);
    double estimate = 0.;
    error           = 0.;
    // Try the cheaper norm first: mostly the error is still large.
    if (!bounds && !bulk.is_exact && !face.any(!certificate.replaced.empty()))
      {
        estimate = bulk.truncated_dual_norm(force);
        error    = bound(misjudged * estimate, certificate);
      }
    if (!(error > by_far * tolerance * size))
      {
        estimate = bulk.dual_norm(certificate.force);
        error    = bound(misjudged * estimate, certificate);
      }
    if (error <= tolerance * size && error > beyond_doubt * tolerance * size)
      {
        // If the norm is above this, the error is above the tolerance.
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
    if (!std::isfinite(error))
      refuse("The contact solver met a value that is not finite.");
    if (report.relative_error < 0.5 * best_error)
      {
        last_gain     = report.iterations;
        next_question = last_gain + stalled_after;
      }
    best_error = std::min(best_error, report.relative_error);
    if (report.iterations == 0 && size > 0.)
      first_ratio = error / (tolerance * size);
    // Copied before is_rounding() raises it: with flat cells the forces of a
    // whole edge would then count as rounding.
    const double blur = bulk.scale.rounding_error;
    if (error > tolerance * size && !is_rounding(certificate))
      return false;
    report.error = error;
    for (const auto &[point, multiplier] : certificate.replaced)
      state.multiplier[point] = multiplier;
    // Remove pressures that are rounding, from which bounds would follow.
    for (const unsigned int o : face.obstacles())
      {
        const ContactLayout::Point &point = face.points[o];
        const double                stiffness =
          point.map[0] * (diagonal[point.node] * point.map[0]);
        // On a soft foundation, rounding of displacements makes less force.
        const double share =
          point.compliance.is_rigid() ?
            1. :
            std::min(1.,
                     point.compliance.slope(state.penetration(o)) / stiffness);
        if (state.multiplier[o][0] <= share * blur * std::sqrt(stiffness))
          {
            state.multiplier[o][0] = 0.;
            state.sticks[o]        = false;
          }
      }
    return true;
  }


  double
  ContactIteration::bound(const double       dual_norm,
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
  ContactIteration::is_rounding(const Certificate &certificate)
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
    // The residual is not known more accurately than that.
    error                     = std::max(error, rounding);
    report.relative_error     = error / size;
    bulk.scale.rounding_error = std::max(bulk.scale.rounding_error, error);
    return true;
  }


  void
  ContactIteration::give_up()
  {
    std::ostringstream message;
    message << "The active set iteration did not converge in "
            << report.iterations << " iterations: the relative error bound is "
            << best_error << " at best, and the tolerance is " << tolerance
            << "; ";
    if (bounds)
      AssertThrow(false, NoCoulombSolution(message.str() + bounds->failure()));
    // Such stiffness turns rounding of displacements into any force.
    constexpr double beyond_rounding = 1e13;
    double           stiffest        = 0.;
    for (const unsigned int o : face.obstacles())
      {
        const ContactLayout::Point &point = face.points[o];
        stiffest                          = std::max(stiffest,
                            point.compliance.slope(state.penetration(o)) *
                              (point.map[0] *
                               (inverse_diagonal[point.node] * point.map[0])));
      }
    stiffest = Utilities::MPI::max(stiffest, face.communicator);
    if (stiffest > beyond_rounding)
      message << "the foundation is " << stiffest
              << " times as stiff as the body, which no number resolves: give "
                 "a smaller compliance, or its limit, unilateral contact.";
    else if (const double rounding =
               report.iterations >= last_gain + stalled_after ?
                 bulk.rounding_of_residual() / size :
                 0.;
             // In exact solvers, strongly varying stiffness magnifies it.
             best_error < (bulk.is_exact ? 1e10 : 1e3) * rounding)
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
                                  "use the direct linear solver, on one "
                                  "rank, ")
              << "allow more iterations or a larger tolerance of contact.";
    refuse(message.str());
  }
} // namespace Viscoplastic
