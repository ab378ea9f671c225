// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/compatibility.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/results/run_summary.h>

#include <iomanip>

namespace Viscoplastic
{
  template <int dim>
  Recorder<dim>::Recorder(const Scene<dim>  &scene,
                          const StepControl &control,
                          Console           &console,
                          TimerOutput       &timer,
                          const ErrorBudget *budget)
    : scene(scene)
    , control(control)
    , console(console)
    , timer(timer)
    , budget(budget)
    , has_error_estimate(scene.parameters.error_control.error_estimator)
    , progress(console)
  {
    if (has_error_estimate)
      run.errors.emplace();
    if (scene.quantity)
      run.quantity = scene.quantity->name;
    if (budget != nullptr)
      run.tolerance = budget->tolerance;
  }



  template <int dim>
  void
  Recorder<dim>::set_mesh(const Discretization<dim> &on_mesh)
  {
    if (discretization != nullptr)
      effects.note_change_of_mesh();
    else if (budget != nullptr)
      if (const auto jump = first_jump(on_mesh.space))
        run.jump_position = jump->position;
    discretization = &on_mesh;
    probes.clear();
    for (const Point<dim> &x : scene.output_points)
      probes.emplace_back(on_mesh.space, x);
    std::set<RecordedField> fields = scene.parameters.output.point_fields;
    fields.erase(RecordedField::displacement); // always recorded
    if (!fields.empty() && !scene.output_points.empty())
      point_fields = std::make_unique<FieldProbes<dim>>(on_mesh,
                                                        scene.output_points,
                                                        fields);
    if (!scene.output_integrals.empty())
      integrals = std::make_unique<FieldIntegrals<dim>>(on_mesh);
  }



  template <int dim>
  void
  Recorder<dim>::record(const EvaluatedState<dim> &old,
                        const AcceptedStep<dim>   &step,
                        const SolutionErrors      &errors)
  {
    const bool          is_initial = step.time_step.n == 0;
    StepQuantities<dim> quantities;
    {
      // All ranks compute the quantities; rank 0 writes them.
      TimerOutput::Scope phase(timer, "balance");
      quantities = measure_step(*discretization, old, step);
      DistributedVector        difference;
      const DistributedVector &u =
        reported_displacement(scene, step.end.state, difference);
      for (const PointProbe<dim> &probe : probes)
        quantities.point_displacements.push_back(probe.value(u));
      if (point_fields)
        quantities.point_fields = point_fields->values(step.end.state);
      if (integrals)
        {
          quantities.integrals = integrals->values(old.state, step.end.state);
          dissipated.resize(quantities.integrals.size(), 0.);
          for (std::size_t i = 0; i < dissipated.size(); ++i)
            if (integrals->columns()[i].is_of_step)
              quantities.integrals[i] = dissipated[i] +=
                quantities.integrals[i];
        }
    }
    if (is_initial)
      balance.begin(quantities.stored_energy);
    else
      balance.add_step({quantities.stored_energy,
                        quantities.external_work,
                        quantities.flow.viscous_dissipation,
                        quantities.friction.dissipation,
                        quantities.flow.thermal_work});
    largest_force = std::max(largest_force, quantities.largest_force);
    contact_iterations += step.report.iterations;
    linear_iterations += step.report.linear_iterations;
    solve_seconds += step.report.seconds;
    plain_solve_seconds += step.report.plain_seconds;
    newton_iterations += step.newton_iterations;
    implicit_steps += step.is_implicit;
    run.unchanged_steps += step.is_unchanged;

    effects.note(*discretization, step);
    judge(step, quantities);
    sum_up(step, quantities, errors);
    check_sizes(/* at_end = */ false);
    const TableRow recorded = row(step, quantities, errors);
    run.at_end.clear();
    for (const TableRow::Entry &entry : recorded.entries)
      if (entry.is_printed)
        run.at_end.push_back(entry);
    if (statistics)
      {
        recorded.require_finite();
        statistics->write(recorded);
        statistics->flush();
      }
    report_progress(step, quantities);
    stopped_clock.reset();
  }



  template <int dim>
  void
  Recorder<dim>::record_initial_state(TimeStepper<dim>     &time_stepper,
                                      const SolutionErrors &errors,
                                      EvaluatedState<dim>  &accepted)
  {
    AcceptedStep<dim> initial;
    initial.time_step = {0, 0., 0., 0.};
    initial.report    = accepted.report;
    // Only the record has the estimate of the quantity in the initial state.
    // The state is moved, since a copy has all fields.
    const ErrorEstimate estimate       = accepted.errors;
    const SpaceEstimate space_estimate = accepted.space_estimate;
    initial.end                        = std::move(accepted);
    time_stepper.estimate_quantity(initial.end);
    record(initial.end, initial, errors);
    accepted                = std::move(initial.end);
    accepted.errors         = estimate;
    accepted.space_estimate = space_estimate;
  }



  template <int dim>
  void
  Recorder<dim>::sum_up(const AcceptedStep<dim>   &step,
                        const StepQuantities<dim> &quantities,
                        const SolutionErrors      &errors)
  {
    const double              t        = step.time_step.t;
    const StressSummary<dim> &stress   = quantities.stress;
    const FrictionIdentities &friction = quantities.friction;
    run.n_steps                        = step.time_step.n;
    run.n_cells = discretization->space.dof_handler.get_triangulation()
                    .n_global_active_cells();
    run.t = t;
    if (discretization->tension)
      run.tension_share.update(quantities.tension_area /
                                 discretization->tension->area(),
                               t);
    run.slide.update(quantities.slide, t);
    run.missed_bounds += step.end.state.k * quantities.friction_bounds.missed;
    run.computed_bounds += step.end.state.k * quantities.friction_bounds.sum;
    run.displacement.update(quantities.max_displacement,
                            t,
                            quantities.displacement_position);
    run.strain.update(stress.mean_strain, t);
    run.von_mises.update(stress.max_von_mises, t, stress.von_mises_position);
    run.pressure.update(quantities.contact.max_pressure, t);
    run.first_touch.update(quantities.contact.contact_area > 0.,
                           step.time_step);
    run.first_slip.update(friction.slip_area > 0., step.time_step);
    run.capped_volume.update(step.capped_volume, step.time_of_rate());
    run.largest_error.update(errors.error);
    run.largest_exact.update(errors.exact);
    run.has_flowed = balance.viscous_dissipation != 0.;
    if (scene.has_friction())
      {
        // The area of all friction points depends on the mesh.
        if (friction.slip_area > run.slip_area.value ||
            run.slip_area.value == 0.)
          run.friction_area = friction.slip_area + friction.stick_area;
        run.slip_area.update(friction.slip_area, t);
        if (step.time_step.k > 0.)
          run.slip_rate.update(friction.max_slip / step.time_step.k, t);
        run.utilization.update(friction.max_utilization, t);
      }
    if (scene.is_adaptive() && !has_error_estimate)
      run.error_estimate = quantities.refinement_estimate;
    // Initial data have no estimate unless they solve for equilibrium.
    if (run.errors && (step.time_step.n > 0 || step.end.is_solution))
      {
        const ErrorEstimate &estimate = step.end.errors;
        run.errors->update(estimate, estimate.energy_norm, t);
        if (const auto &geometry = step.end.space_estimate.geometry;
            geometry.size() > 0) // on all ranks
          run.has_coarse_curves |=
            total_estimate(
              geometry, discretization->space.dof_handler.get_triangulation()) >
            estimate.energy_norm;
        if (scene.quantity)
          {
            run.quantity_errors.update(estimate.quantity,
                                       std::abs(estimate.quantity.value),
                                       t);
            if (budget == nullptr)
              {
                run.dual_times.push_back(t);
                run.dual_norms.push_back(estimate.quantity.dual_norm);
              }
          }
      }
    Point<dim> critical_position;
    for (unsigned int d = 0; d < dim; ++d)
      critical_position[d] = step.critical_position[d];
    run.stiffness.update(step.stiffness(), t, critical_position);
    if (control.may_reject())
      run.steps = control.counts();
    if (scene.is_implicit_beyond_the_limit())
      run.implicit_steps = implicit_steps;
  }



  template <int dim>
  std::optional<double>
  Recorder<dim>::relative_error(const ErrorEstimate &errors) const
  {
    if (!has_error_estimate)
      return {};
    const double size =
      budget ? budget->size(run.controlled_errors().size) : errors.energy_norm;
    if (size <= 0.)
      return {};
    return (budget ? budget->errors(errors) : errors).total() / size;
  }



  template <int dim>
  double
  Recorder<dim>::done(const unsigned int n, const double t) const
  {
    return control.may_reject() ?
             t / scene.schedule.end_time() :
             static_cast<double>(n) / scene.schedule.n_steps();
  }



  template <int dim>
  void
  Recorder<dim>::report_progress(const AcceptedStep<dim>   &step,
                                 const StepQuantities<dim> &quantities)
  {
    const auto &[n, t_old, t, k] = step.time_step;
    if (n == 0)
      return;
    const std::string time_unit = scene.unit(Quantity::time);
    const auto n_cells = discretization->space.dof_handler.get_triangulation()
                           .n_global_active_cells();
    std::ostringstream words;
    words << "Step " << n;
    if (!control.may_reject())
      words << '/' << scene.schedule.n_steps();
    words << "  t = " << number(t, 5) << time_unit << "  k = " << number(k, 3)
          << time_unit << "  cells " << n_cells;
    if (discretization->face)
      {
        const FrictionIdentities &friction = quantities.friction;
        const double area = friction.slip_area + friction.stick_area;
        words << "  contact iterations " << step.report.iterations;
        if (area > 0.)
          words << "  slipping "
                << std::lround(100. * friction.slip_area / area) << " %";
        if (area > 0. && friction.max_slip > 0.)
          words << " at " << number(friction.max_slip / k, 2)
                << scene.unit(Quantity::velocity);
      }
    if (scene.is_adaptive() && !has_error_estimate)
      words << "  error estimate " << number(quantities.refinement_estimate, 3);
    if (const auto relative = relative_error(step.end.errors))
      words << "  error estimate " << number(100. * *relative, 2) << " %";
    progress.report(words.str(), n_cells, done(n, t), elapsed());
  }



  template <int dim>
  void
  Recorder<dim>::resume(const State<dim> &state, const double seconds_before)
  {
    earlier_seconds = seconds_before;
    progress.resume(done(state.n, state.t), elapsed());
  }



  template <int dim>
  void
  Recorder<dim>::check_sizes(const bool at_end) const
  {
    for (const auto &[what, size] :
         {std::make_pair("displacement", run.displacement.value),
          std::make_pair("von Mises stress", run.von_mises.value),
          std::make_pair("force", largest_force)})
      if (size > largest_size || (at_end && size > 0. && size < least_size))
        require_in_range("The largest " + std::string(what) + " of the run",
                         size,
                         least_size,
                         largest_size);
  }



  template <int dim>
  void
  Recorder<dim>::print(std::ostream &out) const
  {
    out << '\n';
    run.print(out, scene);
    const double n = run.n_steps;
    out << std::setprecision(3) << "Iterations per step: ";
    if (newton_iterations > 0)
      out << newton_iterations / n << " of Newton's method, ";
    if (discretization->face)
      out << contact_iterations / n << " of the active set, ";
    out << linear_iterations / n << " linear\n";
    bill().print(out);
  }



  template <int dim>
  RunBill
  Recorder<dim>::bill() const
  {
    RunBill bill;
    bill.seconds = timer.get_summary_data(TimerOutput::total_wall_time);
    if (pilot_seconds > 0.)
      bill.seconds["pilot run"] += pilot_seconds;
    bill.total         = elapsed();
    bill.earlier       = earlier_seconds;
    bill.has_viscosity = scene.has_viscosity();
    bill.solves        = solve_seconds;
    if (scene.has_friction())
      bill.plain_solves = plain_solve_seconds;
    return bill;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(Recorder);
} // namespace Viscoplastic
