// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/time_stepping/step_method.h>

namespace Viscoplastic
{
  namespace
  {
    /// Whether the old multipliers are within the new bounds, and so a solution
    /// at rest; false if obstacles may move.
    template <int dim>
    bool
    holds_at_rest(const ContactFace<dim>    &face,
                  const ContactState        &old,
                  const std::vector<double> &bounds)
    {
      if (old.n_points() != bounds.size() ||
          (face.has_obstacles() && face.bounds_depend_on_time()))
        return false;
      for (const unsigned int p : face.layout().friction_points())
        if (!(bounds[p] >= old.bound[p] ||
              old.multiplier[p].norm() <= bounds[p]))
          return false;
      return true;
    }
  } // namespace



  template <int dim>
  void
  StepSolution<dim>::stay(const StepProblem<dim>     &problem,
                          const AdmissibleSpace<dim> &space,
                          const ContactFace<dim>     *face)
  {
    const State<dim> &old = problem.old.state;
    state.u               = old.u;
    state.velocity        = space.ghosted_vector();
    state.contact         = old.contact;
    ContactState &contact = state.contact;
    contact.bound         = problem.bounds;
    if (problem.foundation_step.size() > 0)
      contact.foundation_step = problem.foundation_step;
    if (problem.bounds_follow_pressure)
      {
        contact.bound = problem.given_bounds;
        face->add_computed_bounds(problem.time_step.t,
                                  old.contact,
                                  contact.bound,
                                  problem.slip_rates);
      }
    contact.slip.assign(contact.n_points(), Tensor<1, 2>());
    if (face != nullptr)
      for (const unsigned int p : face->layout().friction_points())
        contact.sticks[p] = contact.bound[p] > 0.;
    // The bound on the error is that of the old solve.
    report            = problem.old.report;
    report.iterations = report.linear_iterations = report.bound_iterations = 0;
    report.contraction                                                     = 0.;
    report.seconds = report.plain_seconds = 0.;
    is_unchanged                          = true;
  }



  template <int dim>
  bool
  data_are_unchanged(const Discretization<dim> &discretization,
                     const StepProblem<dim>    &problem)
  {
    const EvaluatedState<dim> &old = problem.old;
    if (!problem.parameters.reuse_unchanged || !old.is_solution ||
        old.report.relative_error > problem.tolerance)
      return false;
    const auto same = [](const DistributedVector &a,
                         const DistributedVector &b) {
      return std::equal(a.begin(),
                        a.begin() + a.locally_owned_size(),
                        b.begin());
    };
    bool unchanged = same(problem.load.values, old.forces.load.values);
    if (unchanged)
      {
        DistributedVector u(problem.old_u());
        discretization.space.set_prescribed(problem.time_step.t, u);
        unchanged = same(u, problem.old_u());
      }
    if (discretization.face)
      unchanged = unchanged &&
                  holds_at_rest(*discretization.face,
                                old.state.contact,
                                problem.bounds) &&
                  std::all_of(problem.foundation_step.begin(),
                              problem.foundation_step.end(),
                              [](const Tensor<1, 2> &step) {
                                return step == Tensor<1, 2>();
                              });
    return Utilities::MPI::min(unchanged ? 1 : 0,
                               discretization.space.communicator) == 1;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(StepSolution, stay);
  VISCOPLASTIC_INSTANTIATE(data_are_unchanged);
} // namespace Viscoplastic
