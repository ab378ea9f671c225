// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/state.h>

#include <vector>

namespace Viscoplastic
{
  /// The largest tensile contact stress of bilateral contact, and its place:
  /// such contact cannot open, so tension shows that the model does not hold.
  template <int dim>
  class ContactTension
  {
  public:
    /// Collective.
    explicit ContactTension(const StressSpace<dim> &stress_space);

    /// Area of the pieces with bilateral contact.
    double
    area() const
    {
      return total_area;
    }

    /// The part of it under a tensile normal stress of more than a thousandth
    /// of the largest stress there (Frobenius norm), by the mean stress of the
    /// cells behind. Collective.
    double
    tension_area(const State<dim> &state) const;

  private:
    struct Face
    {
      std::size_t    cell;
      Tensor<1, dim> normal;
      double         area;
    };

    const StressSpace<dim> &stress_space;
    std::vector<Face>       faces; // of owned cells
    double                  total_area;
  };
} // namespace Viscoplastic
