// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>

namespace Viscoplastic
{
  /// The norms in which the theorems of the paper bound errors.
  struct SolutionNorms
  {
    /// a(u,u)^(1/2), with the reduced strain under mean dilatation.
    double energy = 0.;
    /// (|u|^2 + |grad u|^2)^(1/2).
    double h1 = 0.;
    /// (int sigma : sigma)^(1/2).
    double stress = 0.;
    /// (int_Gamma3 |lambda|^2)^(1/2).
    double multiplier = 0.;

    void
    fill(const double value)
    {
      energy = h1 = stress = multiplier = value;
    }

    /// Set each norm to the larger one of both; NaN in @p other is ignored.
    void
    update(const SolutionNorms &other)
    {
      energy     = std::max(energy, other.energy);
      h1         = std::max(h1, other.h1);
      stress     = std::max(stress, other.stress);
      multiplier = std::max(multiplier, other.multiplier);
    }
  };
} // namespace Viscoplastic
