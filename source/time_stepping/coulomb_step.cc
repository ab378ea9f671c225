// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/contact/coulomb_bounds.h>
#include <viscoplastic_contact/time_stepping/step_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

// Coulomb's law with the pressure of the step itself: solved within the step,
// or by a fixed-point iteration of steps with given bounds.

namespace Viscoplastic
{
  namespace
  {
    /// Solutions are different ones if they differ by more than this part of
    /// the largest displacement.
    constexpr double several_solutions = 1e-2;

    /// After this many solves that have not halved the change of bounds, it may
    /// be rounding of pressures, but only if it is below largest_blur times the
    /// bounds.
    constexpr unsigned int stalled_after = 15;
    constexpr double       largest_blur  = 1e-3;



    /// The message if the last of @p n_solves has changed the bounds by @p
    /// change of their sum, @p factor times as much as the one before.
    std::string
    no_fixed_point(const unsigned int n_solves,
                   const double       change,
                   const double       factor)
    {
      std::ostringstream message;
      message << "The fixed point of Coulomb's law is not found in " << n_solves
              << " solves of the step: the friction bounds still change by "
              << change
              << " of their sum, and the last solve has reduced the change "
                 "by the factor "
              << factor
              << ". For a large friction coefficient, and where pieces with "
                 "friction meet at an edge, the problem itself may have no "
                 "unique solution; 'Solver/Coulomb pressure' = lagged takes "
                 "the pressure of the step before.";
      if (change < 1e-3)
        message << " Where stiffness differs much, or cells are flat, "
                   "rounding of forces may allow no less: a larger "
                   "'Solver/Coulomb tolerance' accepts that.";
      return message.str();
    }
  } // namespace



  template <int dim>
  ContactReport
  StepSolver<dim>::solve(const StepProblem<dim>  &problem,
                         const DistributedVector &right_side,
                         const double             tolerance,
                         DistributedVector       &u,
                         ContactState            &contact)
  {
    if (springs)
      contact.bound = springs->bounds_that_hold(problem, contact.bound);
    if (problem.bounds_follow_pressure && discretization.slipping_face() &&
        problem.parameters.coulomb_pressure == CoulombPressure::newton)
      {
        const DistributedVector first_u(u);
        const ContactState      first(contact);
        try
          {
            return solve_with_own_pressure(
              problem, right_side, tolerance, u, contact);
          }
        catch (const NoCoulombSolution &failure)
          {
            // If Newton's method stalls, as for flat bodies whose foundations
            // meet at an edge, solves with given bounds may converge.
            const std::string why = reason(failure);
            u                     = first_u;
            contact               = first;
            try
              {
                return find_fixed_point(
                  problem, right_side, tolerance, u, contact);
              }
            catch (const ExceptionBase &)
              {
                AssertThrow(false,
                            NoCoulombSolution(
                              why + " 'Solver/Coulomb pressure' = lagged takes "
                                    "the pressure of the step before."));
              }
          }
      }
    return find_fixed_point(problem, right_side, tolerance, u, contact);
  }



  template <int dim>
  ContactReport
  StepSolver<dim>::find_fixed_point(const StepProblem<dim>  &problem,
                                    const DistributedVector &right_side,
                                    const double             tolerance,
                                    DistributedVector       &u,
                                    ContactState            &contact)
  {
    const SolverParameters &parameters = problem.parameters;
    ContactReport           report =
      solve_with_bounds(problem, right_side, tolerance, u, contact);
    if (!problem.bounds_follow_pressure || !discretization.slipping_face())
      return report;

    const ContactFace<dim> &face        = *discretization.face;
    double                  last_change = 0.;
    // The relaxation factor of bounds, below 1 once they oscillate, and their
    // misfit before the last move.
    double              share = 1.;
    std::vector<double> last_missing;
    // The change of bounds when it was last halved, and the solve.
    double       best_change = std::numeric_limits<double>::max();
    unsigned int last_gain   = 0;
    for (;;)
      {
        std::vector<double> bounds = problem.given_bounds;
        face.add_computed_bounds(problem.time_step.t,
                                 contact,
                                 bounds,
                                 problem.slip_rates);
        std::vector<double> missing(bounds.size(), 0.);
        double              change = 0., sum = 0.;
        for (const unsigned int p : face.layout().friction_points())
          {
            missing[p] = bounds[p] - contact.bound[p];
            change += std::abs(missing[p]);
            // Each of the bounds may be zero: take the largest one.
            double largest = bounds[p];
            for (const double bound : {contact.bound[p], problem.bounds[p]})
              if (std::isfinite(bound))
                largest = std::max(largest, bound);
            sum += largest;
          }
        change = face.layout().sum(change);
        sum    = face.layout().sum(sum);
        // Ratios of changes that are errors of the solves mean nothing.
        if (report.bound_iterations > 0 && std::isfinite(last_change) &&
            last_change > 1e3 * tolerance * sum)
          report.contraction =
            std::max(report.contraction, change / last_change);
        if (change <= parameters.coulomb_tolerance * sum)
          return report;
        if (change < 0.5 * best_change)
          {
            best_change = change;
            last_gain   = report.bound_iterations;
          }
        // Pressures are known only up to rounding of the forces of which they
        // are sums.
        if (change <= largest_blur * sum &&
            report.bound_iterations > last_gain + stalled_after &&
            change <= rounding_of_bounds(problem, right_side, u))
          {
            report.relative_error =
              std::max(report.relative_error, change / sum);
            return report;
          }
        if (report.bound_iterations >= parameters.maximal_iterations)
          refuse(no_fixed_point(report.bound_iterations,
                                change / sum,
                                change / last_change));
        // Pressures may oscillate between two states, since friction may hold
        // what would press, as where pieces meet. Then relax the bounds by
        // Aitken's rule.
        const bool swings = share < 1. || (report.bound_iterations > 0 &&
                                           change >= 0.999 * last_change &&
                                           std::isfinite(last_change));
        if (swings && std::isfinite(change))
          {
            const auto aitken =
              aitken_factor(face.layout(), share, last_missing, missing);
            share = aitken ? std::clamp(*aitken, 1e-3, 0.9) : 0.5;
            for (unsigned int p = 0; p < bounds.size(); ++p)
              bounds[p] -= (1. - share) * missing[p];
          }
        last_missing = missing;
        last_change  = change;
        contact.bound =
          springs ? springs->bounds_that_hold(problem, bounds) : bounds;
        ContactReport again =
          solve_with_bounds(problem, right_side, tolerance, u, contact);
        ++again.bound_iterations;
        again.add_earlier(report);
        report = again;
      }
  }



  template <int dim>
  double
  StepSolver<dim>::rounding_of_bounds(const StepProblem<dim>  &problem,
                                      const DistributedVector &right_side,
                                      DistributedVector       &u)
  {
    const ContactFace<dim> &face   = *discretization.face;
    const ContactLayout    &layout = face.layout();
    const double            rounding =
      bulk_solver->begin(right_side, u)->rounding_of_residual();
    std::vector<Tensor<2, 3>> diagonal;
    for (unsigned int node = 0; node < layout.n_nodes(); ++node)
      diagonal.push_back(bulk_solver->face_matrix().diagonal_block(node));
    const auto bounds_of_pressure =
      face.bounds_of_pressure(problem.time_step.t, problem.slip_rates);
    double sum = 0.;
    for (unsigned int p = 0; p < layout.points.size(); ++p)
      for (const double of_pressure : bounds_of_pressure[p])
        // The dual norm of a nodal force f is at least f / sqrt(diagonal).
        sum += of_pressure * rounding *
               std::sqrt(diagonal[layout.points[p].node].norm());
    return layout.sum(sum);
  }



  template <int dim>
  ContactReport
  StepSolver<dim>::solve_with_own_pressure(const StepProblem<dim>  &problem,
                                           const DistributedVector &right_side,
                                           const double             tolerance,
                                           DistributedVector       &u,
                                           ContactState            &contact)
  {
    const ContactFace<dim> &face = *discretization.face;
    const CoulombLaw        law{{problem.given_bounds,
                                 face.bounds_of_pressure(problem.time_step.t,
                                                  problem.slip_rates)},
                         [&face](const unsigned int node) {
                           std::ostringstream place;
                           place << '(' << face.position(node) << ')';
                           return place.str();
                         }};
    const DistributedVector first_u(u);
    const ContactState      first(contact);
    ContactReport           report =
      solve_with_bounds(problem, right_side, tolerance, u, contact, &law);
    if (report.doubt.empty())
      return report;

    // Solve from the solutions without friction and without slip, too: if one
    // of them ends elsewhere, there are several solutions.
    double difference = 0.;
    for (const double bound : {0., std::numeric_limits<double>::infinity()})
      {
        DistributedVector other_u(first_u);
        ContactState      other(first);
        for (const unsigned int p : face.layout().friction_points())
          if (face.layout().has_plain_friction(face.layout().points[p].node))
            other.bound[p] = bound;
        try
          {
            for (const CoulombLaw *const given_or_law :
                 {static_cast<const CoulombLaw *>(nullptr), &law})
              report.linear_iterations +=
                solve_with_bounds(
                  problem, right_side, tolerance, other_u, other, given_or_law)
                  .linear_iterations;
            other_u -= u;
            difference = std::max(difference, other_u.linfty_norm());
          }
        catch (const ExceptionBase &)
          {
            // This start has found no other solution.
          }
      }
    // If the body has lifted off, u may be zero.
    difference /= std::max(u.linfty_norm(), first_u.linfty_norm());
    std::ostringstream text;
    text << report.doubt;
    if (difference > several_solutions)
      text << "; from another start there is another solution, whose "
              "displacement differs by "
           << difference << " of the largest there is or was";
    else
      text << "; the starts without friction and without slip end in no other "
              "solution";
    report.doubt = text.str();
    return report;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(StepSolver, solve);
} // namespace Viscoplastic
