// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <random>

namespace Viscoplastic::Testing
{
  /// Reproducible on every platform, unlike the standard's distributions.
  class Random
  {
  public:
    explicit Random(const unsigned int seed)
      : generator(seed)
    {}

    double
    uniform(const double from = -1., const double to = 1.)
    {
      return from + (to - from) * (generator() / 4294967296.);
    }

    unsigned int
    integer(const unsigned int from, const unsigned int to)
    {
      return from + generator() % (to - from + 1);
    }

    /// Spread over orders of magnitude.
    double
    logarithmic(const double from, const double to)
    {
      return from * std::pow(to / from, uniform(0., 1.));
    }

  private:
    std::mt19937 generator;
  };
} // namespace Viscoplastic::Testing
