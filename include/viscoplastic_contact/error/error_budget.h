// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/error_estimate.h>
#include <viscoplastic_contact/parameters/parameters.h>

#include <algorithm>
#include <memory>

namespace Viscoplastic
{
  class Parameters;

  /// How much of the tolerance of a run each cause of errors may use.
  ///
  /// In d dimensions, a run with the error e_h of the mesh, of first order, and
  /// e_k of time steps of order p costs about e_h^-d e_k^(-1/p). For a given
  /// sum of both the cost is least if e_k : e_h = 1/p : d.
  class ErrorBudget
  {
  public:
    /// The largest share of the error of the initial data on the first mesh.
    static constexpr double initial_share = 0.25;
    /// The share of the error of z by coarsening, over the whole run.
    static constexpr double transfer_share = 0.1;
    /// The least share of the tolerance that is left to the mesh, however much
    /// the other errors take.
    static constexpr double least_space_share = 0.4;

    /// The budget for a scene in @p dimension dimensions with a time scheme of
    /// order @p order. @p of_quantity: whether the tolerance is that of the
    /// quantity of interest, whose value is the size of the solution then.
    ErrorBudget(const double       tolerance,
                const unsigned int dimension,
                const unsigned int order,
                const bool         of_quantity = false);

    /// The budget of a run with these parameters; null without a tolerance.
    static std::unique_ptr<ErrorBudget>
    of_run(const Parameters &parameters);

    /// The errors whose sum the tolerance bounds.
    const ErrorParts &
    errors(const ErrorEstimate &estimate) const
    {
      return of_quantity ? static_cast<const ErrorParts &>(estimate.quantity) :
                           estimate;
    }

    /// The energy norm, or the absolute value of the quantity, in a state.
    double
    size(const ErrorEstimate &estimate) const
    {
      return of_quantity ? std::abs(estimate.quantity.value) :
                           estimate.energy_norm;
    }

    /// Set the expected size of the solution (energy norm, or value of the
    /// quantity) to 0.95 of that @p of_coarse_run, which may be too large.
    void
    expect_size(const double of_coarse_run)
    {
      expected_size = 0.95 * of_coarse_run;
    }

    /// The expected largest size of the solution in the run; @p so_far: the
    /// largest size in the steps up to the present one.
    double
    size(const double so_far) const
    {
      return std::max(expected_size, so_far);
    }

    /// The absolute error that the initial data may have; zero if nothing is
    /// known before the first step, as for a quantity.
    double
    initial() const
    {
      return of_quantity ? 0. : initial_share * tolerance * expected_size;
    }

    /// The error that the next change of the mesh may make by coarsening z, in
    /// the energy norm: half of what is left of its share. (Meshes of a
    /// quantity of interest do not coarsen.)
    double
    transfer(const ErrorEstimate &accepted, const double size) const;

    /// The tolerance of all time steps of the run together, relative to the
    /// size of the solution.
    double
    time_tolerance() const
    {
      return time_share * tolerance;
    }

    /// The error that the mesh may make in a state with these @p errors,
    /// absolute; @p size: the largest norm of the solution in the run.
    double
    space(const ErrorParts &errors,
          const double      size,
          const bool        has_time_error) const;

    const double tolerance;
    const bool   of_quantity;
    double       expected_size = 0.;
    /// The part of the error of meshes that finer ones have been found not to
    /// reduce, such as what earlier meshes have left in z; zero if there is
    /// none.
    double unavoidable = 0.;

  private:
    const double time_share;
  };
} // namespace Viscoplastic
