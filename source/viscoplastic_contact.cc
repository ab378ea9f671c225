// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_q.h>

#include <viscoplastic_contact/elasticity.h>
#include <viscoplastic_contact/error_estimator.h>
#include <viscoplastic_contact/initial_state.h>
#include <viscoplastic_contact/mesh.h>
#include <viscoplastic_contact/mesh_adaptation.h>
#include <viscoplastic_contact/messages.h>
#include <viscoplastic_contact/number_range.h>
#include <viscoplastic_contact/solution_errors.h>
#include <viscoplastic_contact/viscoplastic_contact.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    bool
    use_mean_dilatation(const Scene<dim> &scene, const double max_nu)
    {
      const std::string &choice =
        scene.parameters.stress.volumetric_integration;
      if (choice != "automatic")
        return choice == "mean dilatation";
      for (const auto &material : scene.materials)
        if (material->law && material->law->deviatoric_flow())
          return true;
      return max_nu > 0.4;
    }
  } // namespace



  template <int dim>
  ViscoplasticContact<dim>::Discretisation::Discretisation(
    const DoFHandler<dim> &dof_handler,
    const Scene<dim>      &scene)
    : space(dof_handler, scene)
    , moduli(space)
    , mean_dilatation(use_mean_dilatation(scene, moduli.max_poissons_ratio()))
    , sampling(space,
               moduli,
               scene.has_viscosity() &&
                 scene.parameters.stress.stress_history == "quadrature points",
               mean_dilatation)
    , laws(sampling)
    , loads(space)
    , n_solves(scene.is_adaptive() ? scene.parameters.refinement.every_n_steps :
                                     scene.schedule.n_steps())
  {
    for (const auto &pair : scene.boundary)
      if (pair.second.role == BoundaryRole::contact &&
          pair.second.is_bilateral() && !pair.second.is_glued())
        {
          tension = std::make_unique<ContactTension<dim>>(sampling);
          break;
        }
    if (scene.has_friction())
      face = std::make_unique<ContactFace<dim>>(space);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::Discretisation::make_matrix()
  {
    assemble_elastic_matrix(space, moduli, mean_dilatation, matrix);
    if (space.scene.has_viscosity() &&
        space.scene.parameters.time.scheme == "backward Euler")
      tangent = std::make_unique<TangentMatrix<dim>>(laws, matrix);
    else
      make_solver(matrix, moduli.max_poissons_ratio());
    const Parameters &parameters = space.scene.parameters;
    if (parameters.error_control.error_bar ||
        parameters.refinement.strategy == "residual")
      estimator = std::make_unique<ResidualEstimator<dim>>(sampling);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::Discretisation::make_solver(
    const DistributedMatrix &of,
    const double             max_nu)
  {
    static const std::vector<types::global_dof_index> no_dofs;
    diagonal = space.owned_vector();
    for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
      diagonal.begin()[i] = of.diag_element(space.owned.nth_index_in_set(i));
    const FrictionFace &layout = face ? face->layout() : no_face;
    const std::string  &choice = space.scene.parameters.solver.linear_solver;
    if (solver && is_direct(space, layout.n_dofs(), choice, max_nu, n_solves) &&
        solver->renew(of))
      return;
    solver.reset(); // factors are what fills memory
    solver = make_bulk_solver(space,
                              of,
                              layout,
                              face ? face->dofs() : no_dofs,
                              choice,
                              max_nu,
                              n_solves);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::Discretisation::use_solver_of_tangent(
    const bool of_tangent)
  {
    if (of_tangent == tangent_is_in_use)
      return;
    std::swap(solver, solver_aside);
    std::swap(diagonal, diagonal_aside);
    tangent_is_in_use = of_tangent;
  }



  template <int dim>
  ViscoplasticContact<dim>::ViscoplasticContact(const Parameters &parameters,
                                                Console          &console)
    : communicator(MPI_COMM_WORLD)
    , parameters(parameters)
    , console(console)
    , out(console.stream(), Utilities::MPI::this_mpi_process(communicator) == 0)
    , scene(parameters)
    // Always rebuilt from its coarse cells: then the order of cells, and with
    // it the rounding of sums, does not depend on the history of the mesh.
    , triangulation(communicator,
                    Triangulation<dim>::none,
                    parallel::distributed::Triangulation<
                      dim>::mesh_reconstruction_after_repartitioning)
    , fe(FE_Q<dim>(1), dim)
    , dof_handler(triangulation)
    , control(parameters.step_control,
              parameters.time.stiffness_policy,
              scene.schedule,
              parameters.time.scheme == "Heun" ? 2 : 1,
              parameters.output.fields_interval)
    , contact_solver(parameters.solver.maximal_iterations)
    , error_bar(parameters.error_control.error_bar ?
                  std::make_unique<ErrorBar<dim>>(scene) :
                  nullptr)
    , progress(console, scene.schedule.n_steps())
    , timer(out, TimerOutput::never, TimerOutput::wall_times)
  {}



  template <int dim>
  std::string
  ViscoplasticContact<dim>::run(const CommandLine::Restart restart)
  {
    make_mesh();
    check_references();
    lock_directories();
    if (const auto checkpoint = find_checkpoint(restart))
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
    while (!is_finished())
      {
        if (output->is_due(make_step()))
          write_fields();
        const std::string interruption = keep_checkpoints(signals);
        if (!interruption.empty())
          return interruption;
      }
    close();
    return "";
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::lock_directories(const bool make_results)
  {
    const std::string results = results_directory(parameters),
                      saved   = checkpoints().directory;
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      if (make_results)
        make_results_directory(results);
      results_lock.acquire(results);
      std::error_code none;
      if (!std::filesystem::equivalent(results, saved, none))
        checkpoint_lock.acquire(saved);
    });
  }



  template <int dim>
  RunSummary<dim>
  ViscoplasticContact<dim>::run_without_files()
  {
    make_mesh();
    set_up();
    set_initial_state();
    check_steps();
    record_initial_state();
    while (!is_finished())
      make_step();
    check_sizes();
    return summary;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::compare_with(const RunSummary<dim> &coarser)
  {
    coarser_summary = coarser;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::begin()
  {
    set_up();
    if (scene.exact_solution && scene.exact_solution->makes_data)
      check_exact_solution(discretisation->space);
    set_initial_state();
    check_steps();
    lock_directories(/* make_results = */ true);
    output.emplace(scene, communicator);
    begin_checkpoints();
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      statistics =
        std::make_unique<Statistics>(output->directory() + "statistics.csv");
    record_initial_state();
    write_fields();
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::record_initial_state()
  {
    Step initial{state,
                 forces,
                 initial_report,
                 {},
                 std::numeric_limits<double>::infinity(),
                 {},
                 0.,
                 {},
                 error_bar ? error_bar->ledger() : ErrorLedger()};
    record(state, initial, {0, 0., 0., 0.});
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::make_mesh()
  {
    Viscoplastic::make_mesh(parameters.geometry, triangulation);
    scene.inspect(triangulation);
    AssertThrow(!control.is_on || !scene.has_viscosity() || error_bar,
                ExcMessage("'Step control/Tolerance' needs an estimate of the "
                           "error; set 'Error control/Error bar' = true."));
    control.set_has_estimate(scene.has_viscosity());
    announce();
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::set_up()
  {
    TimerOutput::Scope scope(timer, "set-up");
    dof_handler.distribute_dofs(fe);
    // The old one goes first: matrices and factors are what fills memory.
    is_solved_on_mesh = false;
    discretisation.reset();
    discretisation = std::make_unique<Discretisation>(dof_handler, scene);
    discretisation->make_matrix();
    if (forces.u.size() == 0) // the first time
      announce_mesh();
    announce_held_faces();
    announce_solver();
    probes.clear();
    for (const Point<dim> &x : scene.output_points)
      probes.emplace_back(discretisation->space, x);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::set_initial_state()
  {
    const Discretisation         &d       = *discretisation;
    const InitialStateParameters &initial = parameters.initial_state;
    state = make_initial_state(d.sampling, initial.equilibrate);
    if (error_bar)
      error_bar->begin(d.sampling, state);
    const Load<dim>           load = d.loads.assemble(0.);
    const std::vector<double> bounds =
      d.face ? d.face->bounds(0.) : std::vector<double>();
    if (initial.equilibrate)
      {
        const State<dim> start = state;
        forces = evaluate_forces(d.sampling, d.matrix, load, start);
        if (d.face)
          state.friction = FrictionState(bounds.size());
        if (!d.solver)
          discretisation->make_solver(d.matrix, d.moduli.max_poissons_ratio());
        initial_report  = solve(start, forces, load, bounds, {}, state);
        state.initial_u = state.u;
      }
    else
      {
        check_compatibility(load);
      }
    forces = evaluate_forces(d.sampling, d.matrix, load, state);
    if (scene.is_adaptive() || initial.equilibrate)
      {
        const double residual = estimate(state);
        if (error_bar && initial.equilibrate)
          error_bar->assess_equilibrium(forces, initial_report, residual);
      }
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::check_compatibility(const Load<dim> &load)
  {
    const Discretisation &d = *discretisation;
    const double tolerance  = parameters.initial_state.compatibility_tolerance;
    const double violation =
      compatibility_violation(d.space, load, d.face.get(), state.friction);
    // Data that a solution makes are compatible up to quadrature.
    if (scene.exact_solution && scene.exact_solution->makes_data)
      return;
    std::ostringstream message;
    message << "The initial data are not in equilibrium with the loads at "
               "t = 0, (2.12): the relative violation is "
            << violation << ", and 'Initial state/Compatibility tolerance' is "
            << tolerance
            << "; start with loads that the initial stress balances, or set "
               "'Initial state/Equilibrate'.";
    AssertThrow(violation <= tolerance, ExcMessage(message.str()));
  }



  template <int dim>
  double
  ViscoplasticContact<dim>::estimate(const State<dim> &of)
  {
    const Discretisation &d = *discretisation;
    TimerOutput::Scope    phase(timer, "estimate");
    if (parameters.refinement.strategy == "kelly")
      squared_estimate = kelly_estimate(d.space, of.u);
    if (!d.estimator)
      return 0.;
    DistributedVector density;
    if (d.face)
      density = d.face->density(of.friction);
    const Vector<double> residual =
      d.estimator->estimate(of.u, of.z, of.t, d.face ? &density : nullptr);
    if (parameters.refinement.strategy == "residual")
      squared_estimate = residual;
    return total_estimate(residual, communicator);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::adapt_mesh()
  {
    TimerOutput::Scope phase(timer, "adaptation");
    // What rounding and iterations leave of an estimate, as in uniform states,
    // says nothing about the mesh, and differs between numbers of ranks.
    if (parameters.refinement.strategy == "residual" &&
        total_estimate(squared_estimate, communicator) <=
          10. * std::max(1e-10, step_tolerance()) *
            std::sqrt(2. * std::max(0., forces.strain_energy)))
      return;
    if (!mark_cells(triangulation, squared_estimate, parameters.refinement))
      return;

    DistributedVector density;
    if (discretisation->face)
      density = discretisation->face->density(state.friction);
    const double       energy = stored_energy(state, forces);
    StateTransfer<dim> transfer(triangulation,
                                discretisation->sampling,
                                state,
                                discretisation->face ? &density : nullptr);
    triangulation.execute_coarsening_and_refinement();
    set_up();

    const Discretisation &d      = *discretisation;
    auto                  result = transfer.unpack(d.sampling);
    state                        = std::move(result.state);
    if (d.face)
      {
        // Sets by what the multipliers and velocities say.
        const std::vector<double> bounds = d.face->bounds(state.t);
        state.friction                   = FrictionState(bounds.size());
        state.friction.multiplier =
          d.face->multipliers(result.multiplier_density);
        DistributedVector velocity = d.space.owned_vector();
        d.space.to_frames(state.velocity, velocity);
        Vector<double> carried =
          d.face->foundation_step(state.t - state.k, state.t);
        if (carried.size() > 0)
          carried /= state.k;
        const auto   slip_rates = d.face->slips(velocity, carried);
        const double max_speed  = velocity.linfty_norm();
        for (unsigned int p = 0; p < bounds.size(); ++p)
          {
            auto        &multiplier = state.friction.multiplier[p];
            const double size       = stable_norm(multiplier);
            if (size > bounds[p])
              multiplier *= bounds[p] / size;
            state.friction.sticks[p] =
              size < (1. - 1e-6) * bounds[p] ||
              stable_norm(slip_rates[p]) <= 1e-12 * max_speed;
          }
      }
    forces =
      evaluate_forces(d.sampling, d.matrix, d.loads.assemble(state.t), state);
    rate.reset();
    if (error_bar)
      error_bar->change_mesh(d.space, d.matrix, state);
    accounts.adaptation_energy += stored_energy(state, forces) - energy;
  }



  template <int dim>
  double
  ViscoplasticContact<dim>::stored_energy(const State<dim>  &of,
                                          const Forces<dim> &its_forces) const
  {
    // 1/2 int E^-1 sigma : sigma with sigma = E eps(u) + z.
    return its_forces.strain_energy + its_forces.irreversible_work +
           summarise_stress(discretisation->laws, of, of).irreversible_energy;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::write_fields()
  {
    TimerOutput::Scope             phase(timer, "output");
    const std::vector<std::string> remarks =
      output->write_fields(discretisation->sampling,
                           state,
                           discretisation->face.get(),
                           squared_estimate.size() > 0 ? &squared_estimate :
                                                         nullptr);
    for (const std::string &remark : remarks)
      console.remark(remark);
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
