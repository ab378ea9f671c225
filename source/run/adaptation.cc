// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/memory_bound.h>
#include <viscoplastic_contact/error/memory_loss.h>
#include <viscoplastic_contact/error/state_transfer.h>
#include <viscoplastic_contact/mesh/mesh_marking.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

// When and how the mesh of a run changes.

namespace Viscoplastic
{
  template <int dim>
  RefinementParameters
  ViscoplasticContact<dim>::refinement_limits() const
  {
    RefinementParameters limits = parameters.refinement;
    if (limits.memory_budget > 0.)
      limits.cell_budget =
        std::min(limits.cell_budget,
                 cells_in_memory(*discretization, 1e9 * limits.memory_budget));
    return limits;
  }



  template <int dim>
  bool
  ViscoplasticContact<dim>::estimate_is_rounding() const
  {
    const EnergyRounding rounding = energy_rounding(discretization->space,
                                                    discretization->matrix,
                                                    accepted.forces);
    const double         energy_norm =
      std::sqrt(2. * std::max(0., accepted.forces.strain_energy));
    const double of_solver =
      10. * std::max(1e-10, parameters.solver.strict_tolerance());
    if (parameters.refinement.strategy == RefinementStrategy::kelly)
      {
        // Jumps of strains, relative to the strains as the error to the norm.
        const double jumps =
          total_estimate(accepted.space_estimate.squared_indicators,
                         triangulation);
        return rounding.is_all_of_the_strain ||
               jumps * energy_norm <=
                 std::max(of_solver * energy_norm, rounding.size) *
                   strain_norm(discretization->space, accepted.state.u);
      }
    return accepted.space_estimate.total <=
           std::max(of_solver * energy_norm, rounding.size);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::adapt_mesh()
  {
    TimerOutput::Scope phase(timer, "adaptation");
    if (estimate_is_rounding())
      return;
    const Vector<double> &squared_indicators =
      accepted.space_estimate.squared_indicators;
    if (budget)
      {
        if (mark_cells_to_tolerance(triangulation,
                                    squared_indicators,
                                    refinement_limits(),
                                    space_ratio(accepted.errors),
                                    keep_memory()))
          change_mesh();
        return;
      }
    if (mark_cells(triangulation, squared_indicators, refinement_limits()))
      change_mesh();
  }



  template <int dim>
  double
  ViscoplasticContact<dim>::space_ratio(const ErrorEstimate &errors) const
  {
    const double so_far = std::max(recorder.summary().controlled_errors().size,
                                   budget->size(errors));
    const double size   = budget->size(so_far);
    // A body that has not moved yet says nothing about the mesh.
    if (!(size > 0.))
      return 1.;
    const double allowed =
      budget->space(budget->errors(errors), size, scene.has_time_error());
    if (!scene.quantity)
      {
        // What the mesh does to a strain that is elastic, a finer one mends.
        // What it does to creep stays, and counts against what there is of it;
        // but the little of the beginning is not worth a mesh for itself.
        const double creep =
          so_far > 0. ? std::min(1., errors.creep_path / so_far) : 0.;
        constexpr double least = 1. / 3.;
        return errors.space /
               (allowed *
                (1. - creep + creep * std::max(least, so_far / size)));
      }
    const QuantityEstimate &quantity = errors.quantity;
    if (quantity.unsigned_space == 0.) // nor does friction that cannot change
      return 1.;
    // Quantities behave like squares of the energy norm. Where contributions
    // happen to cancel, none of them may become larger. What is settled stays
    // as it is on any mesh.
    constexpr double safety  = QuantityEstimator<dim>::safety;
    const double     settled = safety * std::abs(quantity.settled_space),
                 open        = std::max(0.1 * allowed, allowed - settled),
                 of_mesh =
                   std::max(safety * std::abs(quantity.space_correction -
                                              quantity.settled_space),
                            quantity.space_of_creep),
                 ratio = std::sqrt(
                   std::max(of_mesh,
                            std::min(quantity.unsigned_space, 0.9 * open)) /
                   open);
    // A face that hardly slips for a while will slip again.
    return scene.quantity->is_sum() ? std::max(1., ratio) : ratio;
  }



  template <int dim>
  std::function<void()>
  ViscoplasticContact<dim>::keep_memory()
  {
    // What creeps or slips remembers each mesh, which the estimate of a
    // quantity does not see: its mesh never becomes coarser.
    if (scene.quantity)
      return nullptr;
    return [this] {
      const double size =
        budget->size(recorder.summary().controlled_errors().size);
      limit_memory_loss(triangulation,
                        discretization->stress_space,
                        accepted.state.z,
                        budget->transfer(accepted.errors, size));
    };
  }



  template <int dim>
  bool
  ViscoplasticContact<dim>::refine_for(const AcceptedStep<dim> &step)
  {
    if (!budget || !scene.is_adaptive())
      return false;
    TimerOutput::Scope phase(timer, "adaptation");
    const double       ratio = space_ratio(step.end.errors);
    if (ratio <= 1. ||
        !mark_cells_to_tolerance(triangulation,
                                 step.end.space_estimate.squared_indicators,
                                 refinement_limits(),
                                 ratio,
                                 n_refinements == 0 ? keep_memory() :
                                                      std::function<void()>()))
      return false;
    change_mesh();
    ++n_refinements;
    std::ostringstream text;
    text << "  mesh " << std::setprecision(3) << ratio
         << " times too coarse for step " << step.time_step.n << ", refined to "
         << triangulation.n_global_active_cells() << " cells\n";
    out << text.str() << std::flush;
    return true;
  }



  template <int dim>
  bool
  ViscoplasticContact<dim>::refine_first_mesh(
    const double          estimate,
    const double          allowed,
    const Vector<double> &squared_indicators)
  {
    TimerOutput::Scope phase(timer, "adaptation");
    if (!scene.is_adaptive() || allowed == 0. || estimate <= allowed ||
        !mark_cells_to_tolerance(triangulation,
                                 squared_indicators,
                                 refinement_limits(),
                                 estimate / allowed))
      return false;
    triangulation.execute_coarsening_and_refinement();
    set_up();
    return true;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::change_mesh()
  {
    State<dim>       &state = accepted.state;
    DistributedVector density;
    if (discretization->face)
      density = discretization->face->density(state.contact);
    const double loss =
      error_estimator ?
        memory_loss(triangulation, discretization->stress_space, state.z) :
        0.;
    const Vector<double> history =
      error_estimator ? time_stepper->history_if_cells_are_refined(state) :
                        Vector<double>();
    const EnergiesOnMesh before = energies_on_mesh(*discretization, accepted);
    StateTransfer<dim>   transfer(triangulation,
                                discretization->stress_space,
                                state,
                                discretization->face ? &density : nullptr,
                                history);
    triangulation.execute_coarsening_and_refinement();
    set_up();

    const Discretization<dim> &d      = *discretization;
    auto                       result = transfer.unpack(d.stress_space);
    state                             = std::move(result.state);
    if (d.face)
      state.contact = contact_on_new_mesh(d, state, result.multiplier_density);
    const bool keeps_displacement =
      parameters.initial_state.reset_displacement && state.initial_u.size() > 0;
    if (keeps_displacement)
      state.initial_u -= state.u;
    // Equilibrium keeps the volume, which moves u, which makes z inconsistent.
    const unsigned int n_rounds = scene.has_viscosity() ? 8 : 1;
    for (unsigned int round = 0; round < n_rounds; ++round)
      {
        if (scene.has_viscosity())
          share_mismatch(d.stress_space, result.stress, state);
        time_stepper->settle(accepted);
      }
    // What a finer mesh finds of the initial state is no displacement since.
    if (keeps_displacement)
      state.initial_u += state.u;
    accepted.rate.reset();
    if (error_estimator)
      error_estimator->change_mesh(
        d.space, d.matrix, loss, result.of_refined_cells, accepted);
    recorder.record_mesh_change(before, energies_on_mesh(d, accepted));
  }



  template RefinementParameters
  ViscoplasticContact<2>::refinement_limits() const;
  template bool
  ViscoplasticContact<2>::estimate_is_rounding() const;
  template void
  ViscoplasticContact<2>::adapt_mesh();
  template bool
  ViscoplasticContact<2>::refine_for(const AcceptedStep<2> &);
  template bool
  ViscoplasticContact<2>::refine_first_mesh(const double,
                                            const double,
                                            const Vector<double> &);
  template RefinementParameters
  ViscoplasticContact<3>::refinement_limits() const;
  template bool
  ViscoplasticContact<3>::estimate_is_rounding() const;
  template void
  ViscoplasticContact<3>::adapt_mesh();
  template bool
  ViscoplasticContact<3>::refine_for(const AcceptedStep<3> &);
  template bool
  ViscoplasticContact<3>::refine_first_mesh(const double,
                                            const double,
                                            const Vector<double> &);
} // namespace Viscoplastic
