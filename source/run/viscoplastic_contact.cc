// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_q.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/elasticity.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/solution_errors.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>
#include <viscoplastic_contact/results/unit_labels.h>
#include <viscoplastic_contact/run/pilot_run.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>
#include <viscoplastic_contact/scene/kinks_in_time.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// That of all ranks together in MB, now and at the most.
    std::pair<double, double>
    memory_of_ranks(const MPI_Comm communicator)
    {
      Utilities::System::MemoryStats stats;
      Utilities::System::get_memory_stats(stats); // kB
      return {Utilities::MPI::sum(stats.VmRSS / 1024., communicator),
              Utilities::MPI::sum(stats.VmHWM / 1024., communicator)};
    }
  } // namespace



  template <int dim>
  ViscoplasticContact<dim>::ViscoplasticContact(const Parameters &parameters,
                                                Console          &console)
    : communicator(MPI_COMM_WORLD)
    , parameters(parameters)
    , console(console)
    , out(console.stream())
    , announcer(console)
    , scene(parameters)
    , triangulation(communicator)
    , fe(FE_Q<dim>(1), dim)
    , dof_handler(triangulation)
    , directories(parameters, console, communicator)
    , budget(
        parameters.error_control.has_tolerance() ?
          std::make_optional<ErrorBudget>(parameters.error_control.tolerance,
                                          dim,
                                          order_of(parameters.time.scheme),
                                          scene.quantity.has_value()) :
          std::nullopt)
    , control(parameters.step_control,
              parameters.time.stiffness_policy,
              scene.schedule,
              order_of(parameters.time.scheme),
              parameters.output.fields_interval,
              budget ? budget->time_tolerance() : 0.)
    , error_estimator(parameters.error_control.error_estimator ?
                        std::make_unique<ErrorEstimator<dim>>(scene) :
                        nullptr)
    , lines(scene)
    , timer(out, TimerOutput::never, TimerOutput::wall_times)
    , known_solution(scene, timer)
    , recorder(scene, control, console, timer, budget ? &*budget : nullptr)
  {}



  template <int dim>
  std::string
  ViscoplasticContact<dim>::run(const CommandLine::Restart restart,
                                const RunSummary<dim>     *coarser)
  {
    first_memory = memory_of_ranks(communicator).first;
    make_mesh();
    known_solution.check();
    directories.lock();
    if (const auto checkpoint = directories.find_checkpoint(restart))
      {
        resume(*checkpoint);
        if (is_finished())
          {
            out << "This is the last step: there is nothing left to do."
                << std::endl;
            return "";
          }
      }
    else
      begin();

    const SignalRequests signals;
    const std::string    interruption = make_steps(&signals);
    if (interruption.empty())
      close(coarser);
    return interruption;
  }



  template <int dim>
  std::string
  ViscoplasticContact<dim>::make_steps(const SignalRequests *signals)
  {
    last_step = recorder.elapsed();
    while (!is_finished())
      {
        if (scene.stage_is_over(accepted.state.t))
          enter_next_stage();
        if (adaptation_is_due())
          adapt_mesh();
        AcceptedStep<dim> step = time_stepper->next(accepted);
        if (refine_for(step))
          {
            control.undo();
            continue;
          }
        n_refinements = 0;
        announcer.announce_solver(time_stepper->method().solver_name());
        recorder.record(accepted,
                        step,
                        known_solution.errors(*discretization, step.end.state));
        accepted = std::move(step.end);
        if (signals == nullptr)
          continue;
        known_solution.write_reference(*discretization,
                                       accepted.state,
                                       output->directory());
        write_results(output->is_due(step.time_step));
        const std::string interruption = keep_checkpoints(*signals);
        if (!interruption.empty())
          return interruption;
      }
    return "";
  }



  template <int dim>
  RunSummary<dim>
  ViscoplasticContact<dim>::run_without_files()
  {
    make_mesh();
    begin_state();
    record_initial_state();
    make_steps(nullptr);
    recorder.check_sizes(/* at_end = */ true);
    return recorder.summary();
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::take_mesh_of_first_pass()
  {
    out << "First without files, to find a mesh for all times:" << std::endl;
    ViscoplasticContact<dim> first(parameters, console);
    first.is_first_pass = true;
    first.run_without_files();
    refine_like(first.triangulation, triangulation);
    out << "Again from the beginning, on the mesh that has been found:"
        << std::endl;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::begin_state()
  {
    std::string failure;
    if (budget)
      {
        TimerOutput::Scope phase(timer, "pilot run");
        budget->expect_size(size_in_pilot_run<dim>(parameters, failure));
        control.expect_size(budget->expected_size);
      }
    if (scene.quantity && scene.is_adaptive() && budget && !is_first_pass)
      {
        TimerOutput::Scope phase(timer, "pilot run");
        take_mesh_of_first_pass();
      }
    check_stages();
    set_up();
    if (scene.exact_solution && scene.exact_solution->makes_data)
      check_exact_solution(discretization->space);
    set_initial_state();
    check_steps();
    // A scene that is wrong has been refused by now.
    if (!failure.empty())
      console.remark("Note: the run on the first mesh that tells how large the "
                     "solution becomes has failed, so that errors will be "
                     "relative to what it has been so far: " +
                     failure);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::begin()
  {
    begin_state();
    directories.begin();
    output.emplace(scene, communicator);
    lines.begin(output->directory());
    directories.begin_checkpoints();
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      recorder.write_to(std::make_unique<Statistics>(
        output->directory() + "statistics.csv",
        [labels = UnitLabels<dim>(scene)](const std::string &column) {
          return labels.of_column(column);
        }));
    // First: the seconds that steps are expected to take begin with the record.
    write_results(/* fields_are_due = */ true);
    record_initial_state();
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::record_initial_state()
  {
    AcceptedStep<dim> initial;
    initial.time_step = {0, 0., 0., 0.};
    initial.end       = accepted;
    initial.report    = initial_report;
    recorder.record(accepted,
                    initial,
                    known_solution.errors(*discretization, accepted.state));
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::make_mesh()
  {
    Viscoplastic::make_mesh(parameters.geometry, triangulation);
    scene.inspect(triangulation);
    AssertThrow(!control.is_on || !scene.has_viscosity() || error_estimator,
                ExcMessage("'Step control/Tolerance' needs an estimate of the "
                           "error; set 'Error control/Error bar' = true."));
    control.set_has_estimate(scene.has_viscosity());
    if (!is_first_pass)
      announcer.announce(scene);
    land_on_kinks();
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::land_on_kinks()
  {
    control.land_on(scene.stage_ends, {});
    if (!control.is_on || !parameters.step_control.land_on_kinks)
      return;
    const KinksOfScene found = find_kinks(scene, triangulation);
    if (found.kinks.empty())
      return;
    if (!is_first_pass)
      announcer.announce(found);
    std::vector<double> kinks, jumps;
    for (const Kink &kink : found.kinks)
      (kink.is_jump ? jumps : kinks).push_back(kink.t);
    control.land_on(kinks, jumps);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::set_up()
  {
    TimerOutput::Scope scope(timer, "set-up");
    distribute_nodes(fe, dof_handler);
    // The old one goes first: matrices and factors are what fills memory.
    accepted.is_solution = false;
    time_stepper.reset();
    discretization.reset();
    discretization = std::make_unique<Discretization<dim>>(dof_handler, scene);
    discretization->assemble_matrix();
    time_stepper = std::make_unique<TimeStepper<dim>>(*discretization,
                                                      error_estimator.get(),
                                                      control,
                                                      timer);
    if (accepted.forces.u.size() == 0) // the first time
      announcer.announce(*discretization);
    announcer.warn_of_held_faces(*discretization);
    announcer.announce_solver(time_stepper->method().solver_name());
    recorder.set_mesh(*discretization);
    lines.set_mesh(*discretization);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::set_initial_state()
  {
    const bool equilibrate = parameters.initial_state.equilibrate;
    bool       is_refined  = false;
    do
      {
        const Discretization<dim> &d = *discretization;
        accepted.state = make_initial_state(d.stress_space, equilibrate);
        if (error_estimator)
          {
            const Vector<double> squared_by_cell =
              error_estimator->begin(d.stress_space, accepted);
            if (budget)
              {
                is_refined = refine_first_mesh(accepted.errors.initial,
                                               budget->initial(),
                                               squared_by_cell);
                if (is_refined)
                  continue;
              }
          }
        if (equilibrate)
          initial_report = time_stepper->equilibrate(accepted);
        else
          {
            const Load<dim> load = d.loads.assemble(0.);
            check_compatibility(load);
            accepted.forces =
              evaluate_forces(d.stress_space, d.matrix, load, accepted.state);
          }
        if (scene.is_adaptive() || equilibrate)
          time_stepper->estimate(accepted);
        if (!error_estimator || !equilibrate)
          break;
        ErrorEstimate &errors = accepted.errors;
        error_estimator->assess_equilibrium(initial_report, accepted);
        is_refined =
          budget &&
          refine_first_mesh(budget->errors(errors).space,
                            budget->space(budget->errors(errors),
                                          budget->size(budget->size(errors)),
                                          scene.has_time_error()),
                            accepted.space_estimate.squared_indicators);
      }
    while (is_refined);
    if (equilibrate)
      announcer.announce_equilibrium(scene, accepted.state.u.linfty_norm());
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::check_compatibility(const Load<dim> &load)
  {
    const Discretization<dim> &d = *discretization;
    const double tolerance = parameters.initial_state.compatibility_tolerance;
    const CompatibilityViolation<dim> violation = compatibility_violation(
      d.space, load, d.face.get(), accepted.state.u, accepted.state.contact);
    // Data that a solution makes are compatible up to quadrature.
    if (scene.exact_solution && scene.exact_solution->makes_data)
      return;
    std::ostringstream message;
    message << "The initial data are not in equilibrium with the loads at "
               "t = 0, (2.12): the relative violation is "
            << violation.relative
            << ", and 'Initial state/Compatibility tolerance' is " << tolerance
            << "; it is largest at x = (" << violation.position << "), "
            << (violation.boundaries.empty() ?
                  "inside of the body" :
                  "on boundary " + list(violation.boundaries))
            << "; start with loads that the initial stress balances, or set "
               "'Initial state/Equilibrate'.";
    AssertThrow(violation.relative <= tolerance, ExcMessage(message.str()));
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::write_results(const bool fields_are_due)
  {
    TimerOutput::Scope    phase(timer, "output");
    const Vector<double> &squared_indicators =
      accepted.space_estimate.squared_indicators;
    if (fields_are_due)
      for (const std::string &remark : output->write_fields(
             discretization->laws,
             accepted.state,
             discretization->face.get(),
             squared_indicators.size() > 0 ? &squared_indicators : nullptr))
        console.remark(remark);
    lines.write(accepted.state, fields_are_due);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::close(const RunSummary<dim> *coarser)
  {
    recorder.check_sizes(/* at_end = */ true);
    std::vector<std::string> remarks = console.remarks();
    for (const std::string &remark : recorder.remarks(accepted.state))
      remarks.push_back(remark);
    recorder.print(out, coarser);
    if (coarser != nullptr &&
        Utilities::MPI::this_mpi_process(communicator) == 0)
      write_uncertainties<dim>(output->directory() + "uncertainty.csv",
                               recorder.summary(),
                               *coarser,
                               [&](const std::string &quantity) {
                                 return UnitLabels<dim>(scene).of_column(
                                   quantity);
                               });
    output->record_end(recorder.summary(),
                       {recorder.seconds(),
                        first_memory,
                        memory_of_ranks(communicator).second,
                        discretization->solver_demand()});
    for (const std::string &remark : remarks)
      out << remark << '\n';
    out << "Results in " << output->directory() << std::endl;
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
