// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/memory_bound.h>
#include <viscoplastic_contact/error/memory_loss.h>
#include <viscoplastic_contact/error/mesh_controller.h>
#include <viscoplastic_contact/error/quantity_estimator.h>
#include <viscoplastic_contact/mesh/mesh_marking.h>

namespace Viscoplastic
{
  template <int dim>
  MeshController<dim>::MeshController(
    const Scene<dim>                          &scene,
    parallel::distributed::Triangulation<dim> &triangulation,
    ErrorBudget                               *budget)
    : scene(scene)
    , wanted(scene.parameters.refinement)
    , triangulation(triangulation)
    , budget(budget)
  {}



  template <int dim>
  bool
  MeshController<dim>::is_due(const unsigned int n) const
  {
    return scene.is_adaptive() && n > 0 &&
           (budget != nullptr ? n_refinements == 0 :
                                n % wanted.every_n_steps == 0);
  }



  template <int dim>
  bool
  MeshController<dim>::repeats_steps() const
  {
    return budget != nullptr && scene.is_adaptive();
  }



  template <int dim>
  bool
  MeshController<dim>::mark(const Discretization<dim> &discretization,
                            const EvaluatedState<dim> &accepted,
                            const double               so_far)
  {
    if (estimate_is_rounding(discretization, accepted))
      return false;
    const Vector<double> &squared_indicators =
      accepted.space_estimate.squared_indicators;
    if (budget == nullptr)
      return mark_cells(triangulation,
                        squared_indicators,
                        limits(discretization));
    return mark_cells_to_tolerance(triangulation,
                                   squared_indicators,
                                   limits(discretization),
                                   space_ratio(accepted.errors, so_far),
                                   limit_coarsening(discretization,
                                                    accepted,
                                                    so_far));
  }



  template <int dim>
  bool
  MeshController<dim>::mark_for_step(const Discretization<dim> &discretization,
                                     const EvaluatedState<dim> &accepted,
                                     const EvaluatedState<dim> &end,
                                     const double               so_far)
  {
    ratio = space_ratio(end.errors, so_far);
    if (ratio <= 1. || is_in_vain(end) ||
        !mark_cells_to_tolerance(
          triangulation,
          end.space_estimate.squared_indicators,
          limits(discretization),
          ratio,
          n_refinements == 0 ?
            limit_coarsening(discretization, accepted, so_far) :
            std::function<void()>()))
      return false;
    ++n_refinements;
    // What cell means and locking do to the history goes on on any mesh. The
    // error that coarse meshes leave in it may be twice as large as estimated.
    constexpr double of_history = 1. / 3., of_work = 0.5;
    if (!scene.quantity)
      has_settled =
        end.space_estimate.rate_defect == 0. &&
        end.errors.history >
          of_history * budget->tolerance *
            budget->size(std::max(so_far, budget->size(end.errors)));
    else
      has_settled =
        scene.quantity->is_sum() &&
        settled(end.errors.quantity) > of_work * allowed(end.errors, so_far);
    return true;
  }



  template <int dim>
  bool
  MeshController<dim>::is_in_vain(const EvaluatedState<dim> &end)
  {
    // The error of a quantity has a sign and may grow by chance.
    if (scene.quantity)
      return false;
    // If finer meshes leave more than 0.95 of an error three times in turn,
    // meshes do not cause it, and refinement would not end: the step accepts
    // the error, and later steps refine only once it has grown by half.
    constexpr double       hardly = 0.95, growth = 1.5;
    constexpr unsigned int enough = 3;
    const double           error  = budget->errors(end.errors).of_meshes();
    n_vain = n_refinements > 0 && error > hardly * last_error ? n_vain + 1 : 0;
    last_error = error;
    if (n_vain >= enough)
      budget->unavoidable = std::max(budget->unavoidable, error);
    return error < growth * budget->unavoidable;
  }



  template <int dim>
  bool
  MeshController<dim>::mark_first(const Discretization<dim> &discretization,
                                  const EvaluatedState<dim> &initial,
                                  const Vector<double>      *squared_errors)
  {
    if (!repeats_steps())
      return false;
    double estimate = initial.errors.initial, allowed = budget->initial();
    if (squared_errors == nullptr)
      {
        const ErrorParts &errors = budget->errors(initial.errors);
        squared_errors           = &initial.space_estimate.squared_indicators;
        estimate                 = errors.space;
        allowed                  = budget->space(errors,
                                budget->size(budget->size(initial.errors)),
                                scene.has_time_error());
      }
    return allowed > 0. && estimate > allowed &&
           mark_cells_to_tolerance(triangulation,
                                   *squared_errors,
                                   limits(discretization),
                                   estimate / allowed);
  }



  template <int dim>
  RefinementParameters
  MeshController<dim>::limits(const Discretization<dim> &discretization) const
  {
    RefinementParameters limits = wanted;
    // At the beginning of a load, errors are small against the later solution,
    // but those of creep on a coarse mesh stay in z: no mesh of a run to a
    // tolerance is coarser than the first one.
    if (budget != nullptr && scene.has_viscosity())
      limits.minimal_level =
        std::max(limits.minimal_level,
                 scene.parameters.geometry.global_refinements);
    if (limits.memory_budget > 0.)
      limits.cell_budget =
        std::min(limits.cell_budget,
                 cells_in_memory(discretization, 1e9 * limits.memory_budget));
    return limits;
  }



  template <int dim>
  bool
  MeshController<dim>::estimate_is_rounding(
    const Discretization<dim> &discretization,
    const EvaluatedState<dim> &accepted) const
  {
    // The estimate of a quantity that no residual changes is rounding, too.
    if (scene.quantity)
      {
        const QuantityEstimate &quantity = accepted.errors.quantity;
        if (quantity.of_boundary > 0. || quantity.of_sides != 0.)
          return false;
        if (quantity.unsigned_space == 0.)
          return true;
      }
    const EnergyRounding rounding = energy_rounding(discretization.space,
                                                    discretization.matrix,
                                                    accepted.forces);
    const double         energy_norm =
      std::sqrt(2. * std::max(0., accepted.forces.strain_energy));
    const double of_solver =
      10. * std::max(1e-10, scene.parameters.solver.strict_tolerance());
    if (wanted.strategy == RefinementStrategy::kelly)
      {
        // Compare jumps with strains as errors with the energy norm.
        const double jumps =
          total_estimate(accepted.space_estimate.squared_indicators,
                         triangulation);
        return rounding.is_all_of_the_strain ||
               jumps * energy_norm <=
                 std::max(of_solver * energy_norm, rounding.size) *
                   strain_norm(discretization.space, accepted.state.u);
      }
    return accepted.space_estimate.total <=
           std::max(of_solver * energy_norm, rounding.size);
  }



  template <int dim>
  double
  MeshController<dim>::allowed(const ErrorEstimate &errors,
                               const double         so_far) const
  {
    return budget->space(budget->errors(errors),
                         budget->size(std::max(so_far, budget->size(errors))),
                         scene.has_time_error());
  }



  template <int dim>
  double
  MeshController<dim>::settled(const QuantityEstimate &quantity) const
  {
    const double all = quantity.space_correction,
                 now = all - quantity.settled_space;
    return QuantityEstimator<dim>::safety *
           (scene.quantity->is_sum() ?
              std::abs(quantity.settled_space) :
              std::max(0., std::abs(all) - std::abs(now)));
  }



  template <int dim>
  double
  MeshController<dim>::space_ratio(const ErrorEstimate &errors,
                                   const double         size_up_to_now) const
  {
    const double so_far = std::max(size_up_to_now, budget->size(errors));
    const double size   = budget->size(so_far);
    // A body that has not moved yet says nothing about the mesh.
    if (!(size > 0.))
      return 1.;
    const double allowed = this->allowed(errors, so_far);
    if (!scene.quantity)
      {
        // A finer mesh removes errors of elastic strains, but not those of
        // creep, which count relative to the solution so far; at least to a
        // third of its largest size, as little creep is not worth a mesh.
        const double creep =
          so_far > 0. ? std::min(1., errors.creep_path / so_far) : 0.;
        constexpr double least = 1. / 3.;
        return errors.space /
               (allowed *
                (1. - creep + creep * std::max(least, so_far / size)));
      }
    const QuantityEstimate &quantity = errors.quantity;
    if (quantity.unsigned_space + quantity.of_boundary ==
        0.) // no information about the mesh
      return 1.;
    // Errors of quantities behave like squares of the energy norm. As
    // contributions of cells may cancel by chance, their sizes count, too. The
    // settled part stays on any mesh; for other than sums it counts if it adds.
    const double now     = quantity.space_correction - quantity.settled_space,
                 open    = std::max(0.1 * allowed, allowed - settled(quantity)),
                 of_mesh = std::max(QuantityEstimator<dim>::with_safety(
                                      now, quantity.of_sides),
                                    quantity.space_at_least) +
                           quantity.of_boundary,
                 ratio = std::sqrt(
                   std::max(of_mesh,
                            std::min(quantity.unsigned_space, 0.9 * open)) /
                   open);
    // A sum over steps grows again when a face that rests slips again.
    return scene.quantity->is_sum() ? std::max(1., ratio) : ratio;
  }



  template <int dim>
  std::function<void()>
  MeshController<dim>::limit_coarsening(
    const Discretization<dim> &discretization,
    const EvaluatedState<dim> &accepted,
    const double               so_far)
  {
    // Creep and slip keep errors of earlier meshes, which the estimate of a
    // quantity does not contain: its mesh never becomes coarser.
    if (scene.quantity || keeps_cells)
      return nullptr;
    return [this, &discretization, &accepted, so_far] {
      IrreversibleStress rest;
      limit_memory_loss(
        triangulation,
        discretization.stress_space,
        without_thermal_stress(discretization.laws.thermal.get(),
                               accepted.state.t,
                               accepted.state.z,
                               rest),
        budget->transfer(accepted.errors, budget->size(so_far)));
    };
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(MeshController);
} // namespace Viscoplastic
