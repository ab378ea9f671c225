// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/solution_errors.h>
#include <viscoplastic_contact/linear_solvers/solver_choice.h>
#include <viscoplastic_contact/run/plausibility.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>
#include <viscoplastic_contact/time_stepping/explicit_step.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  template <int dim>
  void
  ViscoplasticContact<dim>::check_steps()
  {
    if (!scene.has_viscosity())
      return;
    const State<dim> &state = accepted.state;
    accepted.rate =
      evaluate_flow(discretization->laws, state.u, state.z, state.t);
    const FlowRate &initial   = *accepted.rate;
    const double    rate      = initial.relaxation_rate;
    const bool      has_limit = !scene.is_implicit() &&
                           !scene.is_implicit_beyond_the_limit() &&
                           !control.needs_limit();
    if (has_limit)
      check_stability<dim>(parameters, initial, scene.schedule.step(1));
    if (rate == 0.)
      return;
    const std::string time_unit = parameters.units.suffix(Quantity::time, dim);
    out << "Stability limit 2/r of the initial state: " << 2. / rate
        << time_unit << (scene.is_implicit() ? " of explicit schemes\n" : "\n");
    if (!has_limit)
      return;
    const TimeStep largest = scene.schedule.largest_step();
    if (!is_stable(initial, largest.k))
      {
        std::ostringstream message;
        message << "Warning: the time step " << largest.k << time_unit
                << " of step " << largest.n << " (t = " << largest.t
                << time_unit
                << ") exceeds this limit; the run will end there unless the "
                   "limit has grown by then. Take more steps in "
                   "'Time/Phases', or set 'Time/Scheme' = backward Euler.";
        console.remark(message.str());
      }
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::announce_stability_limit()
  {
    if (std::none_of(scene.materials.begin(),
                     scene.materials.end(),
                     [](const auto &material) {
                       return material->law != nullptr;
                     }))
      return;
    const State<dim> &state = accepted.state;
    const double      rate =
      evaluate_flow(discretization->laws, state.u, state.z, state.t)
        .relaxation_rate;
    if (rate == 0.)
      out << "Stability limit 2/r: none without stress; r grows with the "
             "stress, and a run says where it is largest\n";
    else if (parameters.initial_state.equilibrate)
      {
        const TimeStep largest = scene.schedule.largest_step();
        out << "Stability limit 2/r before the initial state is brought into "
               "equilibrium: "
            << 2. / rate << parameters.units.suffix(Quantity::time, dim)
            << (scene.is_implicit() ? " of explicit schemes" : "")
            << "; the largest step is " << largest.k
            << parameters.units.suffix(Quantity::time, dim) << '\n';
      }
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::check()
  {
    make_mesh();
    check_stages();
    distribute_nodes(fe, dof_handler);
    discretization = std::make_unique<Discretization<dim>>(dof_handler, scene);
    const Discretization<dim> &d = *discretization;
    announcer.announce(d);
    announcer.warn_of_held_faces(d);
    recorder.set_mesh(d);
    const LargestStress largest_stress = largest_given_stress(d);
    describe_materials(d, largest_stress, out);
    for (const std::string &doubt : implausible_data(d, largest_stress))
      console.remark("Warning: " + doubt);

    known_solution.check();
    if (scene.exact_solution && scene.exact_solution->makes_data)
      check_exact_solution(d.space);
    // The initial data, and where they need no solution, the first step.
    accepted.state =
      make_initial_state(d.stress_space, parameters.initial_state.equilibrate);
    // Equilibrium at t = 0 would need a solution.
    if (!parameters.initial_state.equilibrate)
      {
        check_compatibility(d.loads.assemble(0.));
        check_steps();
      }
    announce_stability_limit();
    const unsigned int n_steps = scene.schedule.n_steps();

    // The data of later times, of at most a hundred steps.
    const unsigned int stride = (n_steps + 99) / 100;
    DistributedVector  u      = d.space.owned_vector();
    for (unsigned int i = 1; i < n_steps + stride; i += stride)
      {
        const TimeStep step = scene.schedule.step(std::min(i, n_steps));
        d.loads.assemble(step.t);
        d.space.set_prescribed(step.t, u);
        d.laws.check(step.t);
        if (d.face)
          {
            d.face->bounds(step.t);
            d.face->foundation_step(step.t_old, step.t);
          }
      }

    const SolverDemand             demand = d.solver_demand();
    const BulkSolverKind           solver = choose_bulk_solver(demand);
    Utilities::System::MemoryStats now;
    Utilities::System::get_memory_stats(now);
    const double bytes =
      Utilities::MPI::sum(1024. * static_cast<double>(now.VmRSS),
                          communicator) +
      expected_memory(solver, demand) +
      (scene.is_implicit() || scene.is_implicit_beyond_the_limit() ?
         // A second matrix, and two tensors of rank 4 a sample.
         dof_handler.n_dofs() * (dim == 2 ? 18. : 81.) * 12. +
           2. * sizeof(SymmetricTensor<4, 3>) * d.stress_space.n_samples *
             triangulation.n_global_active_cells() :
         0.);
    out << "Linear solver: "
        << (solver == BulkSolverKind::direct ?
              "direct (CHOLMOD)" :
              "conjugate gradients with " + to_string(solver))
        << "\nSteps: " << n_steps << " until t = " << scene.schedule.end_time()
        << parameters.units.suffix(Quantity::time, dim) << "\nMemory: about "
        << std::ceil(bytes / 1e7) / 100. << " GB"
        << (scene.is_adaptive() ? " on the initial mesh" : "")
        << "\nThe scene is valid"
        << (console.remarks().empty() ? "." : ", with the remarks above.")
        << std::endl;
  }



  template void
  ViscoplasticContact<2>::check();
  template void
  ViscoplasticContact<3>::check();
} // namespace Viscoplastic
