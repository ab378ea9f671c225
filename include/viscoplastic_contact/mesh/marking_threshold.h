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
  /// The critical value is the one at which the weights of the values that are
  /// not smaller add up to at least @p target. A threshold right beside it
  /// would be passed by rounding and by what iterations leave, and so would the
  /// choice between values that are equal by symmetry: runs on different
  /// numbers of ranks would go on with different meshes. Therefore the
  /// threshold is the middle of the widest gap between values within one per
  /// cent below, or above, the critical one.
  ///
  /// @p values are pairs of value and weight. Returns 0 if all weights add up
  /// to less than the target. Collective, the same on all ranks.
  double
  marking_threshold(std::vector<std::pair<double, double>> values,
                    const double                           target,
                    const ThresholdSide                    side,
                    const MPI_Comm                         communicator);
} // namespace Viscoplastic
