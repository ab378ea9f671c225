// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/blas_kernel.h>
#include <viscoplastic_contact/energy.h>
#include <viscoplastic_contact/error_estimator.h>
#include <viscoplastic_contact/number_range.h>
#include <viscoplastic_contact/reference_fields.h>
#include <viscoplastic_contact/solution_errors.h>
#include <viscoplastic_contact/version.h>
#include <viscoplastic_contact/viscoplastic_contact.h>

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
      add("exact_", errors.exact);
    }
  } // namespace



  template <int dim>
  void
  ViscoplasticContact<dim>::announce() const
  {
    out << "viscoplastic_contact " << VISCOPLASTIC_CONTACT_VERSION << " ("
        << VISCOPLASTIC_CONTACT_GIT_REVISION << "), " << parameters.file
        << " on " << Utilities::MPI::n_mpi_processes(communicator)
        << " MPI rank(s)\nEffects:\n";
    for (const std::string &effect : scene.effects())
      out << "  " << effect << '\n';
    for (const std::string &warning : scene.warnings)
      console.remark("Warning: " + warning);
    const std::string advice = advice_on_blas_kernel();
    if (!advice.empty())
      out << "Note: " << advice << '\n';
    out << std::flush;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_mesh() const
  {
    out << "Mesh: " << triangulation.n_global_active_cells() << " cells, "
        << dof_handler.n_dofs() << " degrees of freedom";
    if (discretization->face)
      out << ", " << discretization->face->layout().points.size()
          << " friction points";
    out << (discretization->mean_dilatation ? ", mean dilatation\n" : "\n");
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_held_faces()
  {
    if (!discretization->face)
      return;
    for (const types::boundary_id id : discretization->face->held_boundaries())
      if (announced_held_faces.insert(id).second)
        console.remark(
          "Note: nothing slips on boundary " + std::to_string(id) +
          ", although it has friction: other conditions hold all of its nodes "
          "on the present mesh; refine it there, or release another boundary.");
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_solver()
  {
    const std::string name = time_stepper->method().solver_name();
    if (name.empty() || name == announced_solver)
      return;
    announced_solver = name;
    out << "Linear solver: " << announced_solver << std::endl;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::record(const EvaluatedState<dim> &old,
                                   const AcceptedStep<dim>   &step)
  {
    const TimeStep            &time_step = step.time_step;
    const State<dim>          &old_state = old.state, &state = step.end.state;
    const Forces<dim>         &forces     = step.end.forces;
    const Discretization<dim> &d          = *discretization;
    const bool                 is_initial = time_step.n == 0;

    // All ranks compute; rank 0 writes.
    TimerOutput::Scope  phase(timer, "balance");
    const StressSummary stress = summarise_stress(d.laws, old_state, state);
    const double        stored_energy = forces.strain_energy +
                                 forces.irreversible_work +
                                 stress.irreversible_energy;
    // Frames are orthonormal, and hanging nodes lie between others.
    double max_displacement = 0.;
    for (std::size_t i = 0; i < d.space.owned.n_elements(); i += dim)
      {
        Tensor<1, dim> u;
        for (unsigned int c = 0; c < dim; ++c)
          u[c] = forces.u.begin()[i + c];
        max_displacement = std::max(max_displacement, stable_norm(u));
      }
    max_displacement = Utilities::MPI::max(max_displacement, communicator);
    DistributedVector change = forces.u;
    change -= old.forces.u;
    FrictionIdentities friction;
    Tensor<1, dim>     friction_force;
    if (d.face)
      {
        friction       = check_friction(*d.face,
                                  old_state.friction,
                                  state.friction,
                                  is_initial ? d.face->bounds(0.) : step.bounds,
                                  change,
                                  step.foundation_step,
                                  max_displacement);
        friction_force = d.face->resultant(state.friction);
      }
    const double tension_area = d.tension ? d.tension->tension_area(state) : 0.;
    const auto   reaction_forces = reactions(d.space, forces);

    // Forces on the body: loads, reactions, minus the multipliers.
    Tensor<1, dim> balance = forces.load.resultant - friction_force;
    double        &size    = accounts.largest_force;
    size                   = std::max({size,
                                       stable_norm(forces.load.resultant),
                                       stable_norm(friction_force)});
    for (const auto &pair : reaction_forces)
      {
        balance += pair.second;
        size = std::max(size, stable_norm(pair.second));
      }

    // The contact tolerance bounds the error in the energy norm, in which
    // nearly incompressible bodies hide large errors of reactions.
    const double balance_defect = size > 0. ? stable_norm(balance) / size : 0.;
    if (!is_initial && !balance_is_doubtful &&
        balance_defect >
          std::max(1e-8, std::min(1e3 * step.report.tolerance, 1e-2)))
      {
        balance_is_doubtful = true;
        std::ostringstream text;
        text << "Warning: forces balance only to " << balance_defect
             << " of the largest at t = " << time_step.t
             << "; a smaller 'Solver/Contact tolerance' mends this unless "
                "Poisson's ratio is next to 1/2 or the body hardly resists.";
        console.remark(text.str());
      }

    if (is_initial)
      accounts.initial_energy = stored_energy;
    else
      {
        accounts.external_work +=
          external_work(d.space, old.forces, forces) + friction.foundation_work;
        accounts.largest_work =
          std::max(accounts.largest_work, std::abs(accounts.external_work));
        accounts.viscous_dissipation += stress.viscous_dissipation;
        accounts.friction_dissipation += friction.dissipation;
      }
    accounts.contact_iterations += step.report.iterations;
    accounts.linear_iterations += step.report.linear_iterations;
    accounts.newton_iterations += step.newton_iterations;
    accounts.implicit_steps += step.is_implicit;
    const double defect =
      accounts.external_work -
      (stored_energy - accounts.initial_energy - accounts.adaptation_energy) -
      accounts.viscous_dissipation - accounts.friction_dissipation;

    std::vector<Tensor<1, dim>> point_values;
    for (const auto &probe : probes)
      point_values.push_back(probe.value(state.u));
    const Vector<double> &indicators =
      step.end.space_estimate.squared_indicators;
    const double estimate =
      indicators.size() > 0 ? total_estimate(indicators, communicator) : 0.;
    phase.stop();
    summary.displacement.update(max_displacement, time_step.t);
    summary.von_mises.update(stress.max_von_mises, time_step.t);
    check_sizes();
    const SolutionErrors errors = measure_errors(state);
    summary.largest_error.update(errors.error);
    summary.largest_exact.update(errors.exact);

    if (statistics)
      {
        Statistics &row = *statistics;
        row.add("step", time_step.n);
        row.add("t", time_step.t);
        row.add("k", time_step.k);
        row.add("cells", triangulation.n_global_active_cells());
        row.add("dofs", dof_handler.n_dofs());
        if (scene.has_viscosity())
          {
            row.add("step_limit", step.step_limit);
            row.add("k_r", 2. * time_step.k / step.step_limit);
            row.add_vector("critical_cell", step.critical_position, dim);
          }
        if (control.may_reject())
          row.add("rejected", step.n_rejections);
        if (d.tension)
          row.add("tension_area", tension_area);
        if (d.laws.any_cap)
          row.add("capped_volume", step.capped_volume);
        if (is_implicit() || changes_scheme())
          row.add("newton_iterations", step.newton_iterations);
        if (d.face)
          {
            row.add("contact_iterations", step.report.iterations);
            row.add("linear_iterations", step.report.linear_iterations);
            row.add("duality_gap", step.report.duality_gap);
            row.add("algebraic_error", step.report.relative_error);
            row.add("stick_area", friction.stick_area);
            row.add("slip_area", friction.slip_area);
            row.add_vector("friction_force", friction_force, dim);
          }
        else
          row.add("linear_iterations", step.report.linear_iterations);
        for (const auto &[id, force] : reaction_forces)
          row.add_vector("reaction_" + std::to_string(id), force, dim);
        row.add_vector("load", forces.load.resultant, dim);
        row.add("force_balance_defect", balance_defect);
        if (d.face)
          {
            row.add("max_utilisation", friction.max_utilisation);
            row.add("max_stick_slip", friction.max_stick_slip);
            row.add("slip_misalignment", friction.slip_misalignment);
          }
        row.add("stored_energy", stored_energy);
        row.add("strain_energy", forces.strain_energy);
        if (scene.has_viscosity())
          row.add("viscous_dissipation", accounts.viscous_dissipation);
        if (d.face)
          row.add("friction_dissipation", accounts.friction_dissipation);
        row.add("external_work", accounts.external_work);
        if (scene.is_adaptive())
          row.add("adaptation_energy", accounts.adaptation_energy);
        row.add("energy_balance_defect", defect);
        row.add("max_displacement", max_displacement);
        row.add("max_von_mises", stress.max_von_mises);
        row.add("mean_von_mises", stress.mean_von_mises);
        row.add("stress_norm", stress.stress_norm);
        for (unsigned int i = 0; i < point_values.size(); ++i)
          row.add_vector("point" + std::to_string(i), point_values[i], dim);
        if (scene.is_adaptive())
          row.add("estimator", estimate);
        if (error_bar)
          {
            const ErrorLedger &ledger = step.end.errors;
            row.add("energy_norm", ledger.energy_norm);
            row.add("estimate_space", ledger.space);
            row.add("estimate_time", ledger.time);
            row.add("estimate_algebraic", ledger.algebraic);
            row.add("estimate_initial", ledger.initial);
            row.add("estimate_total", ledger.total());
            row.add("time_indicator", ledger.time_indicator);
            row.add("velocity_variation", ledger.velocity_variation);
          }
        if (measures_errors())
          add_errors(errors, row);

        const auto total = timer.get_summary_data(TimerOutput::total_wall_time);
        for (const char *name : {"rate",
                                 "tangent",
                                 "load",
                                 "contact",
                                 "balance",
                                 "estimate",
                                 "output"})
          {
            if ((!error_bar && name == std::string("estimate")) ||
                (!is_implicit() && !changes_scheme() &&
                 name == std::string("tangent")))
              continue;
            const auto   entry = total.find(name);
            const double now   = entry == total.end() ? 0. : entry->second;
            row.add(std::string("wall_") + name, now - last_seconds[name]);
            last_seconds[name] = now;
          }
        row.add("wall_total", earlier_seconds + run_timer.wall_time());
        row.end_row();
      }

    // Progress, and what is said at the end.
    const double elapsed = run_timer.wall_time();
    StepProgress progress_of_step{time_step.n,
                                  time_step.t,
                                  time_step.k,
                                  static_cast<double>(
                                    triangulation.n_global_active_cells())};
    summary.t                     = time_step.t;
    summary.reactions             = reaction_forces;
    summary.stored_energy         = stored_energy;
    summary.external_work         = accounts.external_work;
    summary.energy_balance_defect = defect;
    summary.tension_area.update(tension_area, time_step.t);
    summary.strain.update(stress.max_strain, time_step.t);
    summary.max_displacement    = max_displacement;
    summary.point_displacements = point_values;
    if (scene.has_viscosity())
      summary.viscous_dissipation = accounts.viscous_dissipation;
    if (d.face)
      {
        summary.friction_force       = friction_force;
        summary.friction_dissipation = accounts.friction_dissipation;
        summary.slipping_area        = friction.slip_area;
        // New meshes may have more friction points, or fewer.
        const double area = friction.slip_area + friction.stick_area;
        if (friction.slip_area > summary.slip_area.value ||
            summary.slip_area.value == 0.)
          summary.friction_area = area;
        summary.slip_area.update(friction.slip_area, time_step.t);
        progress_of_step.contact_iterations = step.report.iterations;
        if (area > 0.)
          progress_of_step.slipping = friction.slip_area / area;
      }
    if (scene.is_adaptive())
      {
        summary.adaptation_energy = accounts.adaptation_energy;
        if (!error_bar)
          {
            summary.error_estimate          = estimate;
            progress_of_step.error_estimate = estimate;
          }
      }
    if (error_bar)
      {
        if (step.end.errors.energy_norm > 0.)
          progress_of_step.relative_error =
            step.end.errors.total() / step.end.errors.energy_norm;
      }
    // The rate of an explicit step is that of its beginning.
    const double rate_time = step.is_implicit ? time_step.t : time_step.t_old;
    if (summary.capped_volume.value == 0. && step.capped_volume > 0.)
      {
        std::ostringstream volume;
        volume << step.capped_volume << " at t = " << rate_time;
        console.remark("Warning: the stress has passed the cap of a law, in "
                       "the volume " +
                       volume.str() +
                       "; beyond it the law is continued linearly.");
      }
    summary.capped_volume.update(step.capped_volume, rate_time);
    if (const double k_r = 2. * time_step.k / step.step_limit;
        k_r > summary.stiffness.value)
      {
        summary.stiffness.update(k_r, time_step.t);
        for (unsigned int d = 0; d < dim; ++d)
          summary.critical_position[d] = step.critical_position[d];
      }
    summary.n_steps = time_step.n;
    if (control.may_reject())
      summary.steps = control.counts();
    if (changes_scheme())
      summary.implicit_steps = accounts.implicit_steps;
    if (control.may_reject())
      {
        progress_of_step.expected_steps =
          control.expected_steps(time_step.n, time_step.t, time_step.k);
        progress_of_step.done = time_step.t / scene.schedule.end_time();
      }
    if (is_initial)
      first_set_up_seconds =
        timer.get_summary_data(TimerOutput::total_wall_time)["set-up"];
    progress.report(progress_of_step, elapsed);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::check_references() const
  {
    const std::string &directory =
      parameters.exact_solution.reference_directory;
    if (directory.empty())
      return;
    AssertThrow(!scene.exact_solution,
                ExcMessage("'Exact solution/Reference directory' and 'Exact "
                           "solution/Displacement' are both given; errors "
                           "can be measured against one of them."));
    for (unsigned int i = 1; i <= scene.schedule.n_phases(); ++i)
      read_samples<dim>(samples_file(directory, i), communicator);
  }



  template <int dim>
  SolutionErrors
  ViscoplasticContact<dim>::measure_errors(const State<dim> &of)
  {
    const unsigned int phase = scene.schedule.phase_ending_at(of.t);
    const std::string &reference =
      parameters.exact_solution.reference_directory;
    SolutionErrors result;
    result.error.fill(std::numeric_limits<double>::quiet_NaN());
    result.exact  = result.error;
    result.memory = result.error.energy;
    // A run without files has no output.
    const bool writes =
      output && parameters.output.reference_fields && phase > 0;
    if (!writes && !scene.exact_solution && (reference.empty() || phase == 0))
      return result;

    TimerOutput::Scope         scope(timer, "errors");
    const Discretization<dim> &d = *discretization;
    DistributedVector          multipliers;
    const DistributedVector   *density = nullptr;
    if (d.face)
      {
        multipliers = d.face->density(of.friction);
        density     = &multipliers;
      }
    if (writes)
      write_samples(sample_fields(d.sampling, of, density),
                    samples_file(output->directory(), phase),
                    communicator);
    if (scene.exact_solution)
      result = solution_errors(d.sampling, of, density);
    else if (!reference.empty() && phase > 0)
      {
        const auto samples =
          read_samples<dim>(samples_file(reference, phase), communicator);
        std::ostringstream message;
        message << "'Exact solution/Reference directory': phase " << phase
                << " of the reference ends at t = " << samples.t
                << ", that of this run at t = " << of.t
                << "; 'Time/Phases' must have the same end times.";
        AssertThrow(std::abs(samples.t - of.t) <= 1e-10 * std::abs(of.t),
                    ExcMessage(message.str()));
        const double nothing = result.memory;
        result               = differences(samples, d.sampling, of, density);
        result.memory        = nothing;
      }
    return result;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::check_sizes() const
  {
    for (const auto &[what, size] :
         {std::make_pair("displacement", summary.displacement.value),
          std::make_pair("von Mises stress", summary.von_mises.value),
          std::make_pair("force", accounts.largest_force)})
      AssertThrow(!(size > largest_size) &&
                    !(is_finished() && size > 0. && size < least_size),
                  ExcMessage(out_of_range("The largest " + std::string(what) +
                                            " of the run",
                                          size,
                                          least_size,
                                          largest_size)));
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::close()
  {
    check_sizes();
    const unsigned int       n       = accepted.state.n;
    std::vector<std::string> remarks = console.remarks();
    if (scene.has_viscosity())
      {
        const double fluctuation =
          relative_stress_fluctuation(discretization->sampling, accepted.state);
        if (fluctuation > 0.2 &&
            parameters.stress.stress_history == "cell means")
          {
            std::ostringstream text;
            text << std::setprecision(3)
                 << "Note: the stress varies within cells by " << fluctuation
                 << " of its norm, so that cell means may be too stiff in long "
                    "creep; refine the mesh or set 'Material/Stress history' = "
                    "quadrature points.";
            remarks.push_back(text.str());
          }
      }

    const double tension =
      discretization->tension ?
        summary.tension_area.value / discretization->tension->area() :
        0.;
    if (tension > 0.01)
      {
        std::ostringstream text;
        text << "Note: at t = " << summary.tension_area.t
             << " the foundation pulls at the body on "
             << std::lround(100. * tension)
             << " % of the face in bilateral contact, which does not open.";
        remarks.push_back(text.str());
      }

    // What meshes do is no physics.
    const double given = accounts.largest_work + accounts.initial_energy;
    if (std::abs(accounts.adaptation_energy) > 0.1 * given)
      {
        std::ostringstream text;
        text << std::setprecision(3)
             << "Warning: changes of the mesh have added "
             << accounts.adaptation_energy << " to the stored energy, beside "
             << given
             << " of the loads and the initial state: energies, and forces "
                "after a change of the mesh, are not to be trusted. A fixed "
                "mesh ('Mesh refinement/Strategy' = none) is free of it, and "
                "fewer changes ('Every n steps') add less; bodies next to "
                "incompressible are prone to it.";
        remarks.push_back(text.str());
      }

    // All ranks have the coarse mesh.
    const auto corners =
      GridTools::compute_bounding_box(triangulation).get_boundary_points();
    const double size   = corners.first.distance(corners.second);
    const bool   is_far = summary.displacement.value > size;
    if (is_far || summary.strain.value > 1.)
      {
        std::ostringstream text;
        text << std::setprecision(3) << "Note: at t = "
             << (is_far ? summary.displacement.t : summary.strain.t);
        if (is_far)
          text << " the largest displacement is "
               << summary.displacement.value / size
               << " times the size of the body";
        else
          text << " the norm of the strain is " << summary.strain.value
               << " in the mean of a cell";
        text << "; small strains are assumed, so that this is flow without end "
                "or a load far too large, and only its onset means something.";
        remarks.push_back(text.str());
      }

    out << '\n';
    summary.print(console.stream(),
                  coarser_summary ? &*coarser_summary : nullptr);
    if (coarser_summary && Utilities::MPI::this_mpi_process(communicator) == 0)
      write_uncertainties(output->directory() + "uncertainty.csv",
                          summary,
                          *coarser_summary);
    if (error_bar)
      output->record_errors(*summary.errors);
    out << std::setprecision(3) << "Iterations per step: ";
    if (is_implicit() || changes_scheme())
      out << static_cast<double>(accounts.newton_iterations) / n
          << " of Newton's method, ";
    if (discretization->face)
      out << static_cast<double>(accounts.contact_iterations) / n
          << " of the active set, ";
    out << static_cast<double>(accounts.linear_iterations) / n << " linear\n";
    print_seconds(console.stream(),
                  timer.get_summary_data(TimerOutput::total_wall_time),
                  first_set_up_seconds,
                  run_timer.wall_time(),
                  scene.has_viscosity(),
                  discretization->face != nullptr);
    for (const std::string &remark : remarks)
      out << remark << '\n';
    out << "Results in " << output->directory() << std::endl;
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
