// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/conditional_ostream.h>
#include <deal.II/base/timer.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>

#include <viscoplastic_contact/checkpoint_store.h>
#include <viscoplastic_contact/command_line.h>
#include <viscoplastic_contact/console.h>
#include <viscoplastic_contact/contact_face.h>
#include <viscoplastic_contact/contact_solver.h>
#include <viscoplastic_contact/contact_tension.h>
#include <viscoplastic_contact/error_bar.h>
#include <viscoplastic_contact/files.h>
#include <viscoplastic_contact/flow_laws.h>
#include <viscoplastic_contact/force_balance.h>
#include <viscoplastic_contact/loads.h>
#include <viscoplastic_contact/output.h>
#include <viscoplastic_contact/point_probe.h>
#include <viscoplastic_contact/progress.h>
#include <viscoplastic_contact/residual_estimator.h>
#include <viscoplastic_contact/run_summary.h>
#include <viscoplastic_contact/signals.h>
#include <viscoplastic_contact/solution_errors.h>
#include <viscoplastic_contact/state.h>
#include <viscoplastic_contact/statistics.h>
#include <viscoplastic_contact/step_control.h>
#include <viscoplastic_contact/tangent_matrix.h>

#include <functional>
#include <memory>
#include <optional>
#include <set>

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
   * Displacements are FE_Q(1). Stresses and z are FE_DGQ(0), or live at the
   * quadrature points: tensors for each owned cell (see StressSampling), whose
   * cell means are what is reported.
   */
  template <int dim>
  class ViscoplasticContact
  {
  public:
    /// Throws ExcMessage with a sentence for the user, as run() does.
    ViscoplasticContact(const Parameters &parameters, Console &console);

    /// Returns a sentence if a signal has ended the run early, after a
    /// checkpoint.
    std::string
    run(const CommandLine::Restart restart = CommandLine::Restart::no);

    /// All steps without any file, and what is known at the end.
    RunSummary<dim>
    run_without_files();

    /// The closing words of run() give each quantity with its difference from
    /// that of a run with twice the mesh width and twice the time steps.
    void
    compare_with(const RunSummary<dim> &coarser);

    /**
     * Everything that can be known without solving: validates the scene with
     * its mesh, initial data and the data of all times, and prints size,
     * solver and what memory they need. Source: source/check.cc.
     */
    void
    check();

    /// Wall time of a run by phase, as the timer names them; `set-up' is that
    /// of all meshes.
    std::map<std::string, double>
    seconds() const
    {
      auto result = timer.get_summary_data(TimerOutput::total_wall_time);
      // Further set-ups are part of the adaptation.
      result["set-up"] = first_set_up_seconds + result["adaptation"];
      return result;
    }

  private:
    /// Everything that depends on the mesh, in the order of dependence.
    struct Discretisation
    {
      Discretisation(const DoFHandler<dim> &dof_handler,
                     const Scene<dim>      &scene);

      /// The costly rest: what solves need. Steps of backward Euler have
      /// matrices of their own and make the solver then.
      void
      make_matrix();

      /// For a matrix that stays in use; the elastic one, or of a tangent.
      void
      make_solver(const DistributedMatrix &of, const double max_nu);

      /// The face for solvers: null if there is nothing that could slip, also
      /// where other conditions hold all nodes of the frictional pieces.
      const ContactFace<dim> *
      slipping_face() const
      {
        return face && face->layout().n_dofs() > 0 ? face.get() : nullptr;
      }

      /// In runs that change between schemes: put the solver of the elastic
      /// matrix or that of the tangent in place, and the other one aside.
      void
      use_solver_of_tangent(const bool of_tangent);

      AdmissibleSpace<dim> space;
      ElasticModuli<dim>   moduli;
      bool                 mean_dilatation;
      StressSampling<dim>  sampling;
      FlowLaws<dim>        laws;
      Loads<dim>           loads;
      /// Null without bilateral contact.
      std::unique_ptr<ContactTension<dim>> tension;
      /// Null without friction.
      std::unique_ptr<ContactFace<dim>> face;
      /// Null in scenes without error bar that are not refined by it.
      std::unique_ptr<ResidualEstimator<dim>> estimator;

      /// How often a solver will be used at least.
      unsigned int      n_solves;
      DistributedMatrix matrix;
      FrictionFace      no_face;
      /// Null unless backward Euler has something to do.
      std::unique_ptr<TangentMatrix<dim>> tangent;
      std::unique_ptr<BulkSolver>         solver;
      DistributedVector                   diagonal; // of the solver's matrix

    private:
      std::unique_ptr<BulkSolver> solver_aside;
      DistributedVector           diagonal_aside;
      bool                        tangent_is_in_use = false;
    };

    /// What a step gives.
    struct Step
    {
      State<dim>          state;
      Forces<dim>         forces;
      ContactReport       report;
      std::vector<double> bounds;
      /// 2/r; infinite without viscosity. Backward Euler, which may pass it,
      /// reports that of the end of the step.
      double step_limit;
      /// Where r is that large; the origin where it is zero.
      Point<3> critical_position;
      /// Volume beyond the cap of a law.
      double capped_volume;
      /// What the foundation moved, as a face vector; empty at rest.
      Vector<double> foundation_step;
      /// Zero without error bar.
      ErrorLedger errors;
      /// Whether it is one of backward Euler, and of how many iterations.
      bool         is_implicit       = false;
      unsigned int newton_iterations = 0;
      /// How often a longer one has been tried.
      unsigned int n_rejections = 0;
    };

    /// What a step that is not accepted must not change.
    struct SolverState
    {
      bool                              is_solved_on_mesh;
      std::optional<BulkSolver::Memory> memory;
    };

    /// What adds up over the steps.
    struct Accounts
    {
      double initial_energy = 0., external_work = 0., viscous_dissipation = 0.,
             friction_dissipation = 0.;
      /// The largest load, reaction or friction force so far: the scale of
      /// defects of balance, also where all forces pass through zero.
      double largest_force = 0.;
      /// The largest |external_work| so far: the scale of energies, also where
      /// loads give back what they took.
      double largest_work = 0.;
      /// What changes of the mesh did to the stored energy.
      double       adaptation_energy  = 0.;
      unsigned int contact_iterations = 0, linear_iterations = 0,
                   newton_iterations = 0, implicit_steps = 0;
    };

    /// From the start: everything up to the initial state.
    void
    begin();

    /// Add the row of the initial state.
    void
    record_initial_state();

    bool
    is_finished() const
    {
      return state.t >= scene.schedule.end_time();
    }

    /// The next step, recorded and accepted. Returns what it was. Source:
    /// source/stepping.cc.
    TimeStep
    make_step();

    /// Steps from the accepted state until one will do.
    Step
    try_steps(TimeStep &time_step);

    /// What a step is judged by; its errors are known then.
    StepErrors
    assess(Step &step);

    /// What the solver is before a step, and back to that. Collective.
    SolverState
    solver_state();
    void
    restore(const SolverState &before);

    /// G at the accepted state, evaluated once.
    const FlowRate &
    accepted_rate();

    void
    make_mesh();

    /// Refuse a first step beyond the stability limit, before anything is
    /// written, and warn of later ones. Source: source/check.cc.
    void
    check_steps();

    void
    set_up();

    void
    set_initial_state();

    /// Throws ExcMessage if the initial data violate (2.12).
    void
    check_compatibility(const Load<dim> &load);

    bool
    is_implicit() const
    {
      return parameters.time.scheme == "backward Euler" &&
             scene.has_viscosity();
    }

    /// Whether some steps may be of backward Euler and others not.
    bool
    changes_scheme() const
    {
      return control.passes_limit && scene.has_viscosity() && !is_implicit();
    }

    /// Throws StepBeyondStability.
    void
    check_stability(const FlowRate &rate, const TimeStep &time_step) const;

    /// One step: a function of the accepted state, its forces and the time
    /// step. It keeps nothing but what solver_state() knows. Throws
    /// StepFailure.
    Step
    advance(const State<dim>  &old_state,
            const Forces<dim> &old_forces,
            const TimeStep    &time_step);

    /// Forward Euler, Heun: z by G at known states, then the rest.
    void
    advance_explicitly(const State<dim>  &old_state,
                       const Forces<dim> &old_forces,
                       const Load<dim>   &load,
                       const TimeStep    &time_step,
                       Step              &step);

    /// Backward Euler: z and the rest together. Source:
    /// source/implicit_step.cc.
    void
    advance_implicitly(const State<dim>  &old_state,
                       const Forces<dim> &old_forces,
                       const Load<dim>   &load,
                       const TimeStep    &time_step,
                       Step              &step);

    /// The matrix and the solver of backward Euler for tangents at a strain, as
    /// a function of what is given and the mesh alone.
    void
    linearise(const DistributedVector  &ghosted_u,
              const IrreversibleStress &z,
              const double              t,
              const double              k);

    /// z at the end of a step for the strains of a ghosted displacement, from a
    /// guess of it.
    using StressForStrain =
      std::function<IrreversibleStress(const DistributedVector &,
                                       const IrreversibleStress &)>;

    /**
     * How far to go from @p base, with the stress @p z, to @p u, whose stress
     * is that of the step: 1 unless the energy of the step increases before.
     * All in frames.
     */
    double
    step_length(const Forces<dim>        &old_forces,
                const Load<dim>          &load,
                const Step               &step,
                const DistributedVector  &base,
                const IrreversibleStress &z,
                const DistributedVector  &u,
                const StressForStrain    &z_for) const;

    /// u, multipliers and sets for a given z, at the time of @p state and
    /// for its step size; the start is what @p guess says of velocities and
    /// sets.
    ContactReport
    solve(const State<dim>          &guess,
          const Forces<dim>         &old_forces,
          const Load<dim>           &load,
          const std::vector<double> &bounds,
          const Vector<double>      &foundation_step,
          State<dim>                &state);

    /// The start of a solve: u in frames, and the sets of @p state.
    DistributedVector
    start(const State<dim>     &guess,
          const Forces<dim>    &old_forces,
          const Vector<double> &foundation_step,
          State<dim>           &state) const;

    /// Solve with the present matrix from a start to a relative tolerance.
    /// @p right_side is the load less what does not depend on u.
    ContactReport
    solve_from(const Forces<dim>         &old_forces,
               const Load<dim>           &load,
               const DistributedVector   &right_side,
               const std::vector<double> &bounds,
               const Vector<double>      &foundation_step,
               const double               tolerance,
               DistributedVector         &u,
               FrictionState             &friction);

    /// solve_from() in a unit of forces and displacements in which squares of
    /// them are ordinary numbers.
    ContactReport
    solve_in_unit(const DistributedVector   &old_u,
                  const DistributedVector   &load,
                  const DistributedVector   &right_side,
                  const std::vector<double> &bounds,
                  const Vector<double>      &foundation_step,
                  const double               tolerance,
                  DistributedVector         &u,
                  FrictionState             &friction);

    /// The largest of what the data of a step contribute to the energy norm,
    /// without squares.
    double
    size_of_data(const DistributedVector &old_u,
                 const DistributedVector &load,
                 const DistributedVector &right_side,
                 const Vector<double>    &foundation_step,
                 const DistributedVector &u) const;

    /// u and velocity of @p state.
    void
    set_displacement(const DistributedVector &u,
                     const Forces<dim>       &old_forces,
                     State<dim>              &state);

    /// At which the iterations of a step stop, relative to the solution.
    double
    step_tolerance() const;

    /// Estimate the error of a state: squared_estimate in adaptive scenes.
    /// Returns the residual estimate; zero in scenes that do not use it.
    double
    estimate(const State<dim> &of);

    void
    adapt_mesh();

    /// 1/2 int E^-1 sigma : sigma.
    double
    stored_energy(const State<dim> &of, const Forces<dim> &its_forces) const;

    /// Keep other processes out of the directories that this run writes into,
    /// as far as they exist and have no lock yet.
    void
    lock_directories(const bool make_results = false);

    // Checkpoints: source/restart.cc.

    /// Where the scene keeps its checkpoints.
    CheckpointStore
    checkpoints() const;

    /// Remove those of an earlier run, which go with its results.
    void
    begin_checkpoints();

    /// The checkpoint to go on from, if the run is to go on and there is one.
    std::optional<CheckpointManifest>
    find_checkpoint(const CommandLine::Restart restart);

    /// From a checkpoint: what begin() does, and all steps up to there.
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

    // Reporting: source/reporting.cc.

    void
    announce() const;

    void
    announce_mesh() const;

    /// Name the frictional boundaries without friction points, each once.
    void
    announce_held_faces();

    /// Name the linear solver if it is another one.
    void
    announce_solver();

    /// Add a row to statistics.csv. Time step 0 is the initial state.
    void
    record(const State<dim> &old_state,
           const Step       &step,
           const TimeStep   &time_step);

    /// Against the exact solution, or a reference at the ends of phases; not
    /// a number where there is none. Writes such a reference where wanted.
    SolutionErrors
    measure_errors(const State<dim> &of);

    /// Whether measure_errors() will give anything, now or later.
    bool
    measures_errors() const
    {
      return scene.exact_solution ||
             !parameters.exact_solution.reference_directory.empty();
    }

    /// Refuse missing references before the run.
    void
    check_references() const;

    void
    write_fields();

    /// Throws ExcMessage if the largest displacement, force or stress of the
    /// run is so large, or at its end so small, that squares of it, as energies
    /// are, mean nothing.
    void
    check_sizes() const;

    void
    close();

    const MPI_Comm                            communicator;
    const Parameters                         &parameters;
    Console                                  &console;
    ConditionalOStream                        out; // the console on rank 0
    Scene<dim>                                scene;
    parallel::distributed::Triangulation<dim> triangulation;
    const FESystem<dim>                       fe;
    DoFHandler<dim>                           dof_handler;
    std::unique_ptr<Discretisation>           discretisation;
    StepControl                               control;
    ContactSolver                             contact_solver;
    std::unique_ptr<ErrorBar<dim>>            error_bar; // null if not wanted

    State<dim>  state;
    Forces<dim> forces; // of the state
    /// At the state; in scenes with an error bar, that has it.
    std::optional<FlowRate> rate;
    ContactReport           initial_report;
    Accounts                accounts;
    Vector<double> squared_estimate; // eta_K^2, only in adaptive scenes
    /// Whether the state is a solution on the present mesh.
    bool is_solved_on_mesh = false;
    /// The linear solver, and the frictional boundaries without friction
    /// points, that the user has been told of.
    std::string                  announced_solver;
    std::set<types::boundary_id> announced_held_faces;
    /// Whether the user has been told that forces do not balance well.
    bool balance_is_doubtful = false;

    DirectoryLock                results_lock, checkpoint_lock; // on rank 0
    std::optional<Output<dim>>   output;     // absent without files
    std::unique_ptr<Statistics>  statistics; // on rank 0, with files
    std::vector<PointProbe<dim>> probes;
    Progress                     progress;
    RunSummary<dim>              summary;
    /// What compare_with() was given.
    std::optional<RunSummary<dim>> coarser_summary;
    /// Wall time by phase over the run, and what it was a step ago.
    TimerOutput                   timer;
    std::map<std::string, double> last_seconds;
    double                        first_set_up_seconds = 0.;
    Timer                         run_timer;
    /// Wall time of the run before its last restart, and at its last
    /// checkpoint.
    double earlier_seconds = 0., last_checkpoint = 0.;
  };
} // namespace Viscoplastic
