// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/time_stepping/step_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Viscoplastic
{
  void
  StepOutcome::note(const FlowRate &rate)
  {
    if (rate.relaxation_rate > 0. && 2. / rate.relaxation_rate < step_limit)
      {
        step_limit        = 2. / rate.relaxation_rate;
        critical_position = rate.critical_position;
      }
    capped_volume = std::max(capped_volume, rate.capped_volume);
  }



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
      diagonal.begin()[i] =
        matrix.diag_element(space.owned.nth_index_in_set(i));
    const FaceRestriction &face   = d.face_restriction();
    SolverDemand           demand = d.solver_demand();
    demand.max_poissons_ratio     = max_poissons_ratio;
    if (bulk_solver &&
        bulk_solver->is_exact() ==
          (choose_bulk_solver(demand) == BulkSolverKind::direct) &&
        bulk_solver->renew(matrix))
      return;
    bulk_solver.reset(); // factors are what fills memory
    bulk_solver =
      make_bulk_solver(make_bulk_system(space, matrix, face), demand);
  }



  template <int dim>
  DistributedVector
  StepSolver<dim>::initial_guess(const StepProblem<dim> &problem,
                                 const State<dim>       &guess,
                                 FrictionState          &friction) const
  {
    const Discretization<dim>  &d     = discretization;
    const AdmissibleSpace<dim> &space = d.space;
    // Start from the last displacement, moved on by the last velocity, except
    // where points stick: they go with the foundation.
    const DistributedVector &old_u = problem.old_u();
    DistributedVector        u(old_u), velocity(old_u);
    space.to_frames(guess.velocity, velocity);
    // Not beyond the last increment: it may have been a jump in a tiny step.
    u.add(std::min(problem.time_step.k, guess.k), velocity);
    if (d.face)
      {
        const FrictionFace   &face            = d.face->layout();
        const Vector<double> &foundation_step = problem.foundation_step;
        if (guess.friction.n_points() == problem.bounds.size())
          {
            friction       = guess.friction;
            friction.bound = problem.bounds;
          }
        else
          friction = FrictionState(problem.bounds);
        std::vector<bool> sticks(face.n_dofs());
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          std::fill(sticks.begin() + face.first_dof[node],
                    sticks.begin() + face.first_dof[node + 1],
                    friction.sticks[face.first_point[node]]);
        for (unsigned int k = 0; k < face.n_dofs(); ++k)
          if (sticks[k])
            {
              const unsigned int i = d.face->restriction().positions()[k];
              u.begin()[i] =
                old_u.begin()[i] +
                (foundation_step.size() > 0 ? foundation_step[k] : 0.);
            }
      }
    space.set_prescribed(problem.time_step.t, u);
    return u;
  }



  template <int dim>
  double
  StepSolver<dim>::rounding_error(const Data              &data,
                                  const DistributedVector &u) const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    double                      sum   = 0.;
    for (std::size_t i = 0; i < space.excluded().size(); ++i)
      if (!space.excluded()[i])
        {
          const double stiffness = diagonal.begin()[i];
          const auto   square    = [](const double x) { return x * x; };
          sum +=
            stiffness * (square(u.begin()[i]) + square(data.old_u.begin()[i])) +
            (square(data.load.begin()[i]) +
             square(data.right_side.begin()[i])) /
              stiffness;
        }
    return 100. * std::numeric_limits<double>::epsilon() *
           std::sqrt(Utilities::MPI::sum(sum, space.communicator));
  }



  template <int dim>
  double
  StepSolver<dim>::size_of(const Data &data, const DistributedVector &u) const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    double                      size  = 0.;
    const auto                  add   = [&size](const double value) {
      size = std::max(size, std::abs(value));
    };
    for (std::size_t i = 0; i < space.excluded().size(); ++i)
      {
        const double root = std::sqrt(diagonal.begin()[i]);
        add(root * u.begin()[i]);
        add(root * data.old_u.begin()[i]);
        if (!space.excluded()[i])
          {
            add(data.load.begin()[i] / root);
            add(data.right_side.begin()[i] / root);
          }
      }
    for (unsigned int k = 0; k < data.foundation_step.size(); ++k)
      {
        const unsigned int i = discretization.face_restriction().positions()[k];
        add(std::sqrt(diagonal.begin()[i]) * data.foundation_step[k]);
      }
    return Utilities::MPI::max(size, space.communicator);
  }



  template <int dim>
  ContactReport
  StepSolver<dim>::solve(const StepProblem<dim>  &problem,
                         const DistributedVector &right_side,
                         const double             tolerance,
                         DistributedVector       &u,
                         FrictionState           &friction)
  {
    // All of it in proportion gives the solution in proportion: where squares
    // would leave the range of numbers, another unit does. In a ramp that
    // begins like exp(-1/t) that is nothing unusual; a whole run of this kind
    // is refused (see Recorder::check_sizes()).
    const Data   data{problem.old_u(),
                    problem.load.values,
                    right_side,
                    problem.foundation_step};
    const double size = size_of(data, u);
    AssertThrow(!(size > largest_size),
                ExcMessage(out_of_range("the size of loads and displacements "
                                        "in the energy norm",
                                        size,
                                        least_size,
                                        largest_size)));
    if (size == 0. || size >= 1e-100)
      return solve_in_unit(data, tolerance, u, friction);

    const double unit    = std::ldexp(1., std::max(std::ilogb(size), -1000));
    const auto   in_unit = [unit](const auto &vector) {
      auto result = vector;
      result /= unit;
      return result;
    };
    const auto scale = [&](const double factor) {
      u *= factor;
      for (unsigned int p = 0; p < friction.n_points(); ++p)
        {
          friction.bound[p] *= factor;
          friction.slip[p] *= factor;
          friction.multiplier[p] *= factor;
        }
    };
    const DistributedVector old_u            = in_unit(data.old_u),
                            load             = in_unit(data.load),
                            other_right_side = in_unit(right_side);
    Vector<double> foundation_step(data.foundation_step);
    if (foundation_step.size() > 0)
      foundation_step /= unit;
    scale(1. / unit);
    ContactReport report = solve_in_unit(
      {old_u, load, other_right_side, foundation_step}, tolerance, u, friction);
    scale(unit);
    friction.bound = problem.bounds;
    report.duality_gap *= unit * unit;
    report.error *= unit;
    bulk_solver->set_rounding_error(unit * bulk_solver->rounding_error());
    return report;
  }



  template <int dim>
  ContactReport
  StepSolver<dim>::solve_in_unit(const Data        &data,
                                 const double       tolerance,
                                 DistributedVector &u,
                                 FrictionState     &friction)
  {
    const Discretization<dim> &d = discretization;
    const Timer                timer;
    bulk_solver->set_rounding_error(rounding_error(data, u));
    ContactReport report;
    if (d.slipping_face())
      {
        DistributedVector change(u);
        change -= data.old_u;
        Vector<double> increment = d.face->restriction().gather(change);
        if (data.foundation_step.size() > 0)
          increment -= data.foundation_step;
        // (3.20): the minimum of J is its solution.
        bulk_solver->begin(data.right_side, u);
        const double seconds_to_begin = timer.wall_time();
        report                        = contact_solver.solve(
          *bulk_solver, d.face->layout(), tolerance, increment, friction);
        report.seconds = timer.wall_time();
        report.plain_seconds =
          std::min(report.seconds, seconds_to_begin + report.plain_seconds);
        return report;
      }
    report.linear_iterations =
      bulk_solver->solve(data.right_side, u, tolerance);
    report.tolerance = tolerance;
    report.error     = bulk_solver->rounding_error();
    if (!bulk_solver->is_exact())
      {
        report.relative_error = tolerance;
        report.error =
          std::max(report.error, tolerance * bulk_solver->energy_norm());
      }
    report.seconds = report.plain_seconds = timer.wall_time();
    return report;
  }



  template <int dim>
  void
  StepSolver<dim>::solve_with_held_friction(const DistributedVector &right_side,
                                            const double             tolerance,
                                            FrictionState            friction,
                                            DistributedVector       &u)
  {
    const Discretization<dim> &d = discretization;
    const DistributedVector    start(u);
    const Vector<double>       no_step;
    const Data                 data{start, right_side, right_side, no_step};
    // Squares of others would leave the range of numbers; the next step solves
    // for all of u.
    if (const double size = size_of(data, u);
        !(size >= 1e-100 && size <= largest_size))
      return;
    bulk_solver->set_rounding_error(rounding_error(data, u));
    if (!d.slipping_face())
      {
        bulk_solver->solve(right_side, u, tolerance);
        return;
      }
    const FrictionFace  &face = d.face->layout();
    const Vector<double> no_force(face.n_dofs());
    Vector<double>       change(face.n_dofs());
    for (unsigned int p = 0; p < friction.n_points(); ++p)
      // Nothing holds a point without friction.
      friction.sticks[p] = friction.bound[p] > 0.;
    bulk_solver->begin(right_side, u);
    bulk_solver->set_truncation(make_truncation(face, friction, {}));
    // As a rule the change is less than a hundredth of u.
    bulk_solver->correct(no_force,
                         std::clamp(100. * tolerance, 1e-10, 1e-4),
                         change);
    bulk_solver->search_terms(change);
    bulk_solver->take_step(1.);
    bulk_solver->finish();
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



  template class StepSolver<2>;
  template class StepSolver<3>;
} // namespace Viscoplastic
