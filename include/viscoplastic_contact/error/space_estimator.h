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
    /// The part of it that curved faces of bodies that touch miss of the
    /// geometry, squared by active cell; empty without them.
    Vector<double> geometry;
    /// The squared share of each active cell by which the mesh is refined;
    /// empty in scenes on a fixed mesh.
    Vector<double> squared_indicators;

    /// Take the estimate in proportion to the state.
    void
    scale(const double factor)
    {
      total *= factor;
      if (squared_indicators.size() > 0)
        squared_indicators *= factor * factor;
    }
  };



  /// Makes the estimates that a scene asks for on one mesh: that of the error,
  /// also for refinement, and Kelly's for refinement.
  ///
  /// The squared error of a cell is the larger of the residual estimate, which
  /// knows loads and contact, and of the recovery
  /// estimate, which knows what creep has made of earlier errors. That of a
  /// residual is one of a single step for given z: in long creep it is a
  /// fraction of the error, since displacements grow and residuals do not.
  template <int dim>
  class SpaceEstimator
  {
  public:
    explicit SpaceEstimator(const Discretization<dim> &discretization);

    /// Whether a scene asks for any estimate.
    static bool
    is_needed(const Scene<dim> &scene);

    /// Whether estimates have a geometry. The same on all ranks.
    bool
    has_curved_contact() const
    {
      return residual_estimator && residual_estimator->has_curved_contact();
    }

    /// Collective.
    SpaceEstimate
    estimate(const State<dim> &state, const Forces<dim> &forces) const;

    /// How the residuals of a state and of a dual solution go together; there
    /// has to be a residual estimator. @p memory: of the state, see
    /// ResidualEstimator::Fields. Collective.
    Vector<double>
    multiply(const State<dim>                              &state,
             const Forces<dim>                             &forces,
             const typename ResidualEstimator<dim>::OfDual &dual,
             const double                                   memory) const;

    typename ResidualEstimator<dim>::OfDual
    residuals_of(const DualSolution<dim> &dual) const;

    /// The products of both fields' errors by RecoveryEstimator, which includes
    /// the errors that creep has accumulated from those of rates. Collective.
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
    /// Whether volumetric locking counts.
    const bool locks;
    /// Null if only Kelly's estimate is asked for.
    std::unique_ptr<LocalCells<dim>>        cells;
    std::unique_ptr<ResidualEstimator<dim>> residual_estimator;
    std::unique_ptr<RecoveryEstimator<dim>> recovery_estimator;
  };

  /// The recovery estimate by active cell of a single state. Collective.
  template <int dim>
  Vector<double>
  squared_recovery_estimate(const StressSpace<dim> &stress_space,
                            const State<dim>       &state);
} // namespace Viscoplastic
