// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/space_estimator.h>

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
  {
    if (discretization.scene().parameters.error_control.error_estimator ||
        refines_by_residual)
      residual_estimator =
        std::make_unique<ResidualEstimator<dim>>(discretization.stress_space);
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
    Vector<double> squared = residual_estimator->estimate(
      {state.u, state.z, state.t, d.face ? &density : nullptr});
    result.residual =
      total_estimate(squared, d.space.dof_handler.get_triangulation());
    if (refines_by_residual)
      result.squared_indicators = std::move(squared);
    return result;
  }



  template <int dim>
  typename ResidualEstimator<dim>::Products
  SpaceEstimator<dim>::multiply(const State<dim>        &state,
                                const DualSolution<dim> &dual) const
  {
    const ContactFace<dim> *face = discretization.face.get();
    DistributedVector       density;
    if (face != nullptr)
      density = face->density(state.contact);
    const IrreversibleStress none;
    return residual_estimator->multiply(
      {state.u, state.z, state.t, face != nullptr ? &density : nullptr},
      {dual.cartesian, none, {}, face != nullptr ? &dual.density : nullptr});
  }



  template class SpaceEstimator<2>;
  template class SpaceEstimator<3>;
} // namespace Viscoplastic
