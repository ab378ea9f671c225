// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/error_budget.h>

#include <algorithm>

namespace Viscoplastic
{
  ErrorBudget::ErrorBudget(const double       tolerance,
                           const unsigned int dimension,
                           const unsigned int order)
    : tolerance(tolerance)
    , time_share(1. / (1. + dimension * order))
  {}



  double
  ErrorBudget::space(const ErrorEstimate &estimate,
                     const double         size,
                     const bool           has_time_error) const
  {
    const double all = tolerance * size;
    // Time steps have not made all of their error yet.
    const double time =
      has_time_error ?
        std::max(estimate.time + estimate.friction, time_share * all) :
        0.;
    return std::max(least_space_share * all,
                    all - time - estimate.transfer - estimate.initial -
                      estimate.algebraic);
  }

} // namespace Viscoplastic
