// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/quantity_estimator.h>

// The parts of a quantity's error by friction bounds, and those settled by
// slip: at points that come to rest, turn or continue under other bounds.

namespace Viscoplastic
{
  template <int dim>
  void
  QuantityEstimator<dim>::settle(BulkSolver                &solver,
                                 const CoulombLaw          *law,
                                 const EvaluatedState<dim> &accepted,
                                 const FlowRate            *old_rate,
                                 const ContactState        &contact,
                                 QuantityEstimate          &estimate) const
  {
    const QuantityEstimate &before = accepted.errors.quantity;
    const ContactState     &old    = accepted.state.contact;
    ContactState            held   = old;
    // Of points that have slipped: the bounds of those that rest or turn back
    // now, of the others, and their decrease; and the quadrature error.
    std::vector<double> sums(4, 0.);
    for (const unsigned int p : discretization.face->layout().friction_points())
      {
        if (!old.sticks[p])
          {
            held.sticks[p] = contact.sticks[p] ||
                             contact.multiplier[p] * old.multiplier[p] < 0.;
            sums[held.sticks[p] ? 0 : 1] += old.bound[p];
            if (!held.sticks[p])
              sums[2] += old.bound[p] - contact.bound[p];
          }
        if (!contact.sticks[p])
          sums[3] -=
            0.5 * (contact.bound[p] - old.bound[p]) * contact.slip[p].norm();
      }
    Utilities::MPI::sum(sums, discretization.space.communicator, sums);
    const double all    = sums[0] + sums[1];
    const double share  = all > 0. ? (sums[0] + sums[2]) / all : 0.;
    const double work   = estimate.value - before.value;
    estimate.slip_work  = (1. - share) * before.slip_work + work;
    estimate.slip_steps = work > 0. ? estimate.slip_work / work : 0.;
    // The error at the start of the step, and that of what slips on.
    const double mesh = before.space_correction - before.settled_space;
    double       left = mesh;
    if (sums[0] > 0. && accepted.state.k > 0.)
      {
        left = 0.;
        if (sums[1] > 0.)
          {
            EvaluatedState<dim> resting = accepted;
            resting.state.contact       = held;
            resting.space_estimate      = {};
            if (old_rate != nullptr) // absent from a state that is restored
              resting.rate = *old_rate;
            renew(solver, discretization.matrix, resting, law, dual_of_step);
            left = assess_mesh(law, resting);
          }
      }
    estimate.settled_space = before.settled_space + (mesh - left);
    if (sums[1] > 0.)
      estimate.settled_space += sums[2] / sums[1] * left;
    estimate.settled_time =
      before.settled_time + sums[3] +
      share * (before.time_correction - before.settled_time);
  }



  template <int dim>
  Vector<double>
  QuantityEstimator<dim>::unresolved_bounds(const State<dim>        &state,
                                            const ContactState      &contact,
                                            const DualSolution<dim> &dual,
                                            const double slip_steps) const
  {
    if (!boundary_defects.has_varying_bounds() ||
        !discretization.slipping_face())
      return {};
    return boundary_defects.unresolved_bounds(
      state, dual_problem.change_by_bounds(contact, dual, slip_steps));
  }



  template <int dim>
  void
  QuantityEstimator<dim>::hold(BulkSolver                &solver,
                               const EvaluatedState<dim> &accepted,
                               const ContactState        &contact,
                               const CoulombLaw          *law,
                               ErrorEstimate             &errors) const
  {
    const QuantityEstimate &before   = accepted.errors.quantity;
    QuantityEstimate       &estimate = errors.quantity;
    const ContactState     &old      = accepted.state.contact;
    ContactState            held     = old;
    bool                    has_rest = false;
    double sums[2] = {0., 0.}; // bounds of what has stuck, and still does
    const ContactLayout &face = discretization.face->layout();
    for (const unsigned int p : face.friction_points())
      if (old.holds(face.points[p], p))
        {
          sums[0] += old.bound[p];
          sums[1] += contact.holds(face.points[p], p) ? old.bound[p] : 0.;
        }
      else if (contact.holds(face.points[p], p))
        {
          has_rest = held.sticks[p] = true;
          held.bound[p]             = contact.bound[p];
        }
    Utilities::MPI::sum(ArrayView<const double>(sums),
                        discretization.space.communicator,
                        ArrayView<double>(sums));
    const double share = sums[0] > 0. ? sums[1] / sums[0] : 0.;
    double       space = 0.; // of what comes to rest
    // A run begins with exact positions of points by definition.
    const bool settles = accepted.state.k > 0. && face.any(has_rest);
    if (settles)
      for (const bool is_held : {false, true})
        {
          const ContactState     &then = is_held ? held : old;
          const DualSolution<dim> dual = dual_problem.solve(solver, then, law);
          const double sign = (is_held ? -1. : 1.) * dual_problem.sign();
          const auto  &triangulation =
            discretization.space.dof_handler.get_triangulation();
          space +=
            sign *
            sum_over_cells(unresolved_bounds(accepted.state, then, dual, 1.),
                           triangulation)[0];
          if (!(dual.norm > 0.))
            continue;
          const Vector<double> parts =
            space_estimator.multiply(accepted.state,
                                     accepted.forces,
                                     space_estimator.residuals_of(dual),
                                     0.);
          space += sign * sum_over_cells(parts, triangulation)[0];
        }
    estimate.rest_space = share * before.rest_space + space;
    estimate.settled_space =
      errors.remembered_share * (share * before.settled_space + space) +
      errors.remembered_gain * estimate.rest_space;
  }



  template <int dim>
  void
  QuantityEstimator<dim>::add_slip_defects(BulkSolver              &solver,
                                           const SlipDefects       &defects,
                                           const ContactState      &contact,
                                           const CoulombLaw        *law,
                                           const DualSolution<dim> &dual,
                                           QuantityEstimate &estimate) const
  {
    const ContactLayout &face    = discretization.face->layout();
    ContactState         held    = contact;
    bool                 is_held = false;
    for (unsigned int p = 0; p < contact.n_points(); ++p)
      if (defects.resting[p].norm_square() > 0.)
        is_held = held.sticks[p] = true;
    const Vector<double> force   = face.any(is_held) ?
                                     dual_problem.solve(solver, held, law).force :
                                     dual.force;
    double               turning = 0., resting = 0.;
    for (unsigned int p = 0; p < contact.n_points(); ++p)
      {
        const ContactLayout::Point &point = face.points[p];
        const Tensor<1, 3>          f     = face.node_values(force, point.node);
        turning += f * motion_with_slip(point, defects.turning[p]);
        resting += std::abs(f * motion_with_slip(point, defects.resting[p]));
      }
    estimate.turning += std::abs(face.sum(turning));
    estimate.resting += face.sum(resting);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, settle);
  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, unresolved_bounds);
  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, hold);
  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, add_slip_defects);
} // namespace Viscoplastic
