// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace Viscoplastic
{
  using namespace dealii;

  /// Finds the largest of some nonnegative values and its place: among values
  /// that are equal up to solver tolerances, the place with the least
  /// coordinates is chosen, so that it does not depend on the number of ranks.
  template <int dim>
  class LargestPlace
  {
  public:
    /// Return whether add() might take the place of this value; to be asked
    /// first where places are expensive to compute.
    bool
    may_take(const double value) const
    {
      return value > 0. && value >= representative * (1. - tolerance);
    }

    void
    add(const double value, const Point<dim> &x)
    {
      largest_value = std::max(largest_value, value);
      if (!may_take(value))
        return;
      if (value > representative * (1. + tolerance) || is_before(x, place))
        {
          representative = value;
          place          = x;
        }
    }

    /// Find the largest value of all ranks and its place. Collective.
    void
    reduce(const MPI_Comm communicator)
    {
      std::array<double, dim + 2> own{{largest_value, representative}};
      std::copy(place.begin_raw(), place.end_raw(), own.begin() + 2);
      *this = LargestPlace();
      for (const auto &other : Utilities::MPI::all_gather(communicator, own))
        {
          Point<dim> x;
          std::copy(other.begin() + 2, other.end(), x.begin_raw());
          add(other[1], x);
          largest_value = std::max(largest_value, other[0]);
        }
    }

    /// Return the largest value; zero if none is positive.
    double
    value() const
    {
      return largest_value;
    }

    /// Return its place; the origin if no value is positive.
    const Point<dim> &
    position() const
    {
      return place;
    }

  private:
    static constexpr double tolerance = 1e-6;

    /// Compare coordinates lexicographically, up to rounding.
    static bool
    is_before(const Point<dim> &x, const Point<dim> &y)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(x[d] - y[d]) > 1e-12 * (x.norm() + y.norm()))
          return x[d] < y[d];
      return false;
    }

    double     largest_value = 0., representative = 0.;
    Point<dim> place;
  };
} // namespace Viscoplastic
