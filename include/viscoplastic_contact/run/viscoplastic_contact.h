// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/timer.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/base/signals.h>
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/error/known_solution.h>
#include <viscoplastic_contact/results/line_output.h>
#include <viscoplastic_contact/results/output.h>
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/run/announcer.h>
#include <viscoplastic_contact/run/command_line.h>
#include <viscoplastic_contact/run/run_directories.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <functional>
#include <memory>
#include <optional>

namespace Viscoplastic
{
  /**
   * The fully discrete problem P^hk (3.18)-(3.20) in total form, for one scene.
   * This class owns the mesh, the spaces, the matrix and the state, and decides
   * the order in which its collaborators work:
   *
   *     state at t_{n-1} -> rate of z -> load -> contact solver
   *                      -> statistics, output, checkpoint
   *                      -> mesh adaptation, before the next step
   *
   * Displacements are in V_h, FE_Q(1) in each component (AdmissibleSpace).
   * Stresses and z are in Q_h, symmetric tensors of FE_DGQ(0), or of its
   * refinement at the Gauss points, whose cell means are what is reported
   * (StressSpace).
   */
  template <int dim>
  class ViscoplasticContact
  {
  public:
    /// Throws ExcMessage with a sentence for the user, as run() does.
    ViscoplasticContact(const Parameters &parameters, Console &console);

    /// Simulate, from the start or from a checkpoint. The closing words give
    /// each quantity with its difference from that of @p coarser, a run with
    /// twice the mesh width and time steps, unless that is null. Returns a
    /// sentence if a signal has ended the run early, after a checkpoint.
    std::string
    run(const CommandLine::Restart restart = CommandLine::Restart::no,
        const RunSummary<dim>     *coarser = nullptr);

    /// All steps without any file, and what is known at the end.
    RunSummary<dim>
    run_without_files();

    /**
     * Everything that can be known without solving: validates the scene with
     * its mesh, initial data and the data of all times, and prints size,
     * solver and what memory they need. Source: source/run/check.cc.
     */
    void
    check();

  private:
    /// The initial state on the first mesh, and what has to be known before the
    /// first step.
    void
    begin_state();

    /// Refine the first mesh of a run to a tolerance of a quantity as the last
    /// one of another such run is. What creeps or slips remembers each mesh, as
    /// the estimate of a quantity does not.
    void
    take_mesh_of_first_pass();

    /// Begin from the start: everything up to the initial state.
    void
    begin();

    /// Add the row of the initial state.
    void
    record_initial_state();

    bool
    is_finished() const
    {
      return accepted.state.t >= scene.schedule.end_time();
    }

    bool
    adaptation_is_due() const
    {
      const unsigned int n = accepted.state.n;
      return scene.is_adaptive() && n > 0 &&
             (budget ? n_refinements == 0 :
                       n % parameters.refinement.every_n_steps == 0);
    }

    /// All steps up to the end. @p signals is null in a run without files.
    /// Returns a sentence if a signal has ended the run early.
    std::string
    make_steps(const SignalRequests *signals);

    void
    make_mesh();

    /// End steps that are chosen by their error at kinks and jumps of the data.
    void
    land_on_kinks();

    /// Refuse a first step beyond the stability limit, before anything is
    /// written, and warn of later ones. Source: source/run/check.cc.
    void
    check_steps();

    /// What --check can say of the limit where check_steps() says nothing:
    /// where the initial state has no stress, or has yet to be brought into
    /// equilibrium. Source: source/run/check.cc.
    void
    announce_stability_limit();

    void
    set_up();

    void
    set_initial_state();

    /// Throws ExcMessage if the initial data violate (2.12).
    void
    check_compatibility(const Load<dim> &load);

    // Changes of the mesh: source/run/adaptation.cc.

    /// Those of the scene, with the number of cells that its bound on memory
    /// allows. Collective.
    RefinementParameters
    refinement_limits() const;

    /// Whether the estimate of the mesh at the accepted state is what rounding
    /// and iterations leave, as of a body that is carried along or strained
    /// uniformly: that says nothing about the mesh, and differs between numbers
    /// of ranks. Collective.
    bool
    estimate_is_rounding() const;

    /// Change the mesh, between two steps, if the estimate says so.
    void
    adapt_mesh();

    /// Refine the mesh of the accepted state if the error of a step from it is
    /// too large for the tolerance of the run. Returns whether it has been; the
    /// step is to be repeated then.
    bool
    refine_for(const AcceptedStep<dim> &step);

    /// Refine the first mesh if an estimate, of which cells contribute
    /// @p squared_indicators, is larger than @p allowed. Returns whether it has
    /// been; the initial state is to be made again then.
    bool
    refine_first_mesh(const double          estimate,
                      const double          allowed,
                      const Vector<double> &squared_indicators);

    /// The error of the mesh over what it may be in a run to a tolerance.
    double
    space_ratio(const ErrorEstimate &errors) const;

    /// What withdraws marks for coarsening where z would lose too much for the
    /// tolerance of the run.
    std::function<void()>
    keep_memory();

    /// Refuse stages of construction that do not fit the scene, before anything
    /// is solved. Collective. Source: source/run/stages.cc.
    void
    check_stages();

    /// Begin the next stage of construction at the end of a step: materials
    /// come and go, and the body finds its equilibrium while friction holds;
    /// the next step lets it slip.
    /// Source: source/run/stages.cc.
    void
    enter_next_stage();

    /// Change the mesh as its cells are marked, and bring the accepted state to
    /// it.
    void
    change_mesh();

    // Checkpoints: source/run/restart.cc.

    /// Begin from a checkpoint: what begin() does, and all steps up to there.
    void
    resume(const CheckpointManifest &checkpoint);

    /// Write a checkpoint at the end of a step if it is time for it, or a
    /// signal has asked for it. Returns a sentence if the run is to end.
    std::string
    keep_checkpoints(const SignalRequests &signals);

    void
    write_checkpoint();

    /// Write to, or read from, an archive what is the same on all ranks.
    template <typename Archive>
    void
    exchange(Archive &archive);

    /// Write the fields of the accepted state if they are due, and what is
    /// recorded along lines.
    void
    write_results(const bool fields_are_due);

    /// The closing words.
    void
    close(const RunSummary<dim> *coarser);

    const MPI_Comm                            communicator;
    const Parameters                         &parameters;
    Console                                  &console;
    std::ostream                             &out; // of the console
    Announcer<dim>                            announcer;
    Scene<dim>                                scene;
    parallel::distributed::Triangulation<dim> triangulation;
    const FESystem<dim>                       fe; // of V_h
    DoFHandler<dim>                           dof_handler;
    RunDirectories                            directories;
    std::optional<ErrorBudget>                budget; // of a tolerance
    StepControl                               control;
    std::unique_ptr<ErrorEstimator<dim>> error_estimator; // null if not wanted

    // Made anew on each mesh.
    std::unique_ptr<Discretization<dim>> discretization;
    std::unique_ptr<TimeStepper<dim>>    time_stepper;

    /// The last state that will do.
    EvaluatedState<dim> accepted;
    /// In MB, of all ranks, when the run began.
    double first_memory = 0.;
    /// How often the mesh has been refined for the step that is being made.
    unsigned int               n_refinements = 0;
    bool                       is_first_pass = false;
    ContactReport              initial_report;
    std::optional<Output<dim>> output; // absent without files
    LineOutput<dim>            lines;
    TimerOutput                timer; // wall time by phase
    KnownSolution<dim>         known_solution;
    Recorder<dim>              recorder;
    /// When the last checkpoint was written and the last step ended, as the
    /// recorder's clock has it.
    double last_checkpoint = 0., last_step = 0.;
  };
} // namespace Viscoplastic
