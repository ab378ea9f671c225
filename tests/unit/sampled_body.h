// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// A body with fields of stress, and fields that finite elements or samples
// represent exactly.

#include <deal.II/grid/grid_tools.h>

#include "body.h"

#include <algorithm>
#include <functional>

namespace Viscoplastic::Testing
{
  using Stress = SymmetricTensor<2, 3>;



  template <int dim>
  struct SampledBody : Body<dim>
  {
    using Body<dim>::Body;
    using Body<dim>::stress_space;

    /// Move inner points of the box, so that no cell stays a parallelogram.
    void
    distort()
    {
      GridTools::transform(
        [](const Point<dim> &x) {
          double bubble = x[0] * (2. - x[0]);
          for (unsigned int d = 1; d < dim; ++d)
            bubble *= 4. * x[d] * (1. - x[d]);
          Point<dim> y = x;
          y[0] += 0.1 * bubble;
          y[1] -= 0.15 * bubble * x[0];
          return y;
        },
        this->triangulation);
    }

    IrreversibleStress
    sample(const std::function<Stress(const Point<dim> &)> &field) const
    {
      IrreversibleStress z;
      for (std::size_t c = 0; c < stress_space->n_cells(); ++c)
        for (unsigned int s = 0; s < stress_space->n_samples; ++s)
          z.push_back(field(stress_space->position(c, s)));
      return z;
    }

    Stress
    integral(const IrreversibleStress &z) const
    {
      Stress result;
      for (std::size_t c = 0; c < stress_space->n_cells(); ++c)
        for (unsigned int s = 0; s < stress_space->n_samples; ++s)
          result +=
            stress_space->weight(c, s) * z[c * stress_space->n_samples + s];
      return Utilities::MPI::sum(result, MPI_COMM_WORLD);
    }

    double
    max_difference(const IrreversibleStress                        &z,
                   const std::function<Stress(const Point<dim> &)> &field) const
    {
      const IrreversibleStress exact  = sample(field);
      double                   result = 0.;
      for (std::size_t i = 0; i < z.size(); ++i)
        result = std::max(result, (z[i] - exact[i]).norm());
      return Utilities::MPI::max(result, MPI_COMM_WORLD);
    }
  };



  template <int dim>
  Tensor<1, dim>
  linear_displacement(const Point<dim> &x)
  {
    Tensor<1, dim> u;
    for (unsigned int i = 0; i < dim; ++i)
      {
        u[i] = 0.3 * (i + 1.);
        for (unsigned int j = 0; j < dim; ++j)
          u[i] += (0.7 * i - 0.4 * j + 0.1 * i * j + 0.2) * x[j];
      }
    return u;
  }



  inline const Stress &
  constant_stress()
  {
    static const Stress z = [] {
      Stress z;
      for (unsigned int e = 0; e < Stress::n_independent_components; ++e)
        z.access_raw_entry(e) = 0.5 - 0.3 * e;
      return z;
    }();
    return z;
  }
} // namespace Viscoplastic::Testing
