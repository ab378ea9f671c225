// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/error/local_cells.h>

namespace Viscoplastic
{
  /// Return M^-1 r with the acoustic tensor M = nu . E . nu of a unit vector,
  /// the elasticity that a displacement across a plane feels.
  template <int dim>
  Tensor<1, dim>
  acoustic_compliance(const Stiffness      &stiffness,
                      const Tensor<1, dim> &normal,
                      const Tensor<1, dim> &r)
  {
    if (stiffness.is_isotropic())
      {
        const double mu     = stiffness.shear_modulus(),
                     across = stiffness.bulk_modulus() + 4. / 3. * mu;
        return r / mu + (1. / across - 1. / mu) * (r * normal) * normal;
      }
    Tensor<2, dim> acoustic;
    for (unsigned int k = 0; k < dim; ++k)
      {
        SymmetricTensor<2, 3> strain;
        for (unsigned int j = 0; j < dim; ++j)
          strain[k][j] += (j == k ? 1. : 0.5) * normal[j];
        const Tensor<1, dim> traction =
          in_plane(stiffness.stress(strain), normal);
        for (unsigned int i = 0; i < dim; ++i)
          acoustic[i][k] = traction[i];
      }
    return invert(acoustic) * r;
  }



  /// Return int (r, M^-1 r) over a face with these @p normals and @p weights at
  /// its quadrature points, the first of those of @p r.
  template <int dim, typename Normals, typename Weights, typename Values>
  double
  acoustic_square(const Stiffness &stiffness,
                  const Normals   &normals,
                  const Weights   &weights,
                  const Values    &r)
  {
    double all = 0., along = 0.; // r^2 and (r nu)^2, or (r, M^-1 r)
    for (unsigned int q = 0; q < LocalCells<dim>::n_face_points; ++q)
      {
        const Tensor<1, dim> &value = r[q], &normal = normals[q];
        if (stiffness.is_isotropic())
          {
            all += weights[q] * value.norm_square();
            along += weights[q] * Utilities::fixed_power<2>(value * normal);
          }
        else
          all +=
            weights[q] * value * acoustic_compliance(stiffness, normal, value);
      }
    if (!stiffness.is_isotropic())
      return all;
    const double mu = stiffness.shear_modulus();
    return (all - along) / mu +
           along / (stiffness.bulk_modulus() + 4. / 3. * mu);
  }
} // namespace Viscoplastic
