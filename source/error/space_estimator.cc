// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/error/space_estimator.h>
#include <viscoplastic_contact/error/volumetric_locking.h>

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



  namespace
  {
    /// The fields of a state for ResidualEstimator.
    template <int dim>
    class FieldsOfState
    {
    public:
      FieldsOfState(const Discretization<dim> &d,
                    const State<dim>          &state,
                    const Forces<dim>         &forces)
        : state(state)
        , z(d.mean_dilatation ? state.z :
                                without_thermal_stress(d.laws.thermal.get(),
                                                       state.t,
                                                       state.z,
                                                       rest))
      {
        if (d.face)
          density = d.face->density(state.contact);
        if (d.held_traction)
          {
            DistributedVector missing = forces.load.values;
            missing -= forces.internal;
            d.held_traction->add_density(missing, density);
          }
        if (d.scene().has_contact_pairs())
          {
            relative_u = state.u;
            d.space.make_relative(relative_u);
          }
      }

      typename ResidualEstimator<dim>::Fields
      fields(const double memory) const
      {
        return {state.u,
                z,
                state.t,
                density.size() > 0 ? &density : nullptr,
                memory,
                &relative_u};
      }

    private:
      const State<dim>         &state;
      IrreversibleStress        rest;
      const IrreversibleStress &z;
      DistributedVector         density, relative_u;
    };



    /// Return the error per unit of time by evaluating z' = G at cell means,
    ///
    ///     (int E^-1 d : d)^{1/2},   d = G'(P0 sigma_h) (sigma_h - P0 sigma_h),
    ///
    /// where P0 takes cell means. The variation of the stress in a cell does
    /// not flow; in long creep it carries loads that should relax, and the body
    /// as a whole is too stiff, which u_h does not show. G' is used since the
    /// variation is then large against the mean, where G itself says nothing.
    /// Collective.
    template <int dim>
    double
    cell_mean_defect(
      const LocalCells<dim>                                &cells,
      const std::vector<typename LocalCells<dim>::Strains> &strains,
      const FlowLaws<dim>                                  &laws,
      const State<dim>                                     &state)
    {
      const StressSpace<dim> &stress_space = laws.stress_space;
      const MPI_Comm          communicator = stress_space.space.communicator;
      Assert(stress_space.n_samples == 1, ExcInternalError());
      const auto now    = laws.at(state.t, state.history);
      double     square = 0.;
      // d by strains; if d is a multiple of their deviators, its square
      // instead.
      SymmetricTensor<4, 3>  rate_of_strain;
      double                 of_deviators   = 0.;
      const ViscoplasticLaw *last_law       = nullptr;
      const Stiffness       *last_stiffness = nullptr;
      fail_together(communicator, [&] {
        for (unsigned int c = 0; c < stress_space.n_cells(); ++c)
          {
            const ViscoplasticLaw *law = now.law(c);
            if (law == nullptr)
              continue;
            const auto           &cell      = cells.cells[c];
            const auto           &weights   = cells.shapes[cell.shape].weights;
            const Stiffness      &stiffness = stress_space.moduli(c);
            SymmetricTensor<2, 3> mean;
            for (unsigned int q = 0; q < weights.size(); ++q)
              mean += strains[c][q] * (weights[q] / stress_space.volume(c));
            // In most bodies that of linear laws is the same in all cells.
            if (law != last_law || &stiffness != last_stiffness ||
                !law->has_constant_tangents() || now.varies_in_space(c))
              {
                const auto tangents =
                  law->tangents(stiffness.stress(mean) + state.z[c],
                                now.mechanical(mean, c, 0),
                                stiffness,
                                now.point(c, 0));
                rate_of_strain =
                  tangents.stress * stiffness.tensor() + tangents.strain;
                of_deviators = 0.;
                if (law->has_constant_tangents() && stiffness.is_isotropic() &&
                    law->radial_flow(0., now.point(c, 0)))
                  of_deviators =
                    2. * Utilities::fixed_power<2>(rate_of_strain[0][1][0][1]) /
                    stiffness.shear_modulus();
                last_law       = law;
                last_stiffness = &stiffness;
              }
            for (unsigned int q = 0; q < weights.size(); ++q)
              {
                const SymmetricTensor<2, 3> e = strains[c][q] - mean;
                square +=
                  weights[q] *
                  (of_deviators > 0. ?
                     of_deviators * (e * e - trace(e) * trace(e) / 3.) :
                     stiffness.complementary_square(rate_of_strain * e));
              }
          }
      });
      return std::sqrt(std::max(0., Utilities::MPI::sum(square, communicator)));
    }
  } // namespace



  template <int dim>
  SpaceEstimate
  SpaceEstimator<dim>::estimate(const State<dim>  &state,
                                const Forces<dim> &forces) const
  {
    const Discretization<dim> &d = discretization;
    SpaceEstimate              result;
    if (refines_by_kelly)
      result.squared_indicators = kelly_estimate(d.space, state.u);
    if (!residual_estimator)
      return result;
    const FieldsOfState of_state(d, state, forces);
    Vector<double> squared = residual_estimator->estimate(of_state.fields(0.));
    const auto     strains = cells->strains(state.u);
    double         of_deviators = 0.;
    const Vector<double> recovery =
      recovery_estimator->estimate(state.u,
                                   strains,
                                   locks ? &of_deviators : nullptr);
    for (unsigned int i = 0; i < squared.size(); ++i)
      squared[i] = std::max(squared[i], recovery[i]);
    const auto &triangulation = d.space.dof_handler.get_triangulation();
    if (locks)
      {
        const VolumetricLocking locking =
          volumetric_locking(*cells, strains, d.laws, state, of_deviators);
        squared += locking.squared_error;
        result.rate_defect = locking.rate;
      }
    if (residual_estimator->has_curved_contact())
      {
        result.geometry =
          residual_estimator->estimate_geometry(of_state.fields(0.));
        squared += result.geometry;
      }
    result.total = total_estimate(squared, triangulation);
    if (d.scene().has_viscosity() && d.stress_space.n_samples == 1)
      result.rate_defect = cell_mean_defect(*cells, strains, d.laws, state);
    if (refines_by_residual)
      result.squared_indicators = std::move(squared);
    return result;
  }



  template <int dim>
  Vector<double>
  SpaceEstimator<dim>::multiply(
    const State<dim>                              &state,
    const Forces<dim>                             &forces,
    const typename ResidualEstimator<dim>::OfDual &dual,
    const double                                   memory) const
  {
    const FieldsOfState of_state(discretization, state, forces);
    return residual_estimator->multiply(of_state.fields(memory), dual);
  }



  template <int dim>
  typename ResidualEstimator<dim>::OfDual
  SpaceEstimator<dim>::residuals_of(const DualSolution<dim> &dual) const
  {
    const IrreversibleStress none;
    return residual_estimator->of_dual(
      {dual.cartesian,
       none,
       {},
       dual.density.size() > 0 ? &dual.density : nullptr,
       0.,
       nullptr,
       dual.load});
  }



  template <int dim>
  Vector<double>
  squared_recovery_estimate(const StressSpace<dim> &stress_space,
                            const State<dim>       &state)
  {
    const LocalCells<dim> cells(stress_space);
    return RecoveryEstimator<dim>(cells).estimate(state.u,
                                                  cells.strains(state.u));
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(SpaceEstimator);
  VISCOPLASTIC_INSTANTIATE(squared_recovery_estimate);
} // namespace Viscoplastic
