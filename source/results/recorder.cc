// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/discretization/energy.h>
#include <viscoplastic_contact/error/memory_bound.h>
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/results/run_phases.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    void
    add_errors(const SolutionErrors &errors, Statistics &row)
    {
      const auto add = [&row](const std::string   &prefix,
                              const SolutionNorms &norms) {
        row.add(prefix + "energy", norms.energy);
        row.add(prefix + "h1", norms.h1);
        row.add(prefix + "stress", norms.stress);
        row.add(prefix + "multiplier", norms.multiplier);
      };
      add("error_", errors.error);
      row.add("error_memory", errors.memory);
      row.add("estimate_recovery", errors.recovery);
      add("exact_", errors.exact);
    }



    template <int dim>
    void
    add_estimates(const Scene<dim>    &scene,
                  const ErrorEstimate &estimate,
                  Statistics          &row)
    {
      row.add("energy_norm", estimate.energy_norm);
      row.add("estimate_space", estimate.space);
      row.add("estimate_time", estimate.time);
      if (dim == 3 && scene.has_friction())
        row.add("estimate_friction", estimate.friction);
      if (scene.is_adaptive() && scene.has_irreversible_stress())
        row.add("estimate_transfer", estimate.transfer);
      row.add("estimate_algebraic", estimate.algebraic);
      row.add("estimate_initial", estimate.initial);
      row.add("estimate_total", estimate.total());
      if (scene.quantity)
        {
          const QuantityEstimate &quantity = estimate.quantity;
          row.add("quantity_correction",
                  quantity.space_correction + quantity.time_correction);
          row.add("quantity_space", quantity.space);
          row.add("quantity_time", quantity.time);
          row.add("quantity_other",
                  quantity.total() - quantity.space - quantity.time);
          row.add("quantity_total", quantity.total());
        }
      row.add("time_indicator", estimate.time_indicator);
      row.add("velocity_variation", estimate.velocity_variation);
    }
  } // namespace



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
    , progress(console, scene.schedule.n_steps())
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
    discretization = &on_mesh;
    probes.clear();
    for (const Point<dim> &x : scene.output_points)
      probes.emplace_back(on_mesh.space, x);
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
      // All ranks compute; rank 0 writes.
      TimerOutput::Scope phase(timer, "balance");
      quantities = measure_step(*discretization, old, step);
      for (const PointProbe<dim> &probe : probes)
        quantities.point_displacements.push_back(probe.value(step.end.state.u));
    }
    if (is_initial)
      {
        balance.begin(quantities.stored_energy);
        first_set_up_seconds =
          timer.get_summary_data(TimerOutput::total_wall_time)["set-up"];
      }
    else
      balance.add_step({quantities.stored_energy,
                        quantities.external_work,
                        quantities.stress.viscous_dissipation,
                        quantities.friction.dissipation});
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
    if (statistics)
      write_row(step, quantities, errors);
    report_progress(step, quantities);
  }



  template <int dim>
  void
  Recorder<dim>::judge(const AcceptedStep<dim>   &step,
                       const StepQuantities<dim> &quantities)
  {
    // The contact tolerance bounds the error in the energy norm, in which
    // nearly incompressible bodies hide large errors of reactions.
    const double defect = balance_defect(quantities);
    if (step.time_step.n > 0 && !balance_is_doubtful &&
        defect > std::max(1e-8, std::min(1e3 * step.report.tolerance, 1e-2)))
      {
        balance_is_doubtful = true;
        std::ostringstream text;
        text << "Warning: forces balance only to " << defect
             << " of the largest at t = " << step.time_step.t
             << "; a smaller 'Solver/Contact tolerance' mends this unless "
                "Poisson's ratio is next to 1/2 or the body hardly resists.";
        console.remark(text.str());
      }
    if (run.capped_volume.value == 0. && step.capped_volume > 0.)
      {
        std::ostringstream text;
        text << "Warning: the stress has passed the cap of a law, in the "
                "volume "
             << step.capped_volume << " at t = " << step.time_of_rate()
             << "; beyond it the law is continued linearly.";
        console.remark(text.str());
      }
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
    run.t                              = t;
    run.reactions                      = quantities.reactions;
    run.stored_energy                  = balance.stored_energy();
    run.external_work                  = balance.external_work();
    run.energy_balance_defect          = balance.defect();
    run.max_displacement               = quantities.max_displacement;
    run.point_displacements            = quantities.point_displacements;
    run.tension_area.update(quantities.tension_area, t);
    if (run.displacement.update(quantities.max_displacement, t))
      run.displacement_position = quantities.displacement_position;
    run.strain.update(stress.max_strain, t);
    if (run.von_mises.update(stress.max_von_mises, t))
      run.von_mises_position = stress.von_mises_position;
    run.capped_volume.update(step.capped_volume, step.time_of_rate());
    run.largest_error.update(errors.error);
    run.largest_exact.update(errors.exact);
    if (scene.has_viscosity())
      run.viscous_dissipation = balance.viscous_dissipation();
    if (discretization->face)
      {
        run.friction_force       = quantities.friction_force;
        run.friction_dissipation = balance.friction_dissipation();
        run.slipping_area        = friction.slip_area;
        // New meshes may have more friction points, or fewer.
        if (friction.slip_area > run.slip_area.value ||
            run.slip_area.value == 0.)
          run.friction_area = friction.slip_area + friction.stick_area;
        run.slip_area.update(friction.slip_area, t);
        run.utilization.update(friction.max_utilization, t);
      }
    if (scene.is_adaptive())
      {
        run.adaptation_energy = balance.adaptation_energy();
        if (!has_error_estimate)
          run.error_estimate = quantities.refinement_estimate;
      }
    // Initial data that have not been brought into equilibrium have no
    // estimate.
    if (run.errors && (step.time_step.n > 0 || step.end.is_solution))
      {
        const ErrorEstimate &estimate = step.end.errors;
        run.errors->update(estimate, estimate.energy_norm, t);
        if (scene.quantity)
          run.quantity_errors.update(estimate.quantity,
                                     std::abs(estimate.quantity.value),
                                     t);
      }
    if (const double k_r = step.stiffness(); k_r > run.stiffness.value)
      {
        run.stiffness.update(k_r, t);
        for (unsigned int d = 0; d < dim; ++d)
          run.critical_position[d] = step.critical_position[d];
      }
    if (control.may_reject())
      run.steps = control.counts();
    if (scene.is_implicit_beyond_the_limit())
      run.implicit_steps = implicit_steps;
  }



  template <int dim>
  void
  Recorder<dim>::write_row(const AcceptedStep<dim>   &step,
                           const StepQuantities<dim> &quantities,
                           const SolutionErrors      &errors)
  {
    const Discretization<dim> &d         = *discretization;
    const TimeStep            &time_step = step.time_step;
    const StressSummary<dim>  &stress    = quantities.stress;
    const FrictionIdentities  &friction  = quantities.friction;
    const Forces<dim>         &forces    = step.end.forces;
    Statistics                &row       = *statistics;
    row.add("step", time_step.n);
    row.add("t", time_step.t);
    row.add("k", time_step.k);
    row.add("cells",
            d.space.dof_handler.get_triangulation().n_global_active_cells());
    row.add("dofs", d.space.dof_handler.n_dofs());
    if (scene.has_viscosity())
      {
        row.add("step_limit", step.step_limit);
        row.add("k_r", step.stiffness());
        row.add_vector("critical_cell", step.critical_position, dim);
      }
    if (control.may_reject())
      row.add("rejected", step.n_rejections);
    if (d.tension)
      row.add("tension_area", quantities.tension_area);
    if (d.laws.any_cap)
      row.add("capped_volume", step.capped_volume);
    if (may_be_implicit())
      row.add("newton_iterations", step.newton_iterations);
    if (d.face)
      row.add("contact_iterations", step.report.iterations);
    row.add("linear_iterations", step.report.linear_iterations);
    row.add("unchanged", step.is_unchanged);
    if (d.face)
      {
        row.add("duality_gap", step.report.duality_gap);
        row.add("algebraic_error", step.report.relative_error);
        row.add("stick_area", friction.stick_area);
        row.add("slip_area", friction.slip_area);
        row.add_vector("friction_force", quantities.friction_force, dim);
      }
    for (const auto &[id, force] : quantities.reactions)
      row.add_vector("reaction_" + std::to_string(id), force, dim);
    row.add_vector("load", forces.load.resultant, dim);
    row.add("force_balance_defect", balance_defect(quantities));
    if (d.face)
      {
        row.add("max_utilisation", friction.max_utilization);
        row.add("max_stick_slip", friction.max_stick_slip);
        row.add("slip_misalignment", friction.slip_misalignment);
      }
    row.add("stored_energy", balance.stored_energy());
    row.add("strain_energy", forces.strain_energy);
    if (scene.has_viscosity())
      row.add("viscous_dissipation", balance.viscous_dissipation());
    if (d.face)
      row.add("friction_dissipation", balance.friction_dissipation());
    row.add("external_work", balance.external_work());
    if (scene.is_adaptive())
      row.add("adaptation_energy", balance.adaptation_energy());
    row.add("energy_balance_defect", balance.defect());
    row.add("max_displacement", quantities.max_displacement);
    row.add("max_von_mises", stress.max_von_mises);
    row.add("mean_von_mises", stress.mean_von_mises);
    row.add("stress_norm", stress.stress_norm);
    for (unsigned int i = 0; i < quantities.point_displacements.size(); ++i)
      row.add_vector("point" + std::to_string(i),
                     quantities.point_displacements[i],
                     dim);
    if (scene.is_adaptive())
      row.add("estimator", quantities.refinement_estimate);
    if (has_error_estimate)
      add_estimates(scene, step.end.errors, row);
    if (scene.measures_errors())
      add_errors(errors, row);
    write_seconds();
    row.end_row();
  }



  template <int dim>
  void
  Recorder<dim>::write_seconds()
  {
    const auto total = timer.get_summary_data(TimerOutput::total_wall_time);
    for (const RunPhase &phase : run_phases)
      {
        if (!phase.is_in_statistics ||
            (phase.name == "estimate" && !has_error_estimate) ||
            (phase.name == "tangent" && !may_be_implicit()))
          continue;
        const auto   entry = total.find(phase.name);
        const double now   = entry == total.end() ? 0. : entry->second;
        statistics->add("wall_" + phase.name, now - last_seconds[phase.name]);
        last_seconds[phase.name] = now;
      }
    statistics->add("wall_total", elapsed_in_all());
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
  void
  Recorder<dim>::report_progress(const AcceptedStep<dim>   &step,
                                 const StepQuantities<dim> &quantities)
  {
    const TimeStep &time_step = step.time_step;
    StepProgress    present{time_step.n,
                         time_step.t,
                         time_step.k,
                         static_cast<double>(
                           discretization->space.dof_handler.get_triangulation()
                             .n_global_active_cells())};
    if (discretization->face)
      {
        const FrictionIdentities &friction = quantities.friction;
        const double area          = friction.slip_area + friction.stick_area;
        present.contact_iterations = step.report.iterations;
        if (area > 0.)
          present.slipping = friction.slip_area / area;
      }
    if (scene.is_adaptive() && !has_error_estimate)
      present.error_estimate = quantities.refinement_estimate;
    present.relative_error = relative_error(step.end.errors);
    if (control.may_reject())
      {
        if (time_step.n > 0)
          expected_step.add_step(time_step.k);
        present.expected_steps = control.expected_steps(time_step.n,
                                                        time_step.t,
                                                        expected_step.size());
        present.done           = time_step.t / scene.schedule.end_time();
        present.steps_grow     = present.done < 1. && expected_step.grows();
      }
    progress.report(present, elapsed());
  }



  template <int dim>
  void
  Recorder<dim>::resume(const State<dim> &state, const double seconds_before)
  {
    earlier_seconds = seconds_before;
    first_set_up_seconds =
      timer.get_summary_data(TimerOutput::total_wall_time)["set-up"];
    // For the progress this is the beginning.
    progress.report({0,
                     state.t,
                     state.k,
                     static_cast<double>(
                       discretization->space.dof_handler.get_triangulation()
                         .n_global_active_cells())},
                    elapsed());
  }



  template <int dim>
  std::map<std::string, double>
  Recorder<dim>::seconds() const
  {
    auto result      = timer.get_summary_data(TimerOutput::total_wall_time);
    result["set-up"] = first_set_up_seconds;
    return result;
  }



  template <int dim>
  void
  Recorder<dim>::check_sizes(const bool at_end) const
  {
    for (const auto &[what, size] :
         {std::make_pair("displacement", run.displacement.value),
          std::make_pair("von Mises stress", run.von_mises.value),
          std::make_pair("force", largest_force)})
      AssertThrow(!(size > largest_size) &&
                    !(at_end && size > 0. && size < least_size),
                  ExcMessage(out_of_range("The largest " + std::string(what) +
                                            " of the run",
                                          size,
                                          least_size,
                                          largest_size)));
  }



  template <int dim>
  std::string
  Recorder<dim>::remark_on_tolerance() const
  {
    const ErrorSummary &summary = run.controlled_errors();
    const ErrorParts   &errors  = summary.largest;
    const double        size    = summary.size;
    const auto n_cells = discretization->space.dof_handler.get_triangulation()
                           .n_global_active_cells();
    const RefinementParameters &refinement = scene.parameters.refinement;
    const unsigned int          n_in_memory =
      refinement.memory_budget > 0. ?
                 cells_in_memory(*discretization, 1e9 * refinement.memory_budget) :
                 std::numeric_limits<unsigned int>::max();
    std::ostringstream text;
    text << std::setprecision(3)
         << "Warning: 'Error control/Tolerance' = " << budget->tolerance
         << " has not been kept: at t = " << summary.t
         << " the error is estimated as " << summary.relative() << " of the "
         << (scene.quantity ? "largest " + scene.quantity->name : "solution")
         << ", of it " << errors.space / size << " by the mesh, "
         << (errors.time + errors.friction) / size << " by the time steps and "
         << errors.initial / size << " by the initial data; ";
    if (errors.time + errors.friction > 0.5 * errors.total())
      text << "steps of the smallest size are too long, so that the data jump "
              "or 'Step control/Smallest step' is too large.";
    else if (!scene.is_adaptive())
      text << "the mesh is fixed by 'Mesh refinement/Strategy'.";
    else if (n_in_memory < refinement.cell_budget &&
             n_cells > 0.8 * n_in_memory)
      text << "it takes more memory than 'Mesh refinement/Memory budget' = "
           << refinement.memory_budget << " GB.";
    else if (n_cells > 0.8 * refinement.cell_budget)
      text << "it takes more cells than 'Mesh refinement/Cell budget' = "
           << refinement.cell_budget << '.';
    else
      text << "it takes cells beyond 'Mesh refinement/Maximal level' = "
           << refinement.maximal_level << '.';
    return text.str();
  }



  template <int dim>
  std::vector<std::string>
  Recorder<dim>::remarks(const State<dim> &state) const
  {
    std::vector<std::string> result;
    const double             fluctuation =
      scene.has_viscosity() ?
                    relative_stress_fluctuation(discretization->stress_space, state) :
                    0.;
    if (fluctuation > 0.2 &&
        scene.parameters.stress.stress_history == StressHistory::cell_means)
      {
        std::ostringstream text;
        text << std::setprecision(3)
             << "Note: the stress varies within cells by " << fluctuation
             << " of its norm, so that cell means may be too stiff in long "
                "creep; refine the mesh or set 'Material/Stress history' = "
                "quadrature points.";
        result.push_back(text.str());
      }

    const double tension =
      discretization->tension ?
        run.tension_area.value / discretization->tension->area() :
        0.;
    if (tension > 0.01)
      {
        std::ostringstream text;
        text << "Note: at t = " << run.tension_area.t
             << " the foundation pulls at the body on "
             << std::lround(100. * tension)
             << " % of the face in bilateral contact, which does not open.";
        result.push_back(text.str());
      }

    if (budget && run.controlled_errors().relative() > budget->tolerance)
      result.push_back(remark_on_tolerance());

    for (const std::string &what : effects.that_never_acted(scene, run))
      result.push_back("Note: " + what);

    // What meshes do is no physics.
    if (std::abs(balance.adaptation_energy()) > 0.1 * balance.scale())
      {
        std::ostringstream text;
        text << std::setprecision(3)
             << "Warning: changes of the mesh have added "
             << balance.adaptation_energy()
             << " to the stored energy beyond the work of the loads, beside "
             << balance.scale()
             << " of the loads and the initial state: some meshes were so "
                "coarse that energies, and what flowed on them, are not to be "
                "trusted. Begin with a finer mesh ('Geometry/Global "
                "refinements').";
        result.push_back(text.str());
      }

    // All ranks have the coarse mesh.
    const auto corners =
      GridTools::compute_bounding_box(
        discretization->space.dof_handler.get_triangulation())
        .get_boundary_points();
    const double size   = corners.first.distance(corners.second);
    const bool   is_far = run.displacement.value > size;
    if (is_far || run.strain.value > 1.)
      {
        std::ostringstream text;
        text << std::setprecision(3)
             << "Note: at t = " << (is_far ? run.displacement.t : run.strain.t);
        if (is_far)
          text << " the largest displacement is "
               << run.displacement.value / size
               << " times the size of the body";
        else
          text << " the norm of the strain is " << run.strain.value
               << " in the mean of a cell";
        text << "; small strains are assumed, so that this is flow without end "
                "or a load far too large, and only its onset means something.";
        result.push_back(text.str());
      }
    return result;
  }



  template <int dim>
  void
  Recorder<dim>::print(std::ostream &out, const RunSummary<dim> *coarser) const
  {
    out << '\n';
    run.print(out, coarser);
    const double n = run.n_steps;
    out << std::setprecision(3) << "Iterations per step: ";
    if (may_be_implicit())
      out << newton_iterations / n << " of Newton's method, ";
    if (discretization->face)
      out << contact_iterations / n << " of the active set, ";
    out << linear_iterations / n << " linear\n";
    RunBill bill;
    bill.seconds       = seconds();
    bill.total         = elapsed();
    bill.has_viscosity = scene.has_viscosity();
    bill.solves        = solve_seconds;
    if (scene.has_friction())
      bill.plain_solves = plain_solve_seconds;
    bill.print(out);
  }



  template class Recorder<2>;
  template class Recorder<3>;
} // namespace Viscoplastic
