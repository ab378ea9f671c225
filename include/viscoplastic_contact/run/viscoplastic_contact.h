// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/fe/fe_system.h>

#include <viscoplastic_contact/error/known_solution.h>
#include <viscoplastic_contact/error/mesh_controller.h>
#include <viscoplastic_contact/run/run_files.h>

namespace Viscoplastic
{
  /// The fully discrete problem P^hk (3.18)-(3.20) in total form, for one
  /// scene. This class owns the mesh, the spaces, the matrix and the state, and
  /// decides the order in which its collaborators work:
  ///
  ///     state at t_{n-1} -> rate of z -> load -> contact solver
  ///                      -> statistics, output, checkpoint
  ///                      -> mesh adaptation, before the next step
  ///
  /// Displacements are in V_h (AdmissibleSpace), stresses and z in Q_h
  /// (StressSpace). Functions throw ExcMessage with a sentence for the user.
  template <int dim>
  class ViscoplasticContact
  {
  public:
    using Mesh = parallel::distributed::Triangulation<dim>;

    /// Tells budget and step control what they have to know before the first
    /// step, by runs of its own, and refines the first mesh if it has to be.
    /// Returns a remark.
    using PilotRun = std::string (*)(const Parameters &,
                                     ErrorBudget &,
                                     StepControl &,
                                     Mesh &);

    /// @p pilot_run: for runs to a tolerance that do not follow() another pass.
    ViscoplasticContact(const Parameters &parameters,
                        Console          &console,
                        const PilotRun    pilot_run);

    /// Simulate from the start or from a checkpoint. Returns a sentence if a
    /// signal has ended the run early, after a checkpoint. If another pass is
    /// needed, the final output is omitted.
    std::string
    run(const CommandLine::Restart restart);
    /// Run in one pass, without files and introductory output.
    RunSummary<dim>
    run_without_files();

    /// Whether a pass has to be repeated on its final mesh, see
    /// run_in_passes().
    bool
    needs_another_pass() const;
    /// Start on the final mesh of an @p earlier pass, which counts as pilot
    /// run.
    void
    follow(const ViscoplasticContact<dim> &earlier);

  private:
    /// Make and check the initial state.
    void
    begin();
    /// Continue from a checkpoint, in the place of begin() and earlier steps.
    void
    resume(const CheckpointManifest &from);
    /// Make everything that depends on the mesh.
    void
    set_up();
    /// Set the initial data, (3.20), on a mesh that resolves them.
    void
    set_initial_state(bool mesh_changes = false);
    /// Set the initial data, in equilibrium if the scene asks for that. Returns
    /// false, with cells marked, if the mesh of a run to a tolerance is too
    /// coarse for them.
    bool
    resolve_initial_data();
    /// Record and write the initial state, once: before the first step, or
    /// after it if the first step may refine the mesh and start anew.
    void
    record_initial_state();
    /// Make all steps. Returns a sentence if a signal has ended the run.
    std::string
    make_steps();
    AcceptedStep<dim>
    next_step();
    /// Print the linear solver once it is known.
    void
    announce_solver();
    /// Refine the mesh if it is too coarse for a step; whether to repeat that.
    bool
    refine_for(const AcceptedStep<dim> &step);
    /// Carry the accepted state to the mesh for which cells have been marked,
    /// or to the next stage of construction, and restore equilibrium with
    /// sticking friction; the next step lets it slip.
    void
    change_mesh();
    void
    enter_next_stage();
    /// Reset the rate and update the errors of a state that has been carried,
    /// see ErrorEstimator::change_mesh().
    void
    complete_transfer(const double loss, const double history);
    bool
    is_finished() const
    {
      return accepted.state.t >= scene.schedule.end_time();
    }

    // The problem, its mesh, and V_h on it.
    Scene<dim>          scene;
    Mesh                triangulation;
    const FESystem<dim> fe;
    DoFHandler<dim>     dof_handler;

    // Control of passes, meshes and steps; pointers are null if not wanted.
    const PilotRun                       pilot_run;
    PassState                            pass;
    std::unique_ptr<ErrorBudget>         budget;
    StepControl                          control;
    MeshController<dim>                  mesh_controller;
    std::unique_ptr<ErrorEstimator<dim>> error_estimator;

    // What is constructed anew on each mesh, and the last accepted state.
    std::unique_ptr<Discretization<dim>> discretization;
    std::unique_ptr<TimeStepper<dim>>    time_stepper;
    EvaluatedState<dim>                  accepted;

    // Messages, wall time by phase, records, and files unless run without.
    Console                     &console;
    TimerOutput                  timer;
    KnownSolution<dim>           known_solution;
    Recorder<dim>                recorder;
    RunState<dim>                run_state;
    std::optional<RunFiles<dim>> files;
    std::string                  solver_name; // that has been printed
  };
} // namespace Viscoplastic
