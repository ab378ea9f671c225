// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <utility>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  enum class ThresholdSide
  {
    below,
    above
  };

  /// Choose a threshold among positive values that are spread over ranks.
  ///
  /// The critical value is the largest one such that the weights of all values
  /// not below it add up to @p target or more. Rounding errors and errors of
  /// iterative solvers could move values past a threshold close to it, and
  /// separate values that are equal by symmetry: meshes would depend on the
  /// number of ranks. Therefore the threshold is the middle of the widest gap
  /// between values within one percent below, or above, the critical value.
  ///
  /// @p values are pairs of value and weight. Returns 0 if all weights add up
  /// to less than the target. Collective; the result is the same on all ranks.
  double
  marking_threshold(std::vector<std::pair<double, double>> values,
                    const double                           target,
                    const ThresholdSide                    side,
                    const MPI_Comm                         communicator);
} // namespace Viscoplastic
