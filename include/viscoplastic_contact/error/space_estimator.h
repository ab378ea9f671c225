// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/error/dual_problem.h>
#include <viscoplastic_contact/error/residual_estimator.h>

#include <memory>

namespace Viscoplastic
{
  /// The error of a state in space, for given z.
  struct SpaceEstimate
  {
    /// The residual estimate of the whole body; zero where it is not made.
    double residual = 0.;
    /// The squared share of each active cell by which the mesh is refined;
    /// empty in scenes on a fixed mesh.
    Vector<double> squared_indicators;
  };



  /**
   * Makes the estimates that a scene asks for on one mesh: the residual
   * estimator for the error estimate or for refinement, Kelly's for refinement.
   */
  template <int dim>
  class SpaceEstimator
  {
  public:
    explicit SpaceEstimator(const Discretization<dim> &discretization);

    /// Whether a scene asks for any estimate.
    static bool
    is_needed(const Scene<dim> &scene);

    /// Collective.
    SpaceEstimate
    estimate(const State<dim> &state) const;

    /// How the residuals of a state and of a dual solution go together; there
    /// has to be a residual estimator. Collective.
    typename ResidualEstimator<dim>::Products
    multiply(const State<dim> &state, const DualSolution<dim> &dual) const;

  private:
    const Discretization<dim> &discretization;
    const bool                 refines_by_kelly, refines_by_residual;
    /// The residual estimator; null if only Kelly's estimate is asked for.
    std::unique_ptr<ResidualEstimator<dim>> residual_estimator;
  };
} // namespace Viscoplastic
