// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/results/run_phases.h>

#include <cmath>

// The rows of statistics.csv; doc/results.md tells what their columns mean.

namespace Viscoplastic
{
  namespace
  {
    void
    add_errors(const SolutionErrors &errors, Statistics &row)
    {
      const auto add = [&row](const std::string   &prefix,
                              const SolutionNorms &norms) {
        row.add(prefix + "energy", norms.energy);
        row.add(prefix + "h1", norms.h1);
        row.add(prefix + "stress", norms.stress);
        row.add(prefix + "multiplier", norms.multiplier);
      };
      add("error_", errors.error);
      row.add("error_memory", errors.memory);
      row.add("estimate_recovery", errors.recovery);
      add("exact_", errors.exact);
    }



    template <int dim>
    void
    add_estimates(const Scene<dim>    &scene,
                  const ErrorEstimate &estimate,
                  Statistics          &row)
    {
      row.add("energy_norm", estimate.energy_norm);
      row.add("estimate_space", estimate.space);
      row.add("estimate_time", estimate.time);
      if (scene.has_viscosity() &&
          (scene.is_adaptive() || !scene.keeps_history_at_points()))
        row.add("estimate_history", estimate.history);
      if (scene.has_friction() &&
          (dim == 3 || scene.has_bounds_of_step_before()))
        row.add("estimate_friction", estimate.friction);
      if (scene.is_adaptive() && scene.has_irreversible_stress())
        row.add("estimate_transfer", estimate.transfer);
      row.add("estimate_algebraic", estimate.algebraic);
      row.add("estimate_initial", estimate.initial);
      row.add("estimate_total", estimate.total());
      if (scene.quantity)
        {
          const QuantityEstimate &quantity = estimate.quantity;
          row.add("quantity_correction",
                  quantity.space_correction + quantity.time_correction);
          row.add("quantity_space", quantity.space);
          row.add("quantity_time", quantity.time);
          row.add("quantity_other",
                  quantity.total() - quantity.space - quantity.time);
          row.add("quantity_total", quantity.total());
        }
      row.add("time_indicator", estimate.time_indicator);
      row.add("velocity_variation", estimate.velocity_variation);
    }
  } // namespace



  template <int dim>
  void
  Recorder<dim>::write_row(const AcceptedStep<dim>   &step,
                           const StepQuantities<dim> &quantities,
                           const SolutionErrors      &errors)
  {
    const Discretization<dim> &d         = *discretization;
    const TimeStep            &time_step = step.time_step;
    const StressSummary<dim>  &stress    = quantities.stress;
    const FrictionIdentities  &friction  = quantities.friction;
    const Forces<dim>         &forces    = step.end.forces;
    Statistics                &row       = *statistics;
    row.add("step", time_step.n);
    row.add("t", time_step.t);
    row.add("k", time_step.k);
    row.add("cells",
            d.space.dof_handler.get_triangulation().n_global_active_cells());
    row.add("dofs", d.space.dof_handler.n_dofs());
    if (scene.has_viscosity())
      {
        row.add("step_limit", step.step_limit);
        row.add("k_r", step.stiffness());
        row.add_vector("critical_cell", step.critical_position, dim);
      }
    if (control.may_reject())
      row.add("rejected", step.n_rejections);
    if (d.tension)
      row.add("tension_area", quantities.tension_area);
    if (d.laws.any_cap)
      row.add("capped_volume", step.capped_volume);
    if (may_be_implicit())
      row.add("newton_iterations", step.newton_iterations);
    if (d.face)
      row.add("contact_iterations", step.report.iterations);
    row.add("linear_iterations", step.report.linear_iterations);
    row.add("unchanged", step.is_unchanged);
    if (d.face)
      {
        row.add("duality_gap", step.report.duality_gap);
        row.add("algebraic_error", step.report.relative_error);
        row.add("stick_area", friction.stick_area);
        row.add("slip_area", friction.slip_area);
        row.add_vector("friction_force", quantities.friction_force, dim);
        if (d.face->has_obstacles())
          {
            const NormalContact<dim> &contact = quantities.contact;
            row.add_vector("contact_force", contact.force, dim);
            row.add("contact_area", contact.contact_area);
            row.add("max_pressure", contact.max_pressure);
            row.add("max_gap", contact.max_gap);
            if (d.face->gives_way())
              row.add("max_penetration", contact.max_penetration);
            if (d.face->has_computed_pressure() &&
                scene.parameters.solver.coulomb_pressure !=
                  CoulombPressure::lagged)
              {
                row.add("bound_iterations", step.report.bound_iterations);
                row.add("contraction", step.report.contraction);
              }
            else if (d.face->has_computed_pressure())
              row.add("bound_lag",
                      quantities.friction_bounds.sum > 0. ?
                        quantities.friction_bounds.missed /
                          quantities.friction_bounds.sum :
                        0.);
          }
      }
    for (const auto &[id, force] : quantities.reactions)
      row.add_vector("reaction_" + name_in_columns(id), force, dim);
    row.add_vector("load", forces.load.resultant, dim);
    row.add("force_balance_defect", balance_defect(quantities));
    if (d.face)
      {
        row.add("max_utilisation", friction.max_utilization);
        row.add("max_stick_slip", friction.max_stick_slip);
        row.add("slip_misalignment", friction.slip_misalignment);
      }
    row.add("stored_energy", balance.stored_energy());
    row.add("strain_energy", forces.strain_energy - quantities.spring_energy);
    if (d.springs)
      row.add("spring_energy", quantities.spring_energy);
    if (scene.has_viscosity())
      row.add("viscous_dissipation", balance.viscous_dissipation());
    if (d.face)
      row.add("friction_dissipation", balance.friction_dissipation());
    row.add("external_work", balance.external_work());
    if (scene.is_adaptive())
      row.add("adaptation_energy", balance.adaptation_energy());
    if (scene.has_stages())
      row.add("construction_energy", balance.construction_energy());
    row.add("energy_balance_defect", balance.defect());
    row.add("max_displacement", quantities.max_displacement);
    row.add("max_von_mises", stress.max_von_mises);
    row.add("mean_von_mises", stress.mean_von_mises);
    row.add("stress_norm", stress.stress_norm);
    write_asked_for(quantities);
    if (scene.is_adaptive())
      row.add("estimator", quantities.refinement_estimate);
    if (has_error_estimate)
      add_estimates(scene, step.end.errors, row);
    if (scene.measures_errors())
      add_errors(errors, row);
    write_seconds();
    row.end_row();
  }



  template <int dim>
  void
  Recorder<dim>::write_asked_for(const StepQuantities<dim> &quantities)
  {
    Statistics   &row   = *statistics;
    const double *value = quantities.point_fields.data();
    for (unsigned int i = 0; i < quantities.point_displacements.size(); ++i)
      {
        const std::string point = "point" + std::to_string(i);
        row.add_vector(point, quantities.point_displacements[i], dim);
        if (!point_fields)
          continue;
        const std::vector<std::string> &names = point_fields->names();
        for (std::size_t c = 0; c < names.size(); ++c, ++value)
          if (c < point_fields->n_of_body() || point_fields->is_on_contact(i))
            row.add(point + "_" + names[c], *value);
      }
    for (std::size_t i = 0; i < quantities.integrals.size(); ++i)
      row.add(integrals->names()[i], quantities.integrals[i]);
  }



  template <int dim>
  void
  Recorder<dim>::write_seconds()
  {
    const auto total = timer.get_summary_data(TimerOutput::total_wall_time);
    for (const RunPhase &phase : run_phases)
      {
        if (!phase.is_in_statistics ||
            (phase.name == "estimate" && !has_error_estimate) ||
            (phase.name == "tangent" && !may_be_implicit()))
          continue;
        const auto   entry = total.find(phase.name);
        const double now   = entry == total.end() ? 0. : entry->second;
        statistics->add("wall_" + phase.name, now - last_seconds[phase.name]);
        last_seconds[phase.name] = now;
      }
    statistics->add("wall_total", elapsed_in_all());
  }



  template void
  Recorder<2>::write_row(const AcceptedStep<2> &,
                         const StepQuantities<2> &,
                         const SolutionErrors &);
  template void
  Recorder<3>::write_row(const AcceptedStep<3> &,
                         const StepQuantities<3> &,
                         const SolutionErrors &);
} // namespace Viscoplastic
