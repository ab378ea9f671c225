// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/error_estimate.h>
#include <viscoplastic_contact/parameters/parameters.h>

#include <algorithm>
#include <optional>

namespace Viscoplastic
{
  class Parameters;

  /// How much of the tolerance of a run each cause of errors may use.
  ///
  /// A run costs about e_h^-d e_k^(-1/p) to have the error e_h of the mesh, of
  /// first order, in d dimensions, and e_k of time steps of order p. With their
  /// sum given it costs least where e_k : e_h = 1/p : d.
  class ErrorBudget
  {
  public:
    /// The largest share of the initial data, which one mesh has to resolve.
    static constexpr double initial_share = 0.25;
    /// The share of what coarser meshes take from z, over the run.
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

    /// The budget of a run with these parameters; nothing without a tolerance.
    static std::optional<ErrorBudget>
    of_run(const Parameters &parameters);

    /// The errors that the tolerance is for.
    const ErrorParts &
    errors(const ErrorEstimate &estimate) const
    {
      return of_quantity ? static_cast<const ErrorParts &>(estimate.quantity) :
                           estimate;
    }

    /// The size of the solution in a state.
    double
    size(const ErrorEstimate &estimate) const
    {
      return of_quantity ? std::abs(estimate.quantity.value) :
                           estimate.energy_norm;
    }

    /// Set the expected size of the solution (energy norm, or value of the
    /// quantity) to that @p of_coarse_run, which may be too large.
    void
    expect_size(const double of_coarse_run)
    {
      expected_size = 0.95 * of_coarse_run;
    }

    /// The largest size of the run, as far as it can be expected; @p so_far
    /// that of the steps up to now.
    double
    size(const double so_far) const
    {
      return std::max(expected_size, so_far);
    }

    /// The share of the tolerance for the error of the initial data, absolute;
    /// zero if nothing can be said before the first step.
    double
    initial() const
    {
      return of_quantity ? 0. : initial_share * tolerance * expected_size;
    }

    /// The error that the next change of the mesh may make by coarsening z, in
    /// the energy norm: half of what is left.
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
