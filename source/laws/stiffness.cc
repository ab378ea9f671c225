// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/laws/stiffness.h>

#include <algorithm>
#include <utility>

namespace Viscoplastic
{
  namespace
  {
    /// An orthonormal basis of the symmetric tensors, in Voigt's order. The
    /// matrix of a tensor in it is that of Kelvin and Mandel: its eigenvalues
    /// and inverse are those of the tensor, which Voigt's are not.
    std::array<SymmetricTensor<2, 3>, 6>
    kelvin_basis()
    {
      std::array<SymmetricTensor<2, 3>, 6> basis;
      for (unsigned int i = 0; i < 3; ++i)
        basis[i][i][i] = 1.;
      basis[3][1][2] = std::sqrt(0.5);
      basis[4][0][2] = std::sqrt(0.5);
      basis[5][0][1] = std::sqrt(0.5);
      return basis;
    }
  } // namespace



  Spectrum
  spectrum(const SymmetricTensor<4, 3> &tensor)
  {
    const auto               basis = kelvin_basis();
    LAPACKFullMatrix<double> matrix(6, 6);
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        matrix(i, j) = basis[i] * (tensor * basis[j]);

    // All eigenvalues are within this bound; zero would be an empty interval.
    const double       bound = std::max(2 * matrix.frobenius_norm(), 1.);
    Vector<double>     values;
    FullMatrix<double> vectors;
    matrix.compute_eigenvalues_symmetric(-bound, bound, 0., values, vectors);
    AssertThrow(values.size() == 6, ExcInternalError());

    Spectrum result;
    for (unsigned int mode = 0; mode < 6; ++mode)
      {
        result.values[mode] = values[mode];
        for (unsigned int i = 0; i < 6; ++i)
          result.modes[mode] += vectors(i, mode) * basis[i];
      }
    return result;
  }



  Stiffness
  Stiffness::anisotropic(const FullMatrix<double> &voigt)
  {
    AssertDimension(voigt.m(), 6);
    AssertDimension(voigt.n(), 6);

    const double scale = voigt.linfty_norm();
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        {
          const std::string row    = std::to_string(i + 1),
                            column = std::to_string(j + 1);
          // The tolerance allows for rounding in the text of the matrix. The
          // comparison also refuses NaN.
          if (!(std::fabs(voigt(i, j) - voigt(j, i)) <= 1e-8 * scale) ||
              !std::isfinite(scale))
            refuse("The Voigt matrix has " + as_text(voigt(i, j)) + " in row " +
                   row + ", column " + column + ", and " +
                   as_text(voigt(j, i)) + " in row " + column + ", column " +
                   row + "; it must be symmetric and finite.");
        }
    require_in_range("The norm of the Voigt matrix",
                     scale,
                     least_modulus,
                     largest_modulus);

    // Voigt's matrix for engineering shears contains the tensor components.
    constexpr std::array<std::pair<unsigned int, unsigned int>, 6> axes = {
      {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};
    auto data = std::make_shared<Anisotropic>();
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        data->stiffness[axes[i].first][axes[i].second][axes[j].first]
                       [axes[j].second] = (voigt(i, j) + voigt(j, i)) / 2;

    const Spectrum eigen = spectrum(data->stiffness);
    if (!(eigen.values[0] > 1e-12 * eigen.values[5]))
      refuse("The smallest eigenvalue of the elastic tensor that the Voigt "
             "matrix gives is " +
             as_text(eigen.values[0]) + ", the largest " +
             as_text(eigen.values[5]) + "; it must be positive definite.");
    for (unsigned int mode = 0; mode < 6; ++mode)
      data->compliance += outer_product(eigen.modes[mode], eigen.modes[mode]) /
                          eigen.values[mode];

    const SymmetricTensor<4, 3> P = deviator_tensor<3>();
    data->largest_deviatoric      = spectrum(P * data->stiffness * P).values[5];
    data->smallest_deviatoric =
      1. / spectrum(P * data->compliance * P).values[5];

    // Voigt's averages: E : I (x) I = 9 K and the full trace 3 K + 10 mu.
    double I_E_I = 0., full_trace = 0.;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        {
          I_E_I += data->stiffness[i][i][j][j];
          full_trace += data->stiffness[i][j][i][j];
        }
    Stiffness result((full_trace - I_E_I / 3) / 10, I_E_I / 9);
    result.anisotropic_data = std::move(data);
    return result;
  }



  SymmetricTensor<4, 3>
  Stiffness::tensor() const
  {
    if (anisotropic_data)
      return anisotropic_data->stiffness;
    // By components, in a tenth of the time of operators.
    SymmetricTensor<4, 3> result;
    double *const         entry = result.begin_raw();
    for (unsigned int i = 0; i < 3; ++i)
      {
        for (unsigned int j = 0; j < 3; ++j)
          entry[6 * i + j] = 2 * mu * ((i == j ? 1. : 0.) - 1. / 3.) + bulk;
        entry[7 * (3 + i)] = 2 * mu * 0.5;
      }
    return result;
  }



  SymmetricTensor<4, 3>
  Stiffness::stress(const SymmetricTensor<4, 3> &strain) const
  {
    if (anisotropic_data)
      return anisotropic_data->stiffness * strain;
    const double          lambda = bulk - 2. / 3. * mu;
    SymmetricTensor<4, 3> result = strain;
    double *const         entry  = result.begin_raw();
    for (unsigned int j = 0; j < 6; ++j)
      {
        const double pressure =
          lambda * (entry[j] + entry[6 + j] + entry[12 + j]);
        for (unsigned int i = 0; i < 6; ++i)
          entry[6 * i + j] =
            2 * mu * entry[6 * i + j] + (i < 3 ? pressure : 0.);
      }
    return result;
  }



  SymmetricTensor<2, 3>
  Stiffness::anisotropic_stress(const SymmetricTensor<2, 3> &strain) const
  {
    return anisotropic_data->stiffness * strain;
  }



  SymmetricTensor<2, 3>
  Stiffness::anisotropic_strain(const SymmetricTensor<2, 3> &stress) const
  {
    return anisotropic_data->compliance * stress;
  }



  double
  Stiffness::anisotropic_square(const unsigned int           n,
                                const double                *weights,
                                const SymmetricTensor<2, 3> *stress) const
  {
    double squares = 0.;
    for (unsigned int i = 0; i < n; ++i)
      squares += weights[i] * (anisotropic_strain(stress[i]) * stress[i]);
    return squares;
  }
} // namespace Viscoplastic
