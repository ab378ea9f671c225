// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/parameters/parameter_file.h>

namespace Viscoplastic
{
  ErrorBudget::ErrorBudget(const double       tolerance,
                           const unsigned int dimension,
                           const unsigned int order,
                           const bool         of_quantity)
    : tolerance(tolerance)
    , of_quantity(of_quantity)
    , time_share(1. / (1. + dimension * order))
  {}



  std::unique_ptr<ErrorBudget>
  ErrorBudget::of_run(const Parameters &parameters)
  {
    const ErrorControlParameters &control = parameters.error_control;
    if (!control.has_tolerance())
      return {};
    return std::make_unique<ErrorBudget>(control.tolerance,
                                         parameters.dimension,
                                         order_of(parameters.time.scheme),
                                         !control.quantity.empty());
  }



  double
  ErrorBudget::transfer(const ErrorEstimate &accepted, const double size) const
  {
    return 0.5 *
           std::max(0., transfer_share * tolerance * size - accepted.transfer);
  }



  double
  ErrorBudget::space(const ErrorParts &errors,
                     const double      size,
                     const bool        has_time_error) const
  {
    const double all = tolerance * size;
    // The error of time steps still grows: reserve its whole share.
    const double time = has_time_error ? std::max(errors.time + errors.friction,
                                                  time_share * all) :
                                         0.;
    const double of_meshes =
      all - time - errors.transfer - errors.initial - errors.algebraic;
    const double left =
      of_meshes <= errors.history ?
        0. :
      errors.history_adds ?
        of_meshes - errors.history :
        std::sqrt((of_meshes - errors.history) * (of_meshes + errors.history));
    return std::max(least_space_share * all, left);
  }
} // namespace Viscoplastic
