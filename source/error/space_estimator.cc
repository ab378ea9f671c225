// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/volumetric_integration.h>
#include <viscoplastic_contact/error/history_error.h>
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/space_estimator.h>
#include <viscoplastic_contact/error/volumetric_locking.h>

#include <algorithm>

namespace Viscoplastic
{
  template <int dim>
  SpaceEstimator<dim>::SpaceEstimator(const Discretization<dim> &discretization)
    : discretization(discretization)
    , refines_by_kelly(discretization.scene().parameters.refinement.strategy ==
                       RefinementStrategy::kelly)
    , refines_by_residual(
        discretization.scene().parameters.refinement.strategy ==
        RefinementStrategy::residual)
    , locks(!discretization.mean_dilatation &&
            may_lock(discretization.scene(),
                     discretization.moduli.max_poissons_ratio()))
  {
    if (discretization.scene().parameters.error_control.error_estimator ||
        refines_by_residual)
      {
        cells = std::make_unique<LocalCells<dim>>(discretization.stress_space);
        residual_estimator = std::make_unique<ResidualEstimator<dim>>(*cells);
        recovery_estimator = std::make_unique<RecoveryEstimator<dim>>(*cells);
      }
  }



  template <int dim>
  bool
  SpaceEstimator<dim>::is_needed(const Scene<dim> &scene)
  {
    return scene.parameters.error_control.error_estimator ||
           scene.is_adaptive();
  }



  template <int dim>
  SpaceEstimate
  SpaceEstimator<dim>::estimate(const State<dim> &state) const
  {
    const Discretization<dim> &d = discretization;
    SpaceEstimate              result;
    if (refines_by_kelly)
      result.squared_indicators = kelly_estimate(d.space, state.u);
    if (!residual_estimator)
      return result;
    DistributedVector density;
    if (d.face)
      density = d.face->density(state.contact);
    DistributedVector approach;
    if (d.face && d.scene().has_contact_pairs())
      approach = d.face->approach(state.u);
    Vector<double> squared = residual_estimator->estimate(
      {state.u, state.z, state.t, d.face ? &density : nullptr, 0., &approach});
    double               of_deviators = 0.;
    const Vector<double> recovery =
      recovery_estimator->estimate(state.u, locks ? &of_deviators : nullptr);
    for (unsigned int i = 0; i < squared.size(); ++i)
      squared[i] = std::max(squared[i], recovery[i]);
    const auto &triangulation = d.space.dof_handler.get_triangulation();
    result.recovery           = total_estimate(recovery, triangulation);
    if (locks)
      {
        const VolumetricLocking locking =
          volumetric_locking(*cells, d.laws, state, of_deviators);
        squared += locking.squared_error;
        result.rate_defect = locking.rate;
      }
    result.total = total_estimate(squared, triangulation);
    if (d.scene().has_viscosity() && d.stress_space.n_samples == 1)
      result.rate_defect = cell_mean_defect(*cells, d.laws, state);
    if (refines_by_residual)
      result.squared_indicators = std::move(squared);
    return result;
  }



  template <int dim>
  typename ResidualEstimator<dim>::Products
  SpaceEstimator<dim>::multiply(const State<dim>        &state,
                                const DualSolution<dim> &dual,
                                const double             memory) const
  {
    const ContactFace<dim> *face = discretization.face.get();
    DistributedVector       density;
    if (face != nullptr)
      density = face->density(state.contact);
    DistributedVector approach;
    if (face != nullptr && discretization.scene().has_contact_pairs())
      approach = face->approach(state.u);
    const IrreversibleStress none;
    return residual_estimator->multiply(
      {state.u,
       state.z,
       state.t,
       face != nullptr ? &density : nullptr,
       memory,
       &approach},
      {dual.cartesian, none, {}, face != nullptr ? &dual.density : nullptr});
  }



  template <int dim>
  Vector<double>
  SpaceEstimator<dim>::multiply_recovered(
    const State<dim>                                     &state,
    const DualSolution<dim>                              &dual,
    const typename RecoveryEstimator<dim>::Linearization &law) const
  {
    return recovery_estimator->multiply(state.u, dual.cartesian, law);
  }



  template <int dim>
  Vector<double>
  squared_recovery_estimate(const StressSpace<dim> &stress_space,
                            const State<dim>       &state)
  {
    const LocalCells<dim> cells(stress_space);
    return RecoveryEstimator<dim>(cells).estimate(state.u);
  }



  template class SpaceEstimator<2>;
  template class SpaceEstimator<3>;
  template Vector<double>
  squared_recovery_estimate<2>(const StressSpace<2> &, const State<2> &);
  template Vector<double>
  squared_recovery_estimate<3>(const StressSpace<3> &, const State<3> &);
} // namespace Viscoplastic
