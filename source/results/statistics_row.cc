// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/results/run_summary.h>
#include <viscoplastic_contact/results/unit_labels.h>

// Makes the row of statistics.csv; doc/results.md explains the columns.

namespace Viscoplastic
{
  namespace
  {
    /// Displacements at `Output/Points' are printed at the end for at most this
    /// number of points.
    constexpr std::size_t most_printed = 4;



    void
    add_errors(const SolutionErrors &errors, TableRow &row)
    {
      const auto add = [&row](const std::string   &prefix,
                              const SolutionNorms &norms) {
        row.add(prefix + "energy", norms.energy, Quantity::energy_norm);
        row.add(prefix + "h1", norms.h1);
        row.add(prefix + "stress", norms.stress);
        row.add(prefix + "multiplier", norms.multiplier);
      };
      add("error_", errors.error);
      row.add("error_memory", errors.memory, Quantity::energy_norm);
      row.add("estimate_recovery", errors.recovery, Quantity::energy_norm);
      add("exact_", errors.exact);
    }



    template <int dim>
    void
    add_estimates(const Scene<dim>    &scene,
                  const ErrorEstimate &estimate,
                  TableRow            &row)
    {
      row.add("energy_norm", estimate.energy_norm, Quantity::energy_norm);
      row.add("estimate_space", estimate.space, Quantity::energy_norm);
      row.add("estimate_time", estimate.time, Quantity::energy_norm);
      if (scene.has_viscosity() &&
          (scene.is_adaptive() || !scene.keeps_history_at_points() ||
           scene.parameters.stress.volumetric_integration ==
             VolumetricIntegration::full))
        row.add("estimate_history", estimate.history, Quantity::energy_norm);
      if (scene.has_friction())
        row.add("estimate_friction", estimate.friction, Quantity::energy_norm);
      if (scene.is_adaptive() && scene.has_irreversible_stress())
        row.add("estimate_transfer", estimate.transfer, Quantity::energy_norm);
      row.add("estimate_algebraic", estimate.algebraic, Quantity::energy_norm);
      row.add("estimate_initial", estimate.initial, Quantity::energy_norm);
      row.add("estimate_total", estimate.total(), Quantity::energy_norm);
      if (scene.quantity)
        {
          const QuantityEstimate &quantity = estimate.quantity;
          const Quantity          unit     = scene.quantity->unit();
          row.add("quantity_correction",
                  quantity.space_correction + quantity.time_correction,
                  unit);
          row.add("quantity_space", quantity.space, unit);
          row.add("quantity_time", quantity.time, unit);
          row.add("quantity_other",
                  quantity.total() - quantity.space - quantity.time,
                  unit);
          row.add("quantity_total", quantity.total(), unit);
        }
      row.add("time_indicator", estimate.time_indicator, Quantity::energy_norm);
      row.add("velocity_variation",
              estimate.velocity_variation,
              Quantity::rate_norm);
    }



    /// Add the columns of contact and friction.
    template <int dim>
    void
    add_contact(const Scene<dim>          &scene,
                const ContactFace<dim>    &face,
                const AcceptedStep<dim>   &step,
                const StepQuantities<dim> &quantities,
                TableRow                  &row)
    {
      const FrictionIdentities &friction  = quantities.friction;
      const auto                add_force = [&row](const std::string &name,
                                    const auto        &force,
                                    const bool         is_printed) {
        row.add_vector(name, force, dim, Quantity::force, is_printed);
      };
      row.add("duality_gap", step.report.duality_gap, Quantity::energy);
      row.add("algebraic_error", step.report.relative_error);
      row.add("stick_area", friction.stick_area, Quantity::area);
      row.add("slip_area", friction.slip_area, Quantity::area);
      add_force("friction_force",
                quantities.friction_force,
                scene.has_friction());
      if (face.has_obstacles())
        {
          const NormalContact<dim> &contact = quantities.contact;
          add_force("contact_force", contact.force, row.printed);
          row.add("contact_area",
                  contact.contact_area,
                  Quantity::area,
                  row.printed);
          row.add("max_pressure", contact.max_pressure, Quantity::stress);
          row.add("max_gap", contact.max_gap, Quantity::length);
          if (face.has_normal_compliance())
            row.add("max_penetration",
                    contact.max_penetration,
                    Quantity::length);
          if (face.has_computed_pressure() &&
              scene.parameters.solver.coulomb_pressure !=
                CoulombPressure::lagged)
            {
              row.add("bound_iterations", step.report.bound_iterations);
              row.add("contraction", step.report.contraction);
            }
          else if (face.has_computed_pressure())
            row.add("bound_lag",
                    quantities.friction_bounds.sum > 0. ?
                      quantities.friction_bounds.missed /
                        quantities.friction_bounds.sum :
                      0.);
        }
      for (const auto &[id, forces] : quantities.contact_forces)
        {
          const BoundaryCondition<dim> &condition = scene.boundary.at(id);
          if (condition.has_friction())
            add_force("friction_force_" + std::to_string(id),
                      forces.friction,
                      row.printed);
          if (condition.is_unilateral())
            add_force("contact_force_" + std::to_string(id),
                      forces.contact,
                      row.printed);
        }
    }



    template <int dim>
    void
    add_energies(const Discretization<dim> &d,
                 const Forces<dim>         &forces,
                 const StepQuantities<dim> &quantities,
                 const EnergyBalance       &balance,
                 TableRow                  &row)
    {
      const Scene<dim> &scene      = d.scene();
      const auto        add_energy = [&row](const std::string &name,
                                     const double       energy) {
        row.add(name, energy, Quantity::energy, row.printed);
      };
      add_energy("stored_energy", balance.stored_energy);
      row.add("strain_energy",
              forces.strain_energy - quantities.spring_energy,
              Quantity::energy);
      if (d.springs)
        row.add("spring_energy", quantities.spring_energy, Quantity::energy);
      if (scene.has_viscosity())
        add_energy("viscous_dissipation", balance.viscous_dissipation);
      if (d.face)
        row.add("friction_dissipation",
                balance.friction_dissipation,
                Quantity::energy,
                scene.has_friction());
      add_energy("external_work", balance.external_work);
      if (scene.has_thermal_strain())
        add_energy("thermal_work", balance.thermal_work);
      if (scene.is_adaptive())
        add_energy("adaptation_energy", balance.adaptation_energy);
      if (scene.has_stages())
        add_energy("construction_energy", balance.construction_energy);
      add_energy("energy_balance_defect", balance.defect());
    }
  } // namespace



  template <int dim>
  TableRow
  Recorder<dim>::row(const AcceptedStep<dim>   &step,
                     const StepQuantities<dim> &quantities,
                     const SolutionErrors      &errors)
  {
    const Discretization<dim> &d         = *discretization;
    const TimeStep            &time_step = step.time_step;
    const StressSummary<dim>  &stress    = quantities.stress;
    const FrictionIdentities  &friction  = quantities.friction;
    const Forces<dim>         &forces    = step.end.forces;
    TableRow                   row;
    row.add("step", time_step.n);
    row.add("t", time_step.t, Quantity::time);
    row.add("k", time_step.k, Quantity::time);
    row.add("cells",
            d.space.dof_handler.get_triangulation().n_global_active_cells());
    row.add("dofs", d.space.dof_handler.n_dofs());
    if (scene.has_viscosity())
      {
        row.add("step_limit", step.step_limit, Quantity::time);
        row.add("k_r", step.stiffness());
        row.add_vector("critical_cell",
                       step.critical_position,
                       dim,
                       Quantity::length);
      }
    if (control.may_reject())
      row.add("rejected", step.n_rejections);
    if (d.tension)
      row.add("tension_area", quantities.tension_area, Quantity::area);
    if (d.laws.any_cap)
      row.add("capped_volume", step.capped_volume, Quantity::volume);
    if (may_be_implicit())
      row.add("newton_iterations", step.newton_iterations);
    if (d.face)
      row.add("contact_iterations", step.report.iterations);
    row.add("linear_iterations", step.report.linear_iterations);
    row.add("unchanged", step.is_unchanged);
    if (d.face)
      add_contact(scene, *d.face, step, quantities, row);
    for (const auto &[id, force] : quantities.reactions)
      row.add_vector("reaction_" + name_in_columns(id),
                     force,
                     dim,
                     Quantity::force,
                     row.printed);
    row.add_vector("load", forces.load.resultant, dim, Quantity::force);
    if (d.space.axial)
      {
        row.add("axial_strain",
                quantities.axial_strain,
                Quantity::pure_number,
                row.printed);
        row.add("axial_force",
                quantities.axial_force,
                Quantity::axial_force,
                row.printed);
      }
    row.add("force_balance_defect", balance_defect(quantities));
    if (d.face)
      {
        row.add("max_utilisation", friction.max_utilization);
        row.add("max_stick_slip", friction.max_stick_slip, Quantity::length);
        row.add("max_slip", friction.max_slip, Quantity::length);
        row.add("slip_misalignment", friction.slip_misalignment);
      }
    add_energies(d, forces, quantities, balance, row);
    row.add("max_displacement", quantities.max_displacement, Quantity::length);
    row.add("max_von_mises", stress.max_von_mises, Quantity::stress);
    row.add("mean_von_mises", stress.mean_von_mises, Quantity::stress);
    row.add("stress_norm", stress.stress_norm, Quantity::stress_norm);
    add_asked_for(quantities, row);
    if (scene.is_adaptive())
      row.add("estimator",
              quantities.refinement_estimate,
              quantity_of_estimator(scene));
    if (has_error_estimate)
      add_estimates(scene, step.end.errors, row);
    if (scene.measures_errors())
      add_errors(errors, row);
    add_seconds(row);
    return row;
  }



  template <int dim>
  void
  Recorder<dim>::add_asked_for(const StepQuantities<dim> &quantities,
                               TableRow                  &row) const
  {
    const double *value = quantities.point_fields.data();
    const bool are_few  = quantities.point_displacements.size() <= most_printed;
    for (unsigned int i = 0; i < quantities.point_displacements.size(); ++i)
      {
        const std::string point = "point" + std::to_string(i);
        row.add_vector(point,
                       quantities.point_displacements[i],
                       dim,
                       Quantity::length,
                       are_few);
        if (!point_fields)
          continue;
        const std::vector<FieldColumn> &columns = point_fields->columns();
        for (std::size_t c = 0; c < columns.size(); ++c, ++value)
          if (c < point_fields->n_of_body() || point_fields->is_on_contact(i))
            row.add(point + "_" + columns[c].name, *value, columns[c].quantity);
      }
    for (std::size_t i = 0; i < quantities.integrals.size(); ++i)
      row.add(integrals->columns()[i].name,
              quantities.integrals[i],
              integrals->columns()[i].quantity);
  }



  template <int dim>
  void
  Recorder<dim>::add_seconds(TableRow &row)
  {
    const auto total = stopped_clock ?
                         stopped_clock->first :
                         timer.get_summary_data(TimerOutput::total_wall_time);
    for (const RunPhase &phase : run_phases)
      {
        if (!phase.is_in_statistics ||
            (phase.name == "estimate" && !has_error_estimate) ||
            (phase.name == "tangent" && !may_be_implicit()))
          continue;
        const auto   entry = total.find(phase.name);
        const double now   = entry == total.end() ? 0. : entry->second;
        row.add("wall_" + phase.name,
                now - last_seconds[phase.name],
                Quantity::wall_time);
        last_seconds[phase.name] = now;
      }
    row.add("wall_total", elapsed_in_all(), Quantity::wall_time);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Recorder, row);
} // namespace Viscoplastic
