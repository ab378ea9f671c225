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

  /// Return the symmetric part of a displacement gradient as a 3D tensor. In
  /// 2D, its component zz is @p zz, u_r/r for bodies of revolution, and xz and
  /// yz are zero.
  template <int dim>
  DEAL_II_ALWAYS_INLINE inline SymmetricTensor<2, 3>
  strain(const Tensor<2, dim> &gradient, const double zz = 0.)
  {
    SymmetricTensor<2, 3> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = i; j < dim; ++j)
        result[i][j] = 0.5 * (gradient[i][j] + gradient[j][i]);
    if (dim == 2)
      result[2][2] = zz;
    return result;
  }

  /// The mean of div u over a cell, from strains at its quadrature points.
  inline double
  mean_dilatation(const std::vector<double>                &weights,
                  const std::vector<SymmetricTensor<2, 3>> &strains)
  {
    double sum = 0., volume = 0.;
    for (unsigned int q = 0; q < weights.size(); ++q)
      {
        sum += trace(strains[q]) * weights[q];
        volume += weights[q];
      }
    return sum / volume;
  }

  /// Return a strain with its trace replaced by @p dilatation. With mean
  /// dilatation, stresses follow from strains with the mean over the cell.
  DEAL_II_ALWAYS_INLINE inline SymmetricTensor<2, 3>
  with_dilatation(SymmetricTensor<2, 3> strain, const double dilatation)
  {
    const double change = (dilatation - trace(strain)) / 3.;
    for (unsigned int d = 0; d < 3; ++d)
      strain[d][d] += change;
    return strain;
  }
} // namespace Viscoplastic
