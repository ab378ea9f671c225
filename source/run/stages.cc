// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

// How a run goes from one stage of construction to the next.

namespace Viscoplastic
{
  template <int dim>
  void
  ViscoplasticContact<dim>::check_stages()
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
  ViscoplasticContact<dim>::enter_next_stage()
  {
    TimerOutput::Scope phase(timer, "adaptation");
    State<dim>        &state  = accepted.state;
    EnergiesOnMesh     before = energies_on_mesh(*discretization, accepted);
    DistributedVector  u      = accepted.forces.u;
    std::vector<bool>  was_present;
    for (const auto &cell : discretization->space.cells)
      was_present.push_back(scene.is_present(cell->material_id()));
    DistributedVector density;
    const bool        opens = scene.has_unilateral_contact();
    if (opens)
      density = discretization->face->density(state.contact);
    scene.enter_stage(scene.stage() + 1);
    set_up();

    const Discretization<dim> &d = *discretization;
    if (opens)
      state.contact = contact_on_new_mesh(d, state, density);
    enter_stage(d.stress_space, was_present, state);
    time_stepper->settle(accepted);
    accepted.rate.reset();
    if (error_estimator)
      error_estimator->change_mesh(d.space, d.matrix, 0., 0., accepted);
    time_stepper->estimate(accepted);
    // The loads that are left do work; those on what is gone do not.
    before.of_loads = u * accepted.forces.load.values;
    recorder.record_stage(before, energies_on_mesh(d, accepted));
    announcer.announce_stage(scene);
  }



  template void
  ViscoplasticContact<2>::check_stages();
  template void
  ViscoplasticContact<3>::check_stages();
  template void
  ViscoplasticContact<2>::enter_next_stage();
  template void
  ViscoplasticContact<3>::enter_next_stage();
} // namespace Viscoplastic
