// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/error/dual_problem.h>
#include <viscoplastic_contact/error/recovery_estimator.h>
#include <viscoplastic_contact/error/residual_estimator.h>

#include <memory>

namespace Viscoplastic
{
  /// The error of a state in space.
  struct SpaceEstimate
  {
    /// The estimate in the energy norm; zero if only Kelly's indicator is
    /// computed.
    double total = 0.;
    /// The error of the rate G: of cell means (cell_mean_defect()) or by
    /// volumetric locking; zero without either.
    double rate_defect = 0.;
    /// The squared error by the geometry of curved bodies in contact by active
    /// cell, part of the total; empty without such contact.
    Vector<double> geometry;
    /// The squared indicators by active cell by which the mesh is refined;
    /// empty in scenes on a fixed mesh.
    Vector<double> squared_indicators;

    /// Scale the estimate in proportion to the size of the state.
    void
    scale(const double factor)
    {
      total *= factor;
      rate_defect *= factor;
      if (squared_indicators.size() > 0)
        squared_indicators *= factor * factor;
    }
  };



  /// Computes the estimates that a scene asks for on one mesh: that of the
  /// error, also for refinement, and Kelly's indicator for refinement.
  ///
  /// The squared error of a cell is the larger one of the residual estimate,
  /// which contains loads and contact, and the recovery estimate, which
  /// contains errors accumulated by creep. The residual estimate is that of a
  /// single step for given z: in long creep it is a fraction of the error,
  /// since displacements grow and residuals do not.
  template <int dim>
  class SpaceEstimator
  {
  public:
    explicit SpaceEstimator(const Discretization<dim> &discretization);

    /// Whether a scene asks for any estimate.
    static bool
    is_needed(const Scene<dim> &scene);

    /// Whether SpaceEstimate::geometry is set. The same on all ranks.
    bool
    has_curved_contact() const
    {
      return residual_estimator && residual_estimator->has_curved_contact();
    }

    /// Return the estimate of a state with its @p forces. Collective.
    SpaceEstimate
    estimate(const State<dim> &state, const Forces<dim> &forces) const;

    /// Return ResidualEstimator::multiply() of a state and a dual solution by
    /// active cell. Requires a residual estimator. @p memory: of the state, see
    /// ResidualEstimator::Fields. Collective.
    Vector<double>
    multiply(const State<dim>                              &state,
             const Forces<dim>                             &forces,
             const typename ResidualEstimator<dim>::OfDual &dual,
             const double                                   memory) const;

    typename ResidualEstimator<dim>::OfDual
    residuals_of(const DualSolution<dim> &dual) const;

    /// Return RecoveryEstimator::multiply() of a state and a dual solution by
    /// active cell, which includes errors accumulated by creep. Collective.
    Vector<double>
    multiply_recovered(
      const State<dim>                                     &state,
      const DualSolution<dim>                              &dual,
      const std::vector<SymmetricTensor<4, 3>>             *tangents,
      const typename RecoveryEstimator<dim>::Linearization &law,
      typename RecoveryEstimator<dim>::OfDual              &kept) const
    {
      return recovery_estimator->multiply(
        state.u, state.z, dual.cartesian, tangents, law, kept);
    }

  private:
    const Discretization<dim> &discretization;
    const bool                 refines_by_kelly, refines_by_residual;
    /// Whether volumetric locking is part of the estimate.
    const bool locks;
    /// Null if only Kelly's estimate is asked for.
    std::unique_ptr<LocalCells<dim>>        cells;
    std::unique_ptr<ResidualEstimator<dim>> residual_estimator;
    std::unique_ptr<RecoveryEstimator<dim>> recovery_estimator;
  };

  /// Return the squared recovery estimate by active cell. Collective.
  template <int dim>
  Vector<double>
  squared_recovery_estimate(const StressSpace<dim> &stress_space,
                            const State<dim>       &state);
} // namespace Viscoplastic
