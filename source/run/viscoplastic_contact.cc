// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/fe/fe_q.h>

#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>
#include <viscoplastic_contact/run/announcer.h>
#include <viscoplastic_contact/run/scene_check.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

namespace Viscoplastic
{
  template <int dim>
  ViscoplasticContact<dim>::ViscoplasticContact(const Parameters &parameters,
                                                Console          &console,
                                                const PilotRun    pilot_run)
    : scene(parameters)
    , triangulation(MPI_COMM_WORLD)
    , fe(FE_Q<dim>(1), dim)
    , dof_handler(triangulation)
    , pilot_run(pilot_run)
    , budget(ErrorBudget::of_run(parameters))
    , control(parameters, scene.schedule, budget.get())
    , mesh_controller(scene, triangulation, budget.get())
    , error_estimator(parameters.error_control.error_estimator ?
                        std::make_unique<ErrorEstimator<dim>>(scene) :
                        nullptr)
    , console(console)
    , timer(console.stream(), TimerOutput::never, TimerOutput::wall_times)
    , known_solution(scene, timer)
    , recorder(scene, control, console, timer, budget.get())
    , run_state{scene, accepted, control, budget.get(), pass, recorder}
  {}



  template <int dim>
  std::string
  ViscoplasticContact<dim>::run(const CommandLine::Restart restart)
  {
    files.emplace(run_state, console, timer, triangulation.get_communicator());
    if (!pass.follows_another)
      make_first_mesh(scene, triangulation, control, &console);
    known_solution.check();
    if (const auto checkpoint = files->find_checkpoint(restart))
      {
        resume(*checkpoint);
        if (is_finished() && !needs_another_pass())
          {
            console.stream()
              << "This is the last step: there is nothing left to do.\n";
            return "";
          }
      }
    else
      {
        begin();
        files->begin();
        // If the first step refines its mesh, the initial state is made anew.
        if (mesh_controller.repeats_steps())
          recorder.stop_clock();
        else
          record_initial_state();
      }
    files->begin_steps();
    const std::string interruption = make_steps();
    files->finish();
    if (interruption.empty() && !needs_another_pass())
      files->close();
    return interruption;
  }



  template <int dim>
  std::string
  ViscoplasticContact<dim>::make_steps()
  {
    if (pass.follows_another)
      mesh_controller.keep_cells();
    while (!is_finished())
      {
        if (scene.stage_is_over(accepted.state.t))
          enter_next_stage();
        if (mesh_controller.is_due(accepted.state.n) &&
            mesh_controller.mark(*discretization,
                                 accepted,
                                 recorder.size_so_far()))
          change_mesh();
        AcceptedStep<dim> step = next_step();
        if (refine_for(step))
          {
            if (needs_another_pass())
              return "";
            continue;
          }
        record_initial_state();
        announce_solver();
        recorder.record(accepted,
                        step,
                        known_solution.errors(*discretization, step.end.state));
        accepted = std::move(step.end);
        if (!files)
          continue;
        known_solution.write_reference(*discretization,
                                       accepted.state,
                                       files->directory());
        files->write(step.time_step);
        const std::string interruption =
          files->keep_checkpoints(triangulation, *time_stepper);
        if (!interruption.empty())
          return interruption;
      }
    return "";
  }



  template <int dim>
  RunSummary<dim>
  ViscoplasticContact<dim>::run_without_files()
  {
    make_first_mesh(scene, triangulation, control, nullptr);
    begin();
    make_steps();
    recorder.check_sizes(/* at_end = */ true);
    return recorder.summary();
  }



  template <int dim>
  bool
  ViscoplasticContact<dim>::needs_another_pass() const
  {
    if (pass.has_changed_mesh && mesh_controller.begins_again())
      return true;
    if (!budget || !scene.quantity)
      return false;
    if (pass.has_changed_mesh && ((QuantityEstimator<dim>::is_of_creep(scene) &&
                                   !scene.quantity->is_sum()) ||
                                  (is_finished() && !pass.follows_another)))
      return true;
    const ErrorSummary &errors = recorder.summary().controlled_errors();
    return is_finished() && errors.relative() > budget->tolerance &&
           (pass.has_changed_mesh || budget->expected_size > errors.size);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::follow(const ViscoplasticContact<dim> &earlier)
  {
    pass.follows_another = true;
    make_first_mesh(scene, triangulation, control, nullptr);
    refine_like(earlier.triangulation, triangulation);
    budget->expected_size = earlier.budget->expected_size;
    if (earlier.is_finished())
      budget->expect_size(earlier.recorder.size_so_far());
    control.expect_dual_norms_of(earlier.control);
    recorder.count_pilot_run(earlier.recorder);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::begin()
  {
    std::string remark;
    if (budget)
      {
        if (!pass.follows_another)
          {
            TimerOutput::Scope phase(timer, "pilot run");
            remark =
              pilot_run(scene.parameters, *budget, control, triangulation);
          }
        control.expect_size(budget->expected_size);
      }
    check_stages(fe, dof_handler, scene);
    set_up();
    if (scene.exact_solution && scene.exact_solution->makes_data)
      check_exact_solution(discretization->space);
    set_initial_state();
    check_steps(*discretization, control, console, accepted);
    // Wrong scenes, which make pilot runs fail as well, have been refused.
    if (!remark.empty())
      console.remark(remark);
  }



  template <int dim>
  AcceptedStep<dim>
  ViscoplasticContact<dim>::next_step()
  {
    try
      {
        return time_stepper->next(accepted);
      }
    catch (const StepFailure &)
      {
        record_initial_state();
        throw;
      }
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::record_initial_state()
  {
    if (accepted.state.n > 0 || recorder.has_begun())
      return;
    // Write first: expected times of steps are measured from the record on.
    if (files)
      files->write({0, 0., 0., 0.});
    recorder.record_initial_state(*time_stepper,
                                  known_solution.errors(*discretization,
                                                        accepted.state),
                                  accepted);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::set_up()
  {
    // Later set-ups are timed as part of the adaptation.
    const bool                        is_first = !discretization;
    std::optional<TimerOutput::Scope> scope;
    if (is_first)
      scope.emplace(timer, "set-up");
    distribute_nodes(fe, dof_handler);
    // Free the old matrix and factors, which use most memory, first.
    accepted.is_solution = false;
    time_stepper.reset();
    discretization.reset();
    discretization = std::make_unique<Discretization<dim>>(dof_handler, scene);
    discretization->assemble_matrix();
    time_stepper = std::make_unique<TimeStepper<dim>>(*discretization,
                                                      error_estimator.get(),
                                                      control,
                                                      timer);
    if (is_first)
      announce_first_mesh(*discretization, console);
    warn_of_held_faces(*discretization, console);
    announce_solver();
    recorder.set_mesh(*discretization);
    if (files)
      files->set_mesh(*discretization);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::set_initial_state(bool mesh_changes)
  {
    for (; mesh_changes || !resolve_initial_data(); mesh_changes = false)
      {
        TimerOutput::Scope phase(timer, "adaptation");
        triangulation.execute_coarsening_and_refinement();
        set_up();
      }
    announce_equilibrium(scene, accepted.state, console);
  }



  template <int dim>
  bool
  ViscoplasticContact<dim>::resolve_initial_data()
  {
    const bool equilibrate = scene.parameters.initial_state.equilibrate;
    accepted.state =
      make_initial_state(discretization->stress_space, equilibrate);
    accepted.rate.reset();
    if (error_estimator)
      {
        const Vector<double> squared_errors =
          error_estimator->begin(discretization->stress_space, accepted);
        if (mesh_controller.mark_first(*discretization,
                                       accepted,
                                       &squared_errors))
          return false;
      }
    if (equilibrate)
      time_stepper->equilibrate(accepted);
    else
      {
        const Load<dim> load = discretization->loads.assemble(0.);
        check_compatibility(*discretization, accepted.state, load);
        accepted.forces = evaluate_forces(discretization->stress_space,
                                          discretization->matrix,
                                          load,
                                          accepted.state);
      }
    if (scene.is_adaptive() || equilibrate)
      time_stepper->estimate(accepted);
    if (!error_estimator || !equilibrate)
      return true;
    error_estimator->assess_equilibrium(accepted);
    return !mesh_controller.mark_first(*discretization, accepted, nullptr);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_solver()
  {
    const std::string name = time_stepper->method().solver_name();
    if (name.empty() || name == solver_name)
      return;
    solver_name = name;
    console.stream() << "Linear solver: " << name << std::endl;
  }



  template <int dim>
  bool
  ViscoplasticContact<dim>::refine_for(const AcceptedStep<dim> &step)
  {
    if (!mesh_controller.repeats_steps())
      return false;
    if (!mesh_controller.mark_for_step(*discretization,
                                       accepted,
                                       step.end,
                                       std::max(budget->size(accepted.errors),
                                                recorder.size_so_far())))
      {
        mesh_controller.accept_step();
        return false;
      }
    if (accepted.state.n == 0)
      {
        // Initial data projected to a coarse mesh would keep its errors.
        set_initial_state(/* mesh_changes = */ true);
        recorder.stop_clock();
      }
    else
      {
        change_mesh();
        pass.has_changed_mesh = true;
      }
    control.repeat();
    const double excess = mesh_controller.excess();
    console.stream() << "  mesh "
                     << (excess >= 1.005 ? number(excess, 3) + " times " : "")
                     << "too coarse for step " << step.time_step.n
                     << ", refined to " << triangulation.n_global_active_cells()
                     << " cells" << std::endl;
    return true;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::resume(const CheckpointManifest &from)
  {
    RunArchive<dim> archive(files->checkpoints, from, run_state, triangulation);
    scene.enter_stage(scene.stage_of_step_to(accepted.state.t));
    set_up();
    time_stepper->restore(accepted, archive.read_fields(*discretization));
    files->resume(archive);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ViscoplasticContact);
} // namespace Viscoplastic
