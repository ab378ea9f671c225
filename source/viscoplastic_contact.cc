// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_q.h>

#include <viscoplastic_contact/elasticity.h>
#include <viscoplastic_contact/error_estimator.h>
#include <viscoplastic_contact/initial_state.h>
#include <viscoplastic_contact/mesh_adaptation.h>
#include <viscoplastic_contact/viscoplastic_contact.h>

#include <iostream>
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
        scene.parameters.material.volumetric_integration;
      if (choice == "automatic")
        return (scene.law && scene.law->deviatoric_flow()) || max_nu > 0.4;
      return choice == "mean dilatation";
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
                 scene.parameters.material.stress_history ==
                   "quadrature points",
               mean_dilatation)
    , loads(space)
  {
    assemble_elastic_matrix(space, moduli, mean_dilatation, matrix);
    if (scene.has_friction())
      face = std::make_unique<ContactFace<dim>>(space);
    static const std::vector<types::global_dof_index> no_dofs;
    const unsigned int n_solves = scene.is_adaptive() ?
                                    scene.parameters.refinement.every_n_steps :
                                    scene.schedule.n_steps();
    solver                      = make_bulk_solver(space,
                              matrix,
                              face ? face->layout() : no_face,
                              face ? face->dofs() : no_dofs,
                              scene.parameters.solver.linear_solver,
                              moduli.max_poissons_ratio(),
                              n_solves);
  }



  template <int dim>
  ViscoplasticContact<dim>::ViscoplasticContact(const Parameters &parameters)
    : communicator(MPI_COMM_WORLD)
    , parameters(parameters)
    , out(std::cout, Utilities::MPI::this_mpi_process(communicator) == 0)
    , scene(parameters)
    , triangulation(communicator)
    , fe(FE_Q<dim>(1), dim)
    , dof_handler(triangulation)
    , contact_solver(parameters.solver.contact_tolerance,
                     parameters.solver.maximal_iterations)
    , timer(out, TimerOutput::never, TimerOutput::wall_times)
  {}



  template <int dim>
  void
  ViscoplasticContact<dim>::run()
  {
    announce();
    scene.make_mesh(triangulation);
    scene.inspect_boundary(triangulation);
    set_up();
    set_initial_state();
    output.emplace(scene, communicator);
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      statistics =
        std::make_unique<Statistics>(output->directory() + "statistics.csv");
    Step initial{state,
                 forces,
                 initial_report,
                 {},
                 std::numeric_limits<double>::infinity()};
    record(state, initial, {0, 0., 0., 0.});
    write_fields();

    for (unsigned int n = 1; n <= scene.schedule.n_steps(); ++n)
      {
        const TimeStep time_step = scene.schedule.step(n);
        Step           step      = advance(state, forces, time_step);
        if (scene.is_adaptive())
          estimate(step.state);
        record(state, step, time_step);
        state  = std::move(step.state);
        forces = std::move(step.forces);
        if (output->is_due(time_step))
          write_fields();
        if (scene.is_adaptive() && n < scene.schedule.n_steps() &&
            n % parameters.refinement.every_n_steps == 0)
          adapt_mesh();
      }
    close();
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
    if (forces.u.size() == 0) // the first time
      out << "Mesh: " << triangulation.n_global_active_cells() << " cells, "
          << dof_handler.n_dofs() << " degrees of freedom"
          << (discretisation->face ?
                ", " +
                  std::to_string(discretisation->face->layout().points.size()) +
                  " friction points" :
                "")
          << (discretisation->mean_dilatation ? ", mean dilatation" : "")
          << "\nLinear solver: " << discretisation->solver->name() << std::endl;
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
    const Load<dim>           load = d.loads.assemble(0.);
    const std::vector<double> bounds =
      d.face ? d.face->bounds(0.) : std::vector<double>();
    if (initial.equilibrate)
      {
        const State<dim> start = state;
        forces = evaluate_forces(d.sampling, d.matrix, load, start);
        if (d.face)
          state.friction = FrictionState(bounds.size());
        initial_report  = solve(start, forces, 0., 0., load, bounds, state);
        state.initial_u = state.u;
      }
    else
      {
        const double violation =
          compatibility_violation(d.space, load, d.face.get(), state.friction);
        std::ostringstream message;
        message << "The initial data are not in equilibrium with the loads at "
                   "t = 0, (2.12): the relative violation is "
                << violation << ", and "
                << "'Initial state/Compatibility tolerance' is "
                << initial.compatibility_tolerance
                << "; start with loads that the initial stress balances, or "
                   "set 'Initial state/Equilibrate'.";
        AssertThrow(violation <= initial.compatibility_tolerance,
                    ExcMessage(message.str()));
      }
    forces = evaluate_forces(d.sampling, d.matrix, load, state);
    if (scene.is_adaptive())
      estimate(state);
  }



  template <int dim>
  typename ViscoplasticContact<dim>::Step
  ViscoplasticContact<dim>::advance(const State<dim>  &old_state,
                                    const Forces<dim> &old_forces,
                                    const TimeStep    &time_step)
  {
    const Discretisation &d = *discretisation;
    Step                  step;
    step.step_limit      = std::numeric_limits<double>::infinity();
    step.state.n         = time_step.n;
    step.state.t         = time_step.t;
    step.state.initial_u = old_state.initial_u;
    {
      TimerOutput::Scope phase(timer, "rate");
      step.state.z = old_state.z;
      if (scene.has_viscosity())
        {
          FlowStep<dim> flow = advance_irreversible_stress(d.sampling,
                                                           *scene.law,
                                                           old_state.u,
                                                           old_state.z,
                                                           time_step.t_old,
                                                           time_step.k);
          step.state.z       = std::move(flow.z);
          if (flow.relaxation_rate > 0.)
            step.step_limit = 2. / flow.relaxation_rate;
        }
    }
    if (time_step.k > step.step_limit * (1. + 1e-10))
      {
        std::ostringstream message;
        message << "The time step " << time_step.k << " of step " << time_step.n
                << " (t = " << time_step.t
                << ") exceeds the stability limit 2/r = " << step.step_limit
                << " of forward Euler for the law " << parameters.material.law
                << "; take more steps in 'Time/Phases'.";
        AssertThrow(false, ExcMessage(message.str()));
      }

    Load<dim> load;
    {
      TimerOutput::Scope phase(timer, "load");
      load = d.loads.assemble(time_step.t);
      if (d.face)
        step.bounds = d.face->bounds(time_step.t);
    }
    {
      TimerOutput::Scope phase(timer, "contact");
      step.report = solve(old_state,
                          old_forces,
                          time_step.t,
                          time_step.k,
                          load,
                          step.bounds,
                          step.state);
    }
    TimerOutput::Scope phase(timer, "balance");
    step.forces =
      evaluate_forces(d.sampling, d.matrix, std::move(load), step.state);
    return step;
  }



  template <int dim>
  ContactReport
  ViscoplasticContact<dim>::solve(const State<dim>          &old_state,
                                  const Forces<dim>         &old_forces,
                                  const double               t,
                                  const double               k,
                                  const Load<dim>           &load,
                                  const std::vector<double> &bounds,
                                  State<dim>                &new_state)
  {
    Discretisation             &d     = *discretisation;
    const AdmissibleSpace<dim> &space = d.space;
    DistributedVector           right_side(load.values);
    if (scene.has_irreversible_stress()) // collective, also without cells
      add_irreversible_load(d.sampling, new_state.z, right_side);

    // Start from the last displacement, moved on by the last velocity except
    // where points stick.
    const DistributedVector &old_u = old_forces.u;
    DistributedVector        u(old_u), velocity(old_u);
    space.to_frames(old_state.velocity, velocity);
    u.add(k, velocity);
    if (d.face)
      {
        const FrictionFace &face = d.face->layout();
        new_state.friction       = old_state.friction;
        if (new_state.friction.sticks.size() != face.points.size())
          new_state.friction = FrictionState(face.points.size());
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          if (new_state.friction.sticks[face.first_point[node]])
            for (unsigned int i = face.first_dof[node];
                 i < face.first_dof[node + 1];
                 ++i)
              if (space.owned.is_element(d.face->dofs()[i]))
                {
                  const auto local =
                    space.owned.index_within_set(d.face->dofs()[i]);
                  u.begin()[local] = old_u.begin()[local];
                }
      }
    space.set_prescribed(t, u);

    ContactReport report;
    if (d.face)
      {
        DistributedVector change(u);
        change -= old_u;
        Vector<double> increment = d.face->face_vector(change);
        d.solver->begin(right_side, u);
        report = contact_solver.solve(
          *d.solver, d.face->layout(), bounds, increment, new_state.friction);
      }
    else
      {
        // An elastic body whose data have not changed does not move.
        if (!scene.has_viscosity() && is_solved_on_mesh)
          {
            DistributedVector displacement_change(old_u);
            space.set_prescribed(t, displacement_change);
            displacement_change -= old_u;
            DistributedVector load_change(load.values);
            load_change -= old_forces.load.values;
            if (displacement_change.linfty_norm() == 0. &&
                load_change.linfty_norm() == 0.)
              {
                new_state.u        = old_state.u;
                new_state.velocity = space.ghosted_vector();
                return report;
              }
          }
        report.linear_iterations =
          d.solver->solve(right_side, u, parameters.solver.contact_tolerance);
      }

    new_state.u        = space.ghosted_vector();
    new_state.velocity = space.ghosted_vector();
    space.to_cartesian(u, new_state.u);
    if (k > 0.)
      {
        u -= old_u;
        u /= k;
        space.to_cartesian(u, new_state.velocity);
      }
    is_solved_on_mesh = true;
    return report;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::estimate(const State<dim> &of)
  {
    const Discretisation &d = *discretisation;
    TimerOutput::Scope    phase(timer, "estimate");
    if (parameters.refinement.strategy == "kelly")
      {
        squared_estimate = kelly_estimate(d.space, of.u);
        return;
      }
    DistributedVector density;
    if (d.face)
      density = d.face->density(of.friction);
    squared_estimate = residual_estimate(
      d.sampling, of.u, of.z, of.t, d.face ? &density : nullptr);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::adapt_mesh()
  {
    TimerOutput::Scope phase(timer, "adaptation");
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
        const auto slip_rates = d.face->slips(velocity);
        for (unsigned int p = 0; p < bounds.size(); ++p)
          {
            auto        &multiplier = state.friction.multiplier[p];
            const double size       = multiplier.norm();
            if (size > bounds[p])
              multiplier *= bounds[p] / size;
            state.friction.sticks[p] =
              size < (1. - 1e-6) * bounds[p] || slip_rates[p].norm() == 0.;
          }
      }
    forces =
      evaluate_forces(d.sampling, d.matrix, d.loads.assemble(state.t), state);
    accounts.adaptation_energy += stored_energy(state, forces) - energy;
  }



  template <int dim>
  double
  ViscoplasticContact<dim>::stored_energy(const State<dim>  &of,
                                          const Forces<dim> &its_forces) const
  {
    // 1/2 int E^-1 sigma : sigma with sigma = E eps(u) + z.
    return its_forces.strain_energy + its_forces.irreversible_work +
           summarise_stress(discretisation->sampling, of, of)
             .irreversible_energy;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::write_fields()
  {
    TimerOutput::Scope phase(timer, "output");
    output->write_fields(discretisation->sampling,
                         state,
                         discretisation->face.get(),
                         squared_estimate.size() > 0 ? &squared_estimate :
                                                       nullptr);
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
