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
  /// The expected size of the solution and the number of steps, which a run to
  /// a tolerance needs before its first step.
  struct Expectation
  {
    /// About how large the solution becomes, in the energy norm or by its
    /// quantity of interest. Zero, and @p failure says why, if nobody knows.
    double      size = 0.;
    std::string failure;
    /// The norms of the dual solution of a quantity, and their times.
    std::vector<double> dual_times, dual_norms;
    /// How often the first mesh has to be refined before the quantity of
    /// interest is not zero.
    unsigned int refinements = 0;
  };

  /// Finds that out. Collective.
  using PilotRun = std::function<Expectation()>;



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
    /// @p pilot_run is called in runs to a tolerance only. Throws ExcMessage
    /// with a sentence for the user, as all functions do.
    ViscoplasticContact(const Parameters &parameters,
                        Console          &console,
                        const PilotRun   &pilot_run);

    /// Simulate, from the start or from a checkpoint; a pass that needs another
    /// one ends without closing words. Returns a sentence if a signal has ended
    /// the run early, after a checkpoint.
    std::string
    run(const CommandLine::Restart restart = CommandLine::Restart::no);

    /// Run without files and without the words at the beginning, in one pass;
    /// returns what is known at the end.
    RunSummary<dim>
    run_without_files();

    /// Whether the pass that has ended is not the run: it has changed its mesh
    /// where only the mesh from the beginning will do, see run_in_passes().
    bool
    needs_another_pass() const;

    /// Begin on the mesh that another pass has come to, when this one runs, and
    /// count its time as that of a pilot run.
    void
    follow(const ViscoplasticContact<dim> &earlier);

  private:
    bool
    is_finished() const
    {
      return accepted.state.t >= scene.schedule.end_time();
    }

    /// Everything up to the initial state.
    void
    begin();
    /// The initial state on the first mesh, and what has to be known before the
    /// first step.
    void
    begin_state();
    /// Initial data, (3.20), on meshes that become finer until they resolve
    /// them.
    void
    set_initial_state();
    /// Record and write the initial state unless that has been done: at once,
    /// or, where the
    /// first step may refine the mesh and begin anew, once it has been made.
    void
    record_initial_state();

    /// Make a step from the accepted state.
    AcceptedStep<dim>
    next_step();
    /// Make all steps up to the end. Returns a sentence if a signal has ended
    /// the run early.
    std::string
    make_steps();

    /// Make everything that depends on the mesh.
    void
    set_up();
    /// Change the mesh if the estimate of the accepted state says so.
    void
    adapt_mesh();
    /// Refine the mesh of the accepted state if it is too coarse for a step
    /// from there. Returns whether it has been, and the step is to be repeated.
    bool
    refine_for(const AcceptedStep<dim> &step);
    /// Refine the first mesh if MeshController::mark_first() says so.
    bool
    refine_first_mesh(const double          estimate,
                      const double          allowed,
                      const Vector<double> &squared_indicators);
    /// Change the mesh as its cells are marked.
    void
    change_mesh();
    /// Change the mesh before the first step: projects the initial data of the
    /// scene anew.
    void
    begin_on_finer_mesh();
    /// Begin the next stage of construction.
    void
    enter_next_stage();

    /// Go on from a checkpoint: what begin() does, and all steps up to there.
    void
    resume(const CheckpointManifest &checkpoint);
    /// Print the closing words and complete the record of the run.
    void
    close();

    // What is simulated.
    const MPI_Comm                            communicator;
    const Parameters                         &parameters;
    Scene<dim>                                scene;
    parallel::distributed::Triangulation<dim> triangulation;
    const FESystem<dim>                       fe; // of V_h
    DoFHandler<dim>                           dof_handler;

    // How meshes and steps are chosen.
    const PilotRun                       pilot_run;
    std::optional<ErrorBudget>           budget; // of a tolerance
    StepControl                          control;
    MeshController<dim>                  mesh_controller;
    std::unique_ptr<ErrorEstimator<dim>> error_estimator; // null if not wanted

    // Made anew on each mesh.
    std::unique_ptr<Discretization<dim>> discretization;
    std::unique_ptr<TimeStepper<dim>>    time_stepper;

    /// The position of the run in its passes.
    PassState pass;

    /// The last accepted state, and the report of the first equilibrium.
    EvaluatedState<dim> accepted;
    ContactReport       initial_report;
    bool                has_recorded_initial_state = false;

    // What is said and kept.
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
