// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/messages.h>
#include <viscoplastic_contact/number_range.h>
#include <viscoplastic_contact/viscoplastic_contact.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  template <int dim>
  const FlowRate &
  ViscoplasticContact<dim>::accepted_rate()
  {
    const FlowLaws<dim> &laws = discretisation->laws;
    if (error_bar)
      return error_bar->rate(laws, state);
    if (!rate)
      rate = evaluate_flow(laws, state.u, state.z, state.t);
    return *rate;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::check_stability(const FlowRate &at,
                                            const TimeStep &time_step) const
  {
    if (time_step.k * at.relaxation_rate <= 2. * (1. + 1e-10))
      return;
    std::ostringstream message;
    message << "the time step " << time_step.k
            << " exceeds the stability limit 2/r = " << 2. / at.relaxation_rate
            << " of " << parameters.time.scheme
            << ", which is that of the cell at x = (";
    for (unsigned int d = 0; d < dim; ++d)
      message << (d > 0 ? ", " : "") << at.critical_position[d];
    message << "); take more steps in 'Time/Phases', or set 'Time/Stiffness "
               "policy' or 'Time/Scheme' = backward Euler.";
    throw StepBeyondStability(time_step.n, time_step.t, message.str());
  }



  template <int dim>
  typename ViscoplasticContact<dim>::Step
  ViscoplasticContact<dim>::advance(const State<dim>  &old_state,
                                    const Forces<dim> &old_forces,
                                    const TimeStep    &time_step)
  {
    const Discretisation &d = *discretisation;
    Step                  step;
    step.step_limit      = std::numeric_limits<double>::infinity();
    step.capped_volume   = 0.;
    step.state.n         = time_step.n;
    step.state.t         = time_step.t;
    step.state.k         = time_step.k;
    step.state.initial_u = old_state.initial_u;

    Load<dim> load;
    {
      TimerOutput::Scope phase(timer, "load");
      load = d.loads.assemble(time_step.t);
      if (d.face)
        {
          step.bounds = d.face->bounds(time_step.t);
          step.foundation_step =
            d.face->foundation_step(time_step.t_old, time_step.t);
        }
    }
    step.is_implicit = is_implicit();
    try
      {
        if (changes_scheme())
          {
            TimerOutput::Scope phase(timer, "rate");
            step.is_implicit =
              time_step.k * accepted_rate().relaxation_rate > 2. * (1. + 1e-10);
          }
        if (!step.is_implicit)
          try
            {
              if (changes_scheme())
                discretisation->use_solver_of_tangent(false);
              advance_explicitly(old_state, old_forces, load, time_step, step);
            }
          catch (const StepBeyondStability &)
            {
              // Heun's method sees the end of the step, too.
              if (!changes_scheme())
                throw;
              step.is_implicit = true;
              step.report      = ContactReport();
            }
        if (step.is_implicit)
          {
            if (changes_scheme())
              discretisation->use_solver_of_tangent(true);
            advance_implicitly(old_state, old_forces, load, time_step, step);
          }
      }
    catch (const std::bad_alloc &)
      {
        throw;
      }
    catch (const StepBeyondStability &)
      {
        throw; // which names the step
      }
    catch (const std::exception &exception)
      {
        throw StepFailure(time_step.n, time_step.t, reason(exception));
      }
    TimerOutput::Scope phase(timer, "balance");
    step.forces =
      evaluate_forces(d.sampling, d.matrix, std::move(load), step.state);
    return step;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::advance_explicitly(const State<dim>  &old_state,
                                               const Forces<dim> &old_forces,
                                               const Load<dim>   &load,
                                               const TimeStep    &time_step,
                                               Step              &step)
  {
    State<dim> &state     = step.state;
    state.z               = old_state.z;
    double     largest    = 0.;
    const auto solve_with = [&](const State<dim> &guess) {
      TimerOutput::Scope  phase(timer, "contact");
      const ContactReport last = step.report;
      step.report              = solve(
        guess, old_forces, load, step.bounds, step.foundation_step, state);
      step.report.iterations += last.iterations;
      step.report.linear_iterations += last.linear_iterations;
    };

    const auto note = [&](const FlowRate &at) {
      check_stability(at, time_step);
      if (at.relaxation_rate > largest)
        {
          largest                = at.relaxation_rate;
          step.step_limit        = 2. / largest;
          step.critical_position = at.critical_position;
        }
      step.capped_volume = std::max(step.capped_volume, at.capped_volume);
    };

    if (scene.has_viscosity())
      {
        TimerOutput::Scope phase(timer, "rate");
        const FlowRate    &start = accepted_rate();
        note(start);
        for (std::size_t i = 0; i < state.z.size(); ++i)
          state.z[i] += time_step.k * start.rate[i];
      }
    solve_with(old_state);
    if (scene.has_viscosity() && parameters.time.scheme == "Heun")
      {
        // z_{n-1} + k (G_{n-1} + G*)/2 with G* at the state just predicted.
        const State<dim> predicted = state;
        {
          TimerOutput::Scope phase(timer, "rate");
          const FlowRate     end = evaluate_flow(discretisation->laws,
                                             predicted.u,
                                             predicted.z,
                                             time_step.t,
                                             ExactSolution<dim>::Side::before);
          note(end);
          for (std::size_t i = 0; i < state.z.size(); ++i)
            state.z[i] = 0.5 * (old_state.z[i] + predicted.z[i] +
                                time_step.k * end.rate[i]);
        }
        solve_with(predicted);
      }
  }



  template <int dim>
  ContactReport
  ViscoplasticContact<dim>::solve(const State<dim>          &guess,
                                  const Forces<dim>         &old_forces,
                                  const Load<dim>           &load,
                                  const std::vector<double> &bounds,
                                  const Vector<double>      &foundation_step,
                                  State<dim>                &new_state)
  {
    Discretisation             &d     = *discretisation;
    const AdmissibleSpace<dim> &space = d.space;
    DistributedVector           right_side(load.values);
    if (scene.has_irreversible_stress()) // collective, also without cells
      add_irreversible_load(d.sampling, new_state.z, right_side);

    // An elastic body whose data have not changed does not move.
    if (!d.face && !scene.has_viscosity() && is_solved_on_mesh)
      {
        DistributedVector displacement_change(old_forces.u);
        space.set_prescribed(new_state.t, displacement_change);
        displacement_change -= old_forces.u;
        DistributedVector load_change(load.values);
        load_change -= old_forces.load.values;
        if (displacement_change.linfty_norm() == 0. &&
            load_change.linfty_norm() == 0.)
          {
            new_state.u        = guess.u;
            new_state.velocity = space.ghosted_vector();
            return {};
          }
      }

    DistributedVector u = start(guess, old_forces, foundation_step, new_state);
    const ContactReport report = solve_from(old_forces,
                                            load,
                                            right_side,
                                            bounds,
                                            foundation_step,
                                            step_tolerance(),
                                            u,
                                            new_state.friction);
    set_displacement(u, old_forces, new_state);
    return report;
  }



  template <int dim>
  DistributedVector
  ViscoplasticContact<dim>::start(const State<dim>     &guess,
                                  const Forces<dim>    &old_forces,
                                  const Vector<double> &foundation_step,
                                  State<dim>           &new_state) const
  {
    const Discretisation       &d     = *discretisation;
    const AdmissibleSpace<dim> &space = d.space;
    // Start from the last displacement, moved on by the last velocity, except
    // where points stick: they go with the foundation.
    const DistributedVector &old_u = old_forces.u;
    DistributedVector        u(old_u), velocity(old_u);
    space.to_frames(guess.velocity, velocity);
    // Not beyond the last increment: it may have been a jump in a tiny step.
    u.add(std::min(new_state.k, guess.k), velocity);
    if (d.face)
      {
        const FrictionFace &face = d.face->layout();
        new_state.friction       = guess.friction;
        if (new_state.friction.sticks.size() != face.points.size())
          new_state.friction = FrictionState(face.points.size());
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          if (new_state.friction.sticks[face.first_point[node]])
            for (unsigned int i = face.first_dof[node];
                 i < face.first_dof[node + 1];
                 ++i)
              if (space.owned.is_element(d.face->dofs()[i]))
                {
                  const auto local =
                    space.owned.index_within_set(d.face->dofs()[i]);
                  u.begin()[local] =
                    old_u.begin()[local] +
                    (foundation_step.size() > 0 ? foundation_step[i] : 0.);
                }
      }
    space.set_prescribed(new_state.t, u);
    return u;
  }



  template <int dim>
  ContactReport
  ViscoplasticContact<dim>::solve_from(const Forces<dim>         &old_forces,
                                       const Load<dim>           &load,
                                       const DistributedVector   &right_side,
                                       const std::vector<double> &bounds,
                                       const Vector<double> &foundation_step,
                                       const double          tolerance,
                                       DistributedVector    &u,
                                       FrictionState        &friction)
  {
    // All of it in proportion gives the solution in proportion: where squares
    // would leave the range of numbers, another unit does. In a ramp that
    // begins like exp(-1/t) that is nothing unusual; a whole run of this kind
    // is refused in check_sizes().
    const double size =
      size_of_data(old_forces.u, load.values, right_side, foundation_step, u);
    AssertThrow(!(size > largest_size),
                ExcMessage(out_of_range("the size of loads and displacements "
                                        "in the energy norm",
                                        size,
                                        least_size,
                                        largest_size)));
    if (size == 0. || size >= 1e-100)
      return solve_in_unit(old_forces.u,
                           load.values,
                           right_side,
                           bounds,
                           foundation_step,
                           tolerance,
                           u,
                           friction);

    const double unit    = std::ldexp(1., std::max(std::ilogb(size), -1000));
    const auto   in_unit = [unit](const auto &vector) {
      auto result = vector;
      result /= unit;
      return result;
    };
    const auto scale = [&](const double factor) {
      u *= factor;
      for (auto *values : {&friction.slip, &friction.multiplier})
        for (Tensor<1, 2> &value : *values)
          value *= factor;
    };
    std::vector<double> bounds_in_unit(bounds);
    for (double &bound : bounds_in_unit)
      bound /= unit;
    scale(1. / unit);
    ContactReport report =
      solve_in_unit(in_unit(old_forces.u),
                    in_unit(load.values),
                    in_unit(right_side),
                    bounds_in_unit,
                    foundation_step.size() > 0 ? in_unit(foundation_step) :
                                                 foundation_step,
                    tolerance,
                    u,
                    friction);
    scale(unit);
    report.duality_gap *= unit * unit;
    report.error *= unit;
    BulkSolver &solver = *discretisation->solver;
    solver.set_rounding_error(unit * solver.rounding_error());
    return report;
  }



  template <int dim>
  double
  ViscoplasticContact<dim>::size_of_data(const DistributedVector &old_u,
                                         const DistributedVector &load,
                                         const DistributedVector &right_side,
                                         const Vector<double> &foundation_step,
                                         const DistributedVector &u) const
  {
    const Discretisation       &d     = *discretisation;
    const AdmissibleSpace<dim> &space = d.space;
    double                      size  = 0.;
    const auto                  add   = [&size](const double value) {
      size = std::max(size, std::abs(value));
    };
    for (std::size_t i = 0; i < space.excluded().size(); ++i)
      {
        const double root = std::sqrt(d.diagonal.begin()[i]);
        add(root * u.begin()[i]);
        add(root * old_u.begin()[i]);
        if (!space.excluded()[i])
          {
            add(load.begin()[i] / root);
            add(right_side.begin()[i] / root);
          }
      }
    for (unsigned int k = 0; k < foundation_step.size(); ++k)
      if (space.owned.is_element(d.face->dofs()[k]))
        add(std::sqrt(d.diagonal.begin()[space.owned.index_within_set(
              d.face->dofs()[k])]) *
            foundation_step[k]);
    return Utilities::MPI::max(size, communicator);
  }



  template <int dim>
  ContactReport
  ViscoplasticContact<dim>::solve_in_unit(const DistributedVector   &old_u,
                                          const DistributedVector   &load,
                                          const DistributedVector   &right_side,
                                          const std::vector<double> &bounds,
                                          const Vector<double> &foundation_step,
                                          const double          tolerance,
                                          DistributedVector    &u,
                                          FrictionState        &friction)
  {
    Discretisation             &d     = *discretisation;
    const AdmissibleSpace<dim> &space = d.space;

    // What rounding leaves of displacements, of their increments, in which the
    // face is solved, and of loads that cancel.
    double rounding = 0.;
    for (std::size_t i = 0; i < space.excluded().size(); ++i)
      if (!space.excluded()[i])
        {
          const double stiffness = d.diagonal.begin()[i];
          const auto   square    = [](const double x) { return x * x; };
          rounding +=
            stiffness * (square(u.begin()[i]) + square(old_u.begin()[i])) +
            (square(load.begin()[i]) + square(right_side.begin()[i])) /
              stiffness;
        }
    rounding = Utilities::MPI::sum(rounding, communicator);
    d.solver->set_rounding_error(100. * std::numeric_limits<double>::epsilon() *
                                 std::sqrt(rounding));

    if (d.slipping_face())
      {
        DistributedVector change(u);
        change -= old_u;
        Vector<double> increment = d.face->face_vector(change);
        if (foundation_step.size() > 0)
          increment -= foundation_step;
        d.solver->begin(right_side, u);
        return contact_solver.solve(
          *d.solver, d.face->layout(), bounds, tolerance, increment, friction);
      }
    ContactReport report;
    report.linear_iterations = d.solver->solve(right_side, u, tolerance);
    report.tolerance         = tolerance;
    report.error             = d.solver->rounding_error();
    if (!d.solver->is_exact())
      report.error =
        std::max(report.error, tolerance * d.solver->energy_norm());
    return report;
  }



  template <int dim>
  double
  ViscoplasticContact<dim>::step_tolerance() const
  {
    return error_bar ? error_bar->tolerance() :
                       parameters.solver.strict_tolerance();
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::set_displacement(const DistributedVector &u,
                                             const Forces<dim> &old_forces,
                                             State<dim>        &new_state)
  {
    const AdmissibleSpace<dim> &space = discretisation->space;
    new_state.u                       = space.ghosted_vector();
    new_state.velocity                = space.ghosted_vector();
    space.to_cartesian(u, new_state.u);
    if (new_state.k > 0.)
      {
        DistributedVector velocity(u);
        velocity -= old_forces.u;
        velocity /= new_state.k;
        space.to_cartesian(velocity, new_state.velocity);
      }
    is_solved_on_mesh = true;
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
