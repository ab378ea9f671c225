// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/fe/fe_q.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/compatibility.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/known_solution.h>
#include <viscoplastic_contact/error/solution_errors.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/run/announcer.h>
#include <viscoplastic_contact/run/plausibility.h>
#include <viscoplastic_contact/run/scene_check.h>
#include <viscoplastic_contact/time_stepping/explicit_step.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    void
    land_on_kinks(
      const Scene<dim>                                &scene,
      const parallel::distributed::Triangulation<dim> &triangulation,
      StepControl                                     &control,
      Console                                         *console)
    {
      control.land_on(scene.stage_ends, {});
      // Steps of given size use kinks only for the estimate of their error.
      if (!scene.parameters.step_control.land_on_kinks ||
          !(control.is_on || scene.parameters.error_control.error_estimator))
        return;
      const KinksOfScene found = kinks_of_scene(scene, triangulation);
      if (found.kinks.empty())
        return;
      if (console != nullptr && control.is_on)
        announce_kinks(found, *console);
      std::vector<double> kinks, jumps;
      for (const Kink &kink : found.kinks)
        (kink.is_jump ? jumps : kinks).push_back(kink.t);
      control.land_on(kinks, jumps);
    }



    /// Print the stability limit in cases without output of check_steps(): if
    /// the initial state is free of stress, or not yet in equilibrium.
    template <int dim>
    void
    announce_stability_limit(const Discretization<dim> &discretization,
                             const State<dim>          &initial,
                             std::ostream              &out)
    {
      const Scene<dim> &scene = discretization.scene();
      if (!scene.on_any_material([](const auto &material) {
            return material.law && !std::isfinite(material.added_at);
          }))
        return;
      const double rate =
        evaluate_flow(discretization.laws, initial, initial.t).relaxation_rate;
      if (rate == 0.)
        out << "Stability limit 2/r: none without stress; r grows with the "
               "stress, and a run says where it is largest\n";
      else if (scene.parameters.initial_state.equilibrate)
        {
          const TimeStep largest = scene.schedule.largest_step();
          out << "Stability limit 2/r before the initial state is brought into "
                 "equilibrium: "
              << 2. / rate << scene.unit(Quantity::time)
              << (scene.is_implicit() ? " of explicit schemes" : "")
              << "; the largest step is " << largest.k
              << scene.unit(Quantity::time) << '\n';
        }
    }



    /// Evaluate the data at later times: at ends of phases and about a hundred
    /// times between them, which include the ends of steps if there are fewer.
    /// Return the largest overlap of bodies and foundations in contact.
    template <int dim>
    double
    check_later_data(const Discretization<dim> &discretization)
    {
      double              overlap   = 0.;
      const TimeSchedule &schedule  = discretization.scene().schedule;
      const unsigned int  per_phase = std::max(1u, 100u / schedule.n_phases());
      DistributedVector   u         = discretization.space.owned_vector();
      double              t_old     = 0.;
      for (const TimeSchedule::Phase &phase : schedule.phases)
        {
          const unsigned int n_steps = std::min(phase.n_steps, per_phase),
                             n = n_steps * ((per_phase - 1) / n_steps + 1);
          for (unsigned int i = 1; i <= n; ++i)
            {
              const double t =
                i == n ? phase.end :
                         phase.start + (phase.end - phase.start) * i / n;
              discretization.loads.assemble(t);
              discretization.space.set_prescribed(t, u);
              discretization.laws.check(t);
              if (discretization.face)
                {
                  // Only friction coefficients: the state has no pressures.
                  std::vector<double> bounds = discretization.face->bounds(t);
                  for (const unsigned int o :
                       discretization.face->layout().obstacles())
                    overlap = std::max(overlap, -bounds[o]);
                  discretization.face->add_computed_bounds(t,
                                                           ContactState(),
                                                           bounds);
                  discretization.face->foundation_step(t_old, t);
                }
              t_old = t;
            }
        }
      return Utilities::MPI::max(overlap, discretization.space.communicator);
    }



    /// Print solver, number of steps and the expected memory of a run, which
    /// includes that of this process. Collective.
    template <int dim>
    void
    print_size(const Discretization<dim> &discretization, std::ostream &out)
    {
      const Scene<dim>      &scene       = discretization.scene();
      const DoFHandler<dim> &dof_handler = discretization.space.dof_handler;
      const SolverDemand     demand      = discretization.solver_demand();
      const BulkSolverKind   solver      = choose_bulk_solver(demand);
      const double           n_cells =
        dof_handler.get_triangulation().n_global_active_cells();
      const unsigned int n_ranks =
        Utilities::MPI::n_mpi_processes(dof_handler.get_communicator());
      Utilities::System::MemoryStats now;
      Utilities::System::get_memory_stats(now);
      const double bytes =
        Utilities::MPI::sum(1024. * static_cast<double>(now.VmRSS),
                            dof_handler.get_communicator()) +
        expected_memory(solver, demand) +
        (scene.is_implicit() || scene.is_implicit_beyond_the_limit() ?
           // A second matrix, and two rank-4 tensors per sample.
           dof_handler.n_dofs() * matrix_bytes(dim) +
             2. * sizeof(SymmetricTensor<4, 3>) *
               discretization.stress_space.n_samples * n_cells :
           0.) +
        // Copies of fields in single precision, written during the run.
        (n_ranks == 1 ? n_cells * GeometryInfo<dim>::vertices_per_cell * 140. :
                        0.);
      out << "Linear solver: "
          << (solver == BulkSolverKind::direct ?
                "direct (CHOLMOD)" :
                "conjugate gradients with " + to_string(solver))
          << "\nSteps: " << scene.schedule.n_steps()
          << " until t = " << scene.schedule.end_time()
          << scene.unit(Quantity::time) << "\nMemory: about "
          << std::ceil(bytes / 1e7) / 100. << " GB"
          << (scene.is_adaptive() ? " on the initial mesh" : "") << '\n';
    }
  } // namespace



  template <int dim>
  void
  make_first_mesh(Scene<dim>                                &scene,
                  parallel::distributed::Triangulation<dim> &triangulation,
                  StepControl                               &control,
                  Console                                   *console)
  {
    make_mesh(scene.parameters.geometry, triangulation);
    scene.inspect(triangulation);
    if (control.is_on && scene.has_viscosity() &&
        !scene.parameters.error_control.error_estimator)
      refuse("'Step control/Tolerance' needs an estimate of the error; set "
             "'Error control/Error bar' = true.");
    control.set_has_estimate(scene.has_viscosity());
    if (console != nullptr)
      announce_scene(scene, *console);
    land_on_kinks(scene, triangulation, control, console);
  }



  template <int dim>
  void
  check_stages(const FiniteElement<dim> &fe,
               DoFHandler<dim>          &dof_handler,
               Scene<dim>               &scene)
  {
    if (!scene.has_stages())
      return;
    distribute_nodes(fe, dof_handler);
    for (unsigned int n = 1; n <= scene.stage_ends.size(); ++n)
      {
        scene.enter_stage(n);
        const Discretization<dim> of_stage(dof_handler, scene);
      }
    scene.enter_stage(0);
  }



  template <int dim>
  void
  check_compatibility(const Discretization<dim> &discretization,
                      State<dim>                &initial,
                      const Load<dim>           &load)
  {
    constexpr double                  tolerance = 1e-6;
    const CompatibilityViolation<dim> violation =
      compatibility_violation(discretization.space,
                              load,
                              discretization.face.get(),
                              initial.u,
                              initial.contact);
    // Manufactured data are in equilibrium up to quadrature errors.
    const auto &solution = discretization.scene().exact_solution;
    if (solution && solution->makes_data)
      return;
    if (!(violation.relative <= tolerance))
      refuse("The initial data are not in equilibrium with the loads at t = "
             "0, (2.12): the relative violation is " +
             as_text(violation.relative) + ", more than " + as_text(tolerance) +
             "; it is largest " +
             (violation.is_axial ?
                "in 'Loads/Axial force'" :
                "at x = (" + as_text(violation.position) + "), " +
                  (violation.boundaries.empty() ?
                     "inside of the body" :
                     "on boundary " + list(violation.boundaries))) +
             "; start with loads that the initial stress balances, or set "
             "'Initial state/Equilibrate'.");
  }



  template <int dim>
  void
  check_steps(const Discretization<dim> &discretization,
              const StepControl         &control,
              Console                   &console,
              EvaluatedState<dim>       &initial)
  {
    const Scene<dim> &scene = discretization.scene();
    if (!scene.has_viscosity())
      return;
    initial.rate =
      evaluate_flow(discretization.laws, initial.state, initial.state.t);
    const double rate      = initial.rate->relaxation_rate;
    const bool   has_limit = !scene.is_implicit() &&
                           !scene.is_implicit_beyond_the_limit() &&
                           !control.needs_limit();
    if (has_limit)
      check_stability<dim>(scene.parameters,
                           *initial.rate,
                           scene.schedule.step(1));
    if (rate == 0.)
      return;
    const std::string time_unit = scene.unit(Quantity::time);
    console.stream() << "Stability limit 2/r of the initial state: "
                     << 2. / rate << time_unit
                     << (scene.is_implicit() ? " of explicit schemes\n" : "\n");
    if (!has_limit)
      return;
    const TimeStep largest = scene.schedule.largest_step();
    if (!is_stable(*initial.rate, largest.k))
      console.remark("Warning: the time step " + as_text(largest.k) +
                     time_unit + " of step " + std::to_string(largest.n) +
                     " (t = " + as_text(largest.t) + time_unit +
                     ") exceeds this limit; the run will end there unless the "
                     "limit has grown by then. Take more steps in "
                     "'Time/Phases', or set 'Time/Scheme' = backward Euler.");
  }


  template <int dim>
  void
  check_scene(const Parameters &parameters, Console &console)
  {
    std::ostream                             &out = console.stream();
    Scene<dim>                                scene(parameters);
    parallel::distributed::Triangulation<dim> triangulation(MPI_COMM_WORLD);
    const FESystem<dim>                       fe(FE_Q<dim>(1), dim);
    DoFHandler<dim>                           dof_handler(triangulation);
    const auto  budget = ErrorBudget::of_run(parameters);
    StepControl control(parameters, scene.schedule, budget.get());
    TimerOutput timer(out, TimerOutput::never, TimerOutput::wall_times);

    make_first_mesh(scene, triangulation, control, &console);
    check_stages(fe, dof_handler, scene);
    distribute_nodes(fe, dof_handler);
    const Discretization<dim> d(dof_handler, scene);
    announce_first_mesh(d, console);
    warn_of_held_faces(d, console);
    // This throws if output points, lines or integrals are wrong.
    Recorder<dim>(scene, control, console, timer, budget.get()).set_mesh(d);
    for (const std::string &doubt : implausible_data(d, out))
      console.remark("Warning: " + doubt);

    KnownSolution<dim>(scene, timer).check();
    if (scene.exact_solution && scene.exact_solution->makes_data)
      check_exact_solution(d.space);
    // Check the initial data, and the first step if these need no solution.
    const bool          equilibrate = parameters.initial_state.equilibrate;
    EvaluatedState<dim> initial;
    initial.state = make_initial_state(d.stress_space, equilibrate);
    if (!equilibrate)
      {
        check_compatibility(d, initial.state, d.loads.assemble(0.));
        check_steps(d, control, console, initial);
      }
    announce_stability_limit(d, initial.state, out);
    const double overlap = check_later_data(d),
                 size    = body_diagonal(triangulation);
    if (overlap > 0.05 * size)
      console.remark("Warning: bodies and foundations in contact overlap by " +
                     number(overlap) + scene.unit(Quantity::length) + ", " +
                     number(std::round(100. * overlap / size)) +
                     " % of the size of all; small strains are assumed.");
    print_size(d, out);
    out << "The scene is valid"
        << (console.remarks().empty() ? "." : ", with the remarks above.")
        << std::endl;
  }



  VISCOPLASTIC_INSTANTIATE(make_first_mesh);
  VISCOPLASTIC_INSTANTIATE(check_stages);
  VISCOPLASTIC_INSTANTIATE(check_compatibility);
  VISCOPLASTIC_INSTANTIATE(check_steps);
  VISCOPLASTIC_INSTANTIATE(check_scene);
} // namespace Viscoplastic
