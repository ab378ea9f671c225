// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Tensors that the tests of laws and elastic bodies take.

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/laws/stiffness.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace Viscoplastic::Testing
{
  using namespace dealii;

  using Tensor2 = SymmetricTensor<2, 3>;
  using Tensor4 = SymmetricTensor<4, 3>;

  /// mu = 0.4, K = 2/3.
  inline const Stiffness stiffness = Stiffness::isotropic(1., 0.25);



  inline Tensor2
  symmetric(const double xx,
            const double yy,
            const double zz,
            const double xy = 0,
            const double xz = 0,
            const double yz = 0)
  {
    Tensor2 t;
    t[0][0] = xx;
    t[1][1] = yy;
    t[2][2] = zz;
    t[0][1] = xy;
    t[0][2] = xz;
    t[1][2] = yz;
    return t;
  }



  class RandomTensors
  {
  public:
    Tensor2
    operator()()
    {
      Tensor2 t;
      for (unsigned int i = 0; i < Tensor2::n_independent_components; ++i)
        t.access_raw_entry(i) = distribution(generator);
      return t;
    }

    /// A random tensor with a deviator of this norm.
    Tensor2
    with_deviator(const double norm)
    {
      const Tensor2 t = (*this)();
      return trace(t) * unit_symmetric_tensor<3>() +
             norm / deviator(t).norm() * deviator(t);
    }

  private:
    std::mt19937                           generator{20000101};
    std::uniform_real_distribution<double> distribution{-1., 1.};
  };



  /// An orthonormal basis of the symmetric tensors.
  inline std::array<Tensor2, 6>
  basis()
  {
    const double h = std::sqrt(0.5);
    return {{symmetric(1, 0, 0),
             symmetric(0, 1, 0),
             symmetric(0, 0, 1),
             symmetric(0, 0, 0, h),
             symmetric(0, 0, 0, 0, h),
             symmetric(0, 0, 0, 0, 0, h)}};
  }



  inline void
  expect_near(const Tensor2 &a, const Tensor2 &b, const double tolerance)
  {
    EXPECT_LE((a - b).norm(), tolerance) << a << "\n" << b;
  }



  inline double
  largest_eigenvalue(const Tensor4 &t)
  {
    const std::array<Tensor2, 6> b = basis();
    LAPACKFullMatrix<double>     matrix(6, 6);
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        matrix(i, j) = b[i] * (t * b[j]);
    matrix.compute_eigenvalues();

    double largest = -std::numeric_limits<double>::infinity();
    for (unsigned int i = 0; i < 6; ++i)
      largest = std::max(largest, std::abs(matrix.eigenvalue(i)));
    return largest;
  }



  inline FullMatrix<double>
  voigt(const std::array<std::array<double, 6>, 6> &rows)
  {
    FullMatrix<double> matrix(6, 6);
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        matrix(i, j) = rows[i][j];
    return matrix;
  }

  /// An elastic tensor without symmetry, of the size of `stiffness'.
  inline Stiffness
  triclinic()
  {
    return Stiffness::anisotropic(
      voigt({{{{1.5, 0.4, 0.3, 0.05, -0.1, 0.12}},
              {{0.4, 1.2, 0.35, -0.08, 0.04, 0.1}},
              {{0.3, 0.35, 0.9, 0.06, 0.03, -0.07}},
              {{0.05, -0.08, 0.06, 0.35, 0.02, -0.03}},
              {{-0.1, 0.04, 0.03, 0.02, 0.5, 0.04}},
              {{0.12, 0.1, -0.07, -0.03, 0.04, 0.45}}}}));
  }



  /// The tensor `stiffness' given by its matrix.
  inline Stiffness
  as_matrix()
  {
    return Stiffness::anisotropic(voigt({{{{1.2, 0.4, 0.4, 0, 0, 0}},
                                          {{0.4, 1.2, 0.4, 0, 0, 0}},
                                          {{0.4, 0.4, 1.2, 0, 0, 0}},
                                          {{0, 0, 0, 0.4, 0, 0}},
                                          {{0, 0, 0, 0, 0.4, 0}},
                                          {{0, 0, 0, 0, 0, 0.4}}}}));
  }
} // namespace Viscoplastic::Testing
