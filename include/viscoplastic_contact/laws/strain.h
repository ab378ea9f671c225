// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/symmetric_tensor.h>

#include <array>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// The six (four in plane strain) stress components in the order of the
  /// parameter file: xx, yy, zz, xy (, xz, yz).
  template <int dim>
  constexpr std::array<std::pair<unsigned int, unsigned int>, dim == 2 ? 4 : 6>
  stress_components()
  {
    if constexpr (dim == 2)
      return {{{0, 0}, {1, 1}, {2, 2}, {0, 1}}};
    else
      return {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  }

  /// The symmetric part of a displacement gradient as a 3D tensor; in plane
  /// strain, what has z is zero.
  template <int dim>
  SymmetricTensor<2, 3>
  strain(const Tensor<2, dim> &gradient)
  {
    SymmetricTensor<2, 3> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = i; j < dim; ++j)
        result[i][j] = 0.5 * (gradient[i][j] + gradient[j][i]);
    return result;
  }

  /// The mean of div u over a cell, from gradients at its quadrature points.
  template <int dim>
  double
  mean_divergence(const std::vector<double>         &weights,
                  const std::vector<Tensor<2, dim>> &gradients)
  {
    double sum = 0., volume = 0.;
    for (unsigned int q = 0; q < weights.size(); ++q)
      {
        sum += trace(gradients[q]) * weights[q];
        volume += weights[q];
      }
    return sum / volume;
  }

  /// The strain that stresses act on: under mean dilatation its trace is
  /// @p dilatation, the mean over the cell.
  template <int dim>
  SymmetricTensor<2, 3>
  reduced_strain(const Tensor<2, dim> &gradient,
                 const bool            mean_dilatation,
                 const double          dilatation)
  {
    SymmetricTensor<2, 3> result = strain(gradient);
    if (mean_dilatation)
      {
        const double change = (dilatation - trace(result)) / 3.;
        for (unsigned int d = 0; d < 3; ++d)
          result[d][d] += change;
      }
    return result;
  }
} // namespace Viscoplastic
