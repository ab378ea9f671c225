// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/timer.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/error/known_solution.h>
#include <viscoplastic_contact/error/mesh_controller.h>
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/run/announcer.h>
#include <viscoplastic_contact/run/command_line.h>
#include <viscoplastic_contact/run/run_files.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <functional>
#include <memory>
#include <optional>

namespace Viscoplastic
{
  /// Tells budget and step control what a run to a tolerance has to know before
  /// its first step, and refines its first mesh as far as it has to be. Returns
  /// a remark, or none. Collective.
  template <int dim>
  using PilotRun =
    std::function<std::string(ErrorBudget &,
                              StepControl &,
                              parallel::distributed::Triangulation<dim> &)>;



  /// The fully discrete problem P^hk (3.18)-(3.20) in total form, for one
  /// scene. This class owns the mesh, the spaces, the matrix and the state, and
  /// decides the order in which its collaborators work:
  ///
  ///     state at t_{n-1} -> rate of z -> load -> contact solver
  ///                      -> statistics, output, checkpoint
  ///                      -> mesh adaptation, before the next step
  ///
  /// Displacements are in V_h, FE_Q(1) in each component (AdmissibleSpace).
  /// Stresses and z are in Q_h, symmetric tensors of FE_DGQ(0), or of its
  /// refinement at the Gauss points, whose cell means are what is reported
  /// (StressSpace).
  template <int dim>
  class ViscoplasticContact
  {
  public:
    /// @p pilot_run is called in runs to a tolerance that do not follow() an
    /// earlier pass. This and all member functions throw ExcMessage with a
    /// sentence for the user.
    ViscoplasticContact(const Parameters    &parameters,
                        Console             &console,
                        const PilotRun<dim> &pilot_run);

    /// Simulate from the start or from a checkpoint. Returns a sentence if a
    /// signal has ended the run early, after a checkpoint. If another pass is
    /// needed, the final output is omitted.
    std::string
    run(const CommandLine::Restart restart = CommandLine::Restart::no);

    /// Run in one pass, without files and introductory output; returns the
    /// summary at the end.
    RunSummary<dim>
    run_without_files();

    /// Whether the finished pass has to be repeated on its final mesh, since
    /// its mesh changed, see run_in_passes().
    bool
    needs_another_pass() const;

    /// Start on the final mesh of an @p earlier pass when this one runs, and
    /// count the time of that pass as that of a pilot run.
    void
    follow(const ViscoplasticContact<dim> &earlier);

  private:
    bool
    is_finished() const
    {
      return accepted.state.t >= scene.schedule.end_time();
    }

    /// Do all work before the first step.
    void
    begin();
    /// Make the initial state on the first mesh and perform the checks before
    /// the first step.
    void
    begin_state();
    /// Set the initial data, (3.20), refining the first mesh until it resolves
    /// them.
    void
    set_initial_state();
    /// Record and write the initial state, once. This is called before the
    /// first step, or after it if the first step may refine the mesh and start
    /// anew.
    void
    record_initial_state();

    /// Make a step from the accepted state.
    AcceptedStep<dim>
    next_step();
    /// Make all steps. Returns a sentence if a signal has ended the run.
    std::string
    make_steps();

    /// Make everything that depends on the mesh.
    void
    set_up();
    /// Refine the mesh of the accepted state if it is too coarse for a step
    /// from there. Returns whether it was and the step has to be repeated.
    bool
    refine_for(const AcceptedStep<dim> &step);
    /// Change the mesh according to its marked cells, without the state.
    void
    change_first_mesh();
    /// Change the mesh according to its marked cells.
    void
    change_mesh();
    /// Begin the next stage of construction.
    void
    enter_next_stage();

    /// Continue from a checkpoint, in the place of begin() and earlier steps.
    void
    resume(const CheckpointManifest &checkpoint);
    /// Print the final output and complete the record of the run.
    void
    close();

    // The problem and its mesh.
    const MPI_Comm                            communicator;
    const Parameters                         &parameters;
    Scene<dim>                                scene;
    parallel::distributed::Triangulation<dim> triangulation;
    const FESystem<dim>                       fe; // of V_h
    DoFHandler<dim>                           dof_handler;

    // Control of meshes and steps.
    const PilotRun<dim>                  pilot_run;
    std::unique_ptr<ErrorBudget>         budget; // null without a tolerance
    StepControl                          control;
    MeshController<dim>                  mesh_controller;
    std::unique_ptr<ErrorEstimator<dim>> error_estimator; // null if not wanted

    // Constructed anew on each mesh.
    std::unique_ptr<Discretization<dim>> discretization;
    std::unique_ptr<TimeStepper<dim>>    time_stepper;

    /// The position of the run in its passes.
    PassState pass;

    /// The last accepted state.
    EvaluatedState<dim> accepted;
    bool                has_recorded_initial_state = false;

    // Messages, timing and files.
    Console                     &console;
    std::ostream                &out; // of the console
    Announcer<dim>               announcer;
    TimerOutput                  timer; // wall time by phase
    KnownSolution<dim>           known_solution;
    Recorder<dim>                recorder;
    RunState<dim>                run_state; // of a checkpoint
    std::optional<RunFiles<dim>> files;     // absent in a run without
  };
} // namespace Viscoplastic
