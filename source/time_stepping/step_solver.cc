// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/time_stepping/step_solver.h>


namespace Viscoplastic
{
  namespace
  {
    /// Solutions with a larger error by rounding, relative to their size, are
    /// refused.
    constexpr double largest_rounding = 1e-3;
    /// The rounding, relative to their size, of displacements, of their
    /// increments, in which the face is solved, and of loads that cancel.
    constexpr double rounding = 100. * std::numeric_limits<double>::epsilon();
    /// The squares of smaller numbers underflow.
    constexpr double least_step = 1e-150;
  } // namespace



  template <int dim>
  StepSolver<dim>::StepSolver(const Discretization<dim> &discretization)
    : discretization(discretization)
    , contact_solver(
        discretization.scene().parameters.solver.maximal_iterations)
  {}



  template <int dim>
  void
  StepSolver<dim>::set_matrix(const DistributedMatrix &matrix,
                              const double             max_poissons_ratio)
  {
    const Discretization<dim>  &d     = discretization;
    const AdmissibleSpace<dim> &space = d.space;
    diagonal                          = space.owned_vector();
    for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
      diagonal.begin()[i] = matrix.diagonal(i);
    const FaceRestriction &face   = d.face_restriction();
    SolverDemand           demand = d.solver_demand();
    demand.max_poissons_ratio     = max_poissons_ratio;
    if (space.is_held_by_contact() && !springs)
      springs = std::make_unique<ProximalSprings<dim>>(d);
    const DistributedMatrix &solved =
      springs ? springs->attach(matrix) : matrix;
    if (bulk_solver &&
        bulk_solver->is_exact() ==
          (choose_bulk_solver(demand) == BulkSolverKind::direct) &&
        bulk_solver->renew(solved))
      return;
    bulk_solver.reset(); // factors are what fills memory
    bulk_solver =
      make_bulk_solver(make_bulk_system(space, solved, face), demand);
  }



  template <int dim>
  DistributedVector
  StepSolver<dim>::initial_guess(const StepProblem<dim> &problem,
                                 const State<dim>       &guess,
                                 ContactState           &contact) const
  {
    const Discretization<dim>  &d     = discretization;
    const AdmissibleSpace<dim> &space = d.space;
    // Start from the last displacement, extrapolated by the velocity, except
    // where points stick: these move with the foundation.
    const DistributedVector &old_u = problem.old_u();
    DistributedVector        u(old_u), velocity(old_u);
    space.to_frames(guess.velocity, velocity);
    u.add(problem.time_ahead(guess), velocity);
    if (d.face)
      {
        const ContactLayout &face = d.face->layout();
        if (guess.contact.n_points() == problem.bounds.size())
          {
            contact       = guess.contact;
            contact.bound = problem.bounds;
          }
        else
          contact = ContactState(problem.bounds);
        if (problem.foundation_step.size() > 0)
          contact.foundation_step = problem.foundation_step;
        const auto &positions = d.face->restriction().positions();
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          {
            const unsigned int begin = face.first_dof[node],
                               p     = face.first_point[node];
            const auto obstacles     = face.obstacles(node);
            // The increment of the node.
            Tensor<1, 3> x;
            for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
              {
                const unsigned int dof = positions[begin + i];
                x[i]                   = u.begin()[dof] - old_u.begin()[dof];
              }
            const bool sticks = !face.friction_points(node).empty() &&
                                contact.holds(face.points[p], p);
            if (sticks && obstacles.empty())
              x = motion_with_slip(face.points[p], contact.foundation_step[p]);
            else if (sticks && face.has_plain_friction(node))
              x -= motion_with_slip(face.points[p],
                                    contact.slip_with(face.points[p], p, x));
            for (const unsigned int o : face.rigid(obstacles))
              {
                const Tensor<1, 3> &normal = face.points[o].map[0];
                contact.sticks[o]          = contact.holds(face.points[o], o);
                const double left          = contact.gap(o) - normal * x;
                if (contact.sticks[o] || left < 0.)
                  x += left / normal.norm_square() * normal;
              }
            if (sticks || !obstacles.empty())
              for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
                {
                  const unsigned int dof = positions[begin + i];
                  u.begin()[dof]         = old_u.begin()[dof] + x[i];
                }
          }
      }
    space.set_prescribed(problem.time_step.t, u);
    return u;
  }



  template <int dim>
  double
  StepSolver<dim>::size_of(const Data &data, const DistributedVector &u) const
  {
    const AdmissibleSpace<dim> &space  = discretization.space;
    double                      sum    = 0.;
    const auto                  square = [](const double x) { return x * x; };
    for (unsigned int k = 0; k < data.foundation_step.size(); ++k)
      sum +=
        diagonal.begin()[discretization.face_restriction().positions()[k]] *
        square(data.foundation_step[k]);
    // Prescribed values may be all that moves a body that is carried along.
    for (std::size_t i = 0; i < space.excluded().size(); ++i)
      {
        const double stiffness = diagonal.begin()[i];
        sum +=
          stiffness * (square(u.begin()[i]) + square(data.old_u.begin()[i]));
        if (!space.excluded()[i])
          sum += (square(data.load.begin()[i]) +
                  square(data.right_side.begin()[i])) /
                 stiffness;
      }
    return std::sqrt(Utilities::MPI::sum(sum, space.communicator));
  }



  template <int dim>
  double
  StepSolver<dim>::load_size(const Data &data) const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    double                      sum   = 0.;
    for (std::size_t i = 0; i < space.excluded().size(); ++i)
      if (!space.excluded()[i])
        sum += Utilities::fixed_power<2>(data.right_side.begin()[i]) /
               diagonal.begin()[i];
    return std::sqrt(Utilities::MPI::sum(sum, space.communicator));
  }



  template <int dim>
  void
  StepSolver<dim>::add_rounding(const Data        &data,
                                DistributedVector &u,
                                const double       size,
                                ContactReport     &report)
  {
    // The ratio of the size in the norm of the diagonal to the energy norm is
    // about the root of the condition number, and rounding of residuals may be
    // magnified by up to its square.
    constexpr double epsilon   = std::numeric_limits<double>::epsilon();
    const double     data_size = size_of(data, u), ratio = data_size / size;
    // Skip bodies that move without strain under no loads, whose energy is
    // nothing but rounding.
    if (!(epsilon * ratio * ratio > report.tolerance) ||
        size <= report.rounding_error ||
        (epsilon * ratio * ratio > 1. &&
         load_size(data) <= rounding * data_size))
      return;
    const double left =
      bulk_solver->begin(data.right_side, u)->rounding_of_residual();
    if (!(left <= largest_rounding * size))
      refuse(
        "Rounding alone makes " + as_text(left / size) +
        " or more of the solution. Cells that are less flat, stiffness that "
        "differs less or Poisson's ratio farther from 1/2 mend that.");
    if (!(left > std::max(report.error, report.tolerance * size)))
      return;
    report.error          = left;
    report.relative_error = left / size;
    report.rounding_error = std::max(report.rounding_error, left);
  }



  template <int dim>
  ContactReport
  StepSolver<dim>::solve_with_bounds(const StepProblem<dim>  &problem,
                                     const DistributedVector &right_side,
                                     const double             tolerance,
                                     DistributedVector       &u,
                                     ContactState            &contact,
                                     const CoulombLaw        *law)
  {
    if (!springs)
      return solve_regular(
        problem, problem.old_u(), right_side, tolerance, u, contact, law);
    return springs->solve(
      problem,
      right_side,
      tolerance,
      [&](const DistributedVector &old_u,
          const DistributedVector &right,
          const double             inner_tolerance) {
        return solve_regular(
          problem, old_u, right, inner_tolerance, u, contact, law);
      },
      u,
      contact);
  }



  template <int dim>
  ContactReport
  StepSolver<dim>::solve_regular(const StepProblem<dim>  &problem,
                                 const DistributedVector &old_u,
                                 const DistributedVector &right_side,
                                 const double             tolerance,
                                 DistributedVector       &u,
                                 ContactState            &contact,
                                 const CoulombLaw        *law)
  {
    Vector<double> foundation_step;
    if (problem.foundation_step.size() > 0)
      foundation_step =
        face_motion(discretization.face->layout(), problem.foundation_step);
    const Data data{old_u, problem.load.values, right_side, foundation_step};
    const Discretization<dim> &d = discretization;
    const Timer                timer;
    const double               data_size = size_of(data, u);
    const SolutionScale scale{rounding * data_size, problem.former_size()};
    ContactReport       report;
    try
      {
        if (d.slipping_face())
          {
            DistributedVector change(u);
            change -= data.old_u;
            Vector<double> increment = d.face->restriction().gather(change);
            // The minimum of J solves (3.20).
            const auto   solve = bulk_solver->begin(data.right_side, u, scale);
            const double seconds_to_begin = timer.wall_time();
            report                        = contact_solver.solve(
              *solve, d.face->layout(), tolerance, increment, contact, law);
            report.plain_seconds =
              std::min(timer.wall_time(),
                       seconds_to_begin + report.plain_seconds);
            report.rounding_error = solve->scale.rounding_error;
            add_rounding(data, u, solve->size(), report);
          }
        else
          {
            const BulkSolver::Report linear =
              bulk_solver->solve(data.right_side, u, tolerance, scale);
            report.linear_iterations = linear.iterations;
            report.error             = linear.error;
            report.rounding_error    = scale.rounding_error;
            if (!bulk_solver->is_exact())
              report.relative_error = tolerance;
            report.plain_seconds = timer.wall_time();
          }
      }
    catch (const ExceptionBase &)
      {
        // The data of a ramp that begins like exp(-1/t) may be this small; then
        // a failed solve does no harm. A whole run of this kind is refused
        // (Recorder::check_sizes()).
        if (!(data_size < least_step))
          throw;
      }
    report.tolerance = tolerance;
    report.seconds   = timer.wall_time();
    return report;
  }



  template <int dim>
  void
  StepSolver<dim>::solve_with_held_friction(const DistributedVector &right_side,
                                            const double             tolerance,
                                            ContactState             contact,
                                            DistributedVector       &u)
  {
    const Discretization<dim> &d = discretization;
    const DistributedVector    start(u);
    const Vector<double>       no_step;
    const Data                 data{start, right_side, right_side, no_step};
    const SolutionScale        scale{rounding * size_of(data, u)};
    if (!d.slipping_face())
      {
        bulk_solver->solve(right_side, u, tolerance, scale);
        return;
      }
    const ContactLayout &face = d.face->layout();
    Vector<double>       force(face.n_dofs());
    // A point without friction is not held.
    for (const unsigned int p : face.friction_points())
      contact.sticks[p] = contact.bound[p] > 0.;
    for (const unsigned int o : face.compliant(face.obstacles()))
      face.add_node_values(node_force(face.points[o], contact.multiplier[o]),
                           face.points[o].node,
                           force);
    DistributedVector right(right_side);
    if (springs)
      // The springs carry nothing at the present place of the body.
      springs->add_load(u, right);
    // As a rule the change is less than a hundredth of u, but in a nearly
    // incompressible body a new mesh may bring much more energy than there is,
    // and takes several corrections. Errors in the energy norm may be `margin`
    // times those of the residual. The next step solves for its equilibrium
    // afresh.
    constexpr double margin    = 10.;
    const double     reduction = std::clamp(100. * tolerance, 1e-10, 1e-4);
    solve_truncated(*bulk_solver->begin(right, u, scale),
                    face,
                    make_truncation(face, contact, {}),
                    /* is_kept = */ true,
                    force,
                    reduction,
                    tolerance / (margin * reduction));
  }



  template <int dim>
  void
  StepSolver<dim>::set_displacement(const StepProblem<dim>  &problem,
                                    const DistributedVector &u,
                                    State<dim>              &state) const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    state.u                           = space.ghosted_vector();
    state.velocity                    = space.ghosted_vector();
    space.to_cartesian(u, state.u);
    if (state.k > 0.)
      {
        DistributedVector velocity(u);
        velocity -= problem.old_u();
        velocity /= state.k;
        space.to_cartesian(velocity, state.velocity);
      }
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(StepSolver);
} // namespace Viscoplastic
