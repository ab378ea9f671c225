// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/linear_algebra.h>

#include <functional>

namespace Viscoplastic
{
  /// Estimate the norm of the rounding error of load - matrix u, whose row i is
  /// taken to be off by one unit of rounding of |load_i| + sum_j |matrix_ij|
  /// |u_j|: the root mean square of the norms of a few such errors of random
  /// signs (Hutchinson's estimate of a trace). @p squared_norm may change its
  /// argument. Collective.
  double
  rounding_of_residual(
    const DistributedMatrix                          &matrix,
    const DistributedVector                          &load,
    const DistributedVector                          &u,
    const std::function<double(DistributedVector &)> &squared_norm);
} // namespace Viscoplastic
