// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/error/memory_loss.h>
#include <viscoplastic_contact/error/state_transfer.h>
#include <viscoplastic_contact/results/step_quantities.h>
#include <viscoplastic_contact/run/announcer.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

namespace Viscoplastic
{
  namespace
  {
    /// The density of the contact multipliers at nodes; empty without contact
    /// points.
    template <int dim>
    DistributedVector
    contact_density(const Discretization<dim> &discretization,
                    const State<dim>          &state)
    {
      return discretization.face ? discretization.face->density(state.contact) :
                                   DistributedVector();
    }



    /// Return the state with the thermal stress removed from z, since any mesh
    /// can evaluate that anew; nothing if there is none. Collective.
    template <int dim>
    std::optional<State<dim>>
    without_thermal_stress(const FlowLaws<dim> &laws, const State<dim> &state)
    {
      if (!laws.thermal || !laws.thermal->expands)
        return {};
      std::optional<State<dim>> result(state);
      laws.thermal->add_stress(state.t, -1., result->z);
      return result;
    }



    /// Let new points without a gap begin in contact; the active set opens them
    /// if their force is tensile.
    template <int dim>
    void
    hold_new_points(const Discretization<dim>          &discretization,
                    const std::set<types::material_id> &were_absent,
                    ContactState                       &contact)
    {
      if (were_absent.empty() || contact.n_points() == 0)
        return;
      std::set<types::global_dof_index> new_nodes;
      for (const auto &cell :
           discretization.space.dof_handler.active_cell_iterators())
        if (!cell->is_artificial() &&
            were_absent.count(cell->material_id()) == 1 &&
            discretization.scene().is_present(cell->material_id()))
          for (const unsigned int v : cell->vertex_indices())
            new_nodes.insert(cell->vertex_dof_index(v, 0));
      const ContactLayout &layout = discretization.face->layout();
      for (const unsigned int o : layout.obstacles())
        if (contact.gap(o) <= 0. &&
            new_nodes.count(
              discretization.face->first_dof(layout.points[o].node)) == 1)
          contact.sticks[o] = true;
    }
  } // namespace



  template <int dim>
  void
  ViscoplasticContact<dim>::change_mesh()
  {
    TimerOutput::Scope   phase(timer, "adaptation");
    const EnergiesOnMesh energies = energies_on_mesh(*discretization, accepted);
    const DistributedVector density =
      contact_density(*discretization, accepted.state);
    const std::optional<State<dim>> without_temperature =
      without_thermal_stress(discretization->laws, accepted.state);
    const State<dim> &carried =
      without_temperature ? *without_temperature : accepted.state;
    const double loss =
      error_estimator ?
        memory_loss(triangulation, discretization->stress_space, carried.z) :
        0.;
    StateTransfer<dim> transfer(triangulation,
                                discretization->stress_space,
                                carried,
                                discretization->face ? &density : nullptr);
    triangulation.execute_coarsening_and_refinement();
    set_up();

    State<dim> &state  = accepted.state;
    auto        result = transfer.unpack(discretization->stress_space);
    state              = std::move(result.state);
    if (without_temperature)
      for (IrreversibleStress *stress : {&state.z, &result.stress})
        discretization->laws.thermal->add_stress(state.t, 1., *stress);
    if (discretization->face)
      state.contact =
        contact_on_new_mesh(*discretization, state, result.multiplier_density);
    const bool keeps_displacement =
      scene.parameters.initial_state.reset_displacement &&
      state.initial_u.size() > 0;
    if (keeps_displacement)
      state.initial_u -= state.u;
    // The interpolated u does not fit the history with its new slopes. Each
    // round adds a share of the mismatch of E eps(u) + z = sigma to z, and
    // equilibrium, which keeps the volume, moves u again. Strains of a finer
    // mesh recur in each round, so that rounds end once little else is left.
    bool is_settled = !scene.has_viscosity() || scene.keeps_history_at_points();
    if (is_settled)
      time_stepper->settle(accepted);
    constexpr unsigned int max_rounds = 8;
    const double           error      = error_estimator ?
                                          accepted.errors.space :
                                          std::numeric_limits<double>::infinity();
    for (unsigned int round = 0; scene.has_viscosity() && round < max_rounds;
         ++round)
      {
        if (!share_mismatch(discretization->stress_space,
                            result.stress,
                            scene.parameters.error_control.algebraic_fraction,
                            error,
                            state) &&
            is_settled)
          break;
        time_stepper->settle(accepted);
        is_settled = true;
      }
    // What restoring equilibrium changes is part of the initial displacement.
    if (keeps_displacement)
      state.initial_u += state.u;
    complete_transfer(loss, result.of_refined_cells);
    recorder.record_change(energies,
                           energies_on_mesh(*discretization, accepted),
                           &EnergyBalance::adaptation_energy);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::enter_next_stage()
  {
    TimerOutput::Scope phase(timer, "adaptation");
    EnergiesOnMesh     energies = energies_on_mesh(*discretization, accepted);
    DistributedVector  density =
      contact_density(*discretization, accepted.state);
    std::vector<bool>            was_present; // by cell
    std::set<types::material_id> were_absent;
    for (const auto &cell : discretization->space.cells)
      was_present.push_back(scene.is_present(cell->material_id()));
    // Ghost cells are included, since they share nodes with owned ones.
    for (const auto &cell : dof_handler.active_cell_iterators())
      if (!cell->is_artificial() && !scene.is_present(cell->material_id()))
        were_absent.insert(cell->material_id());
    scene.enter_stage(scene.stage() + 1);
    set_up();

    const AdmissibleSpace<dim> &space = discretization->space;
    State<dim>                 &state = accepted.state;
    // The dofs coupled to a node on the primary side, thus ghosts, depend on
    // the stage.
    for (DistributedVector *const field : nodal_fields(state))
      if (field->size() > 0)
        space.renew_ghosts(*field);
    if (density.size() > 0)
      space.renew_ghosts(density);
    DistributedVector old_u = space.owned_vector();
    space.to_frames(state.u, old_u);
    if (scene.has_unilateral_contact() ||
        (discretization->face && scene.contact_changes_with_stages()))
      {
        state.contact = contact_on_new_mesh(*discretization, state, density);
        hold_new_points(*discretization, were_absent, state.contact);
      }
    Viscoplastic::enter_stage(discretization->stress_space, was_present, state);
    time_stepper->settle(accepted);
    complete_transfer(0., 0.);
    time_stepper->estimate(accepted);
    // Only loads that remain do work; those on removed parts do not.
    energies.of_loads = old_u * accepted.forces.load.values;
    recorder.record_change(energies,
                           energies_on_mesh(*discretization, accepted),
                           &EnergyBalance::construction_energy);
    announce_stage(scene, console);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::complete_transfer(const double loss,
                                              const double history)
  {
    accepted.rate.reset();
    if (error_estimator)
      error_estimator->change_mesh(
        discretization->space, discretization->matrix, loss, history, accepted);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(ViscoplasticContact, change_mesh);
  VISCOPLASTIC_INSTANTIATE_MEMBER(ViscoplasticContact, enter_next_stage);
} // namespace Viscoplastic
