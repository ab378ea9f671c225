// SPDX-License-Identifier: LGPL-2.1-or-later

// The elastic tensor.

#include "refusals.h"
#include "tensors.h"

#include <gtest/gtest.h>


namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  TEST(Stiffness, ModuliAndUniaxialStress)
  {
    EXPECT_NEAR(stiffness.shear_modulus(), 0.4, 1e-15);
    EXPECT_NEAR(stiffness.bulk_modulus(), 2. / 3., 1e-15);

    // Uniaxial stress defines E and nu.
    expect_near(stiffness.strain(symmetric(1, 0, 0)),
                symmetric(1, -0.25, -0.25),
                1e-14);
    expect_near(stiffness.stress(symmetric(0, 0, 0, 0, 0, 1)),
                symmetric(0, 0, 0, 0, 0, 0.8),
                1e-14);
  }



  TEST(Stiffness, StressStrainAndTensorAgree)
  {
    RandomTensors random;
    for (const double nu : {-0.5, 0., 0.3, 0.49999})
      {
        const Stiffness E = Stiffness::isotropic(25e9, nu);
        for (unsigned int i = 0; i < 20; ++i)
          {
            const Tensor2 strain = random();
            const Tensor2 stress = E.stress(strain);
            const double  scale  = stress.norm();
            expect_near(E.tensor() * strain, stress, 1e-14 * scale);
            expect_near(E.strain(stress), strain, 1e-10);
          }
      }
  }



  TEST(Stiffness, DeviatoricEigenvalue)
  {
    const Tensor4 P = deviator_tensor<3>();
    EXPECT_NEAR(largest_eigenvalue(P * stiffness.tensor() * P),
                stiffness.largest_deviatoric_eigenvalue(),
                1e-13);
  }



  TEST(Stiffness, AnisotropicByHand)
  {
    const FullMatrix<double> C = voigt({{{{10, 1, 2, 3, 4, 5}},
                                         {{1, 20, 6, 7, 8, 9}},
                                         {{2, 6, 30, 1, 2, 3}},
                                         {{3, 7, 1, 40, 4, 5}},
                                         {{4, 8, 2, 4, 50, 6}},
                                         {{5, 9, 3, 5, 6, 60}}}});
    const Stiffness          E = Stiffness::anisotropic(C);
    EXPECT_FALSE(E.is_isotropic());
    EXPECT_TRUE(stiffness.is_isotropic());

    // Columns of Voigt's matrix, with engineering shears: 2 eps = 1.
    expect_near(E.stress(symmetric(1, 0, 0)),
                symmetric(10, 1, 2, 5, 4, 3),
                1e-13);
    expect_near(E.stress(symmetric(0, 0, 0, 0, 0, 0.5)),
                symmetric(3, 7, 1, 5, 4, 40),
                1e-13);
    expect_near(E.stress(symmetric(0, 0, 0, 0, 0.5)),
                symmetric(4, 8, 2, 6, 50, 4),
                1e-13);
    expect_near(E.stress(symmetric(0, 0, 0, 0.5)),
                symmetric(5, 9, 3, 60, 6, 5),
                1e-13);
    RandomTensors random;
    for (unsigned int i = 0; i < 20; ++i)
      {
        const Tensor2 strain = random();
        expect_near(E.tensor() * strain, E.stress(strain), 1e-13);
        expect_near(E.strain(E.stress(strain)), strain, 1e-13);
      }

    // Voigt's averages: 9 K = 60 + 2 (1 + 2 + 6), 15 mu = 60 - 9 + 3*150.
    EXPECT_NEAR(E.bulk_modulus(), 78. / 9, 1e-13);
    EXPECT_NEAR(E.shear_modulus(), 501. / 15, 1e-13);

    // A copy shares the tensor and outlives the original.
    auto            original = std::make_unique<Stiffness>(E);
    const Stiffness copy     = *original;
    original.reset();
    expect_near(copy.stress(symmetric(1, 0, 0)),
                symmetric(10, 1, 2, 5, 4, 3),
                1e-13);
  }



  TEST(Stiffness, IsotropicAsVoigtMatrix)
  {
    const double       nu = 0.25, mu = 10e9, lambda = 10e9;
    FullMatrix<double> C(6, 6);
    for (unsigned int i = 0; i < 3; ++i)
      {
        for (unsigned int j = 0; j < 3; ++j)
          C(i, j) = lambda;
        C(i, i) += 2 * mu;
        C(i + 3, i + 3) = mu;
      }
    const Stiffness a = Stiffness::anisotropic(C);
    const Stiffness b = Stiffness::isotropic(25e9, nu);

    RandomTensors random;
    for (unsigned int i = 0; i < 20; ++i)
      {
        const Tensor2 t = random();
        expect_near(a.stress(t), b.stress(t), 1e-3);
        expect_near(a.strain(t), b.strain(t), 1e-24);
      }
    EXPECT_LE((a.tensor() - b.tensor()).norm(), 1e-3);
    EXPECT_NEAR(a.shear_modulus(), mu, 1e-3);
    EXPECT_NEAR(a.bulk_modulus(), b.bulk_modulus(), 1e-3);
    EXPECT_NEAR(a.poissons_ratio(), nu, 1e-14);
    EXPECT_NEAR(b.poissons_ratio(), nu, 1e-14);
    EXPECT_NEAR(a.largest_deviatoric_eigenvalue(), 2 * mu, 1e-3);
    EXPECT_NEAR(a.smallest_deviatoric_eigenvalue(), 2 * mu, 1e-3);
    EXPECT_EQ(b.smallest_deviatoric_eigenvalue(), 2 * mu);
  }



  // Iron, whose eigenvalues are C11 - C12 (twice), 2 C44 (three times) and
  // C11 + 2 C12 in any axes. Voigt's matrix has C44.
  TEST(Stiffness, CubicCrystal)
  {
    const double       c11 = 230e9, c12 = 135e9, c44 = 117e9;
    FullMatrix<double> C(6, 6);
    for (unsigned int i = 0; i < 3; ++i)
      {
        for (unsigned int j = 0; j < 3; ++j)
          C(i, j) = i == j ? c11 : c12;
        C(i + 3, i + 3) = c44;
      }
    const Stiffness E = Stiffness::anisotropic(C);
    EXPECT_NEAR(E.largest_deviatoric_eigenvalue(), 2 * c44, 1e-2);
    EXPECT_NEAR(E.smallest_deviatoric_eigenvalue(), c11 - c12, 1e-2);
    EXPECT_NEAR(E.bulk_modulus(), (c11 + 2 * c12) / 3, 1e-2);
    EXPECT_NEAR(E.shear_modulus(), (c11 - c12 + 3 * c44) / 5, 1e-2);

    const Spectrum eigen = spectrum(E.tensor());
    for (unsigned int i = 0; i < 6; ++i)
      {
        EXPECT_NEAR(eigen.values[i],
                    i < 2 ? c11 - c12 : (i < 5 ? 2 * c44 : c11 + 2 * c12),
                    1e-2);
        expect_near(E.stress(eigen.modes[i]),
                    eigen.values[i] * eigen.modes[i],
                    1e-2);
        for (unsigned int j = 0; j < 6; ++j)
          EXPECT_NEAR(eigen.modes[i] * eigen.modes[j], i == j, 1e-14);
      }
  }



  TEST(Stiffness, DeviatoricEigenvaluesOfAnisotropicBodies)
  {
    const Stiffness E = triclinic();
    const Tensor4   P = deviator_tensor<3>();
    EXPECT_NEAR(largest_eigenvalue(P * E.tensor() * P),
                E.largest_deviatoric_eigenvalue(),
                1e-13);

    // The strain of least energy for its deviator is the strain of a
    // deviatoric stress.
    const double  smallest = E.smallest_deviatoric_eigenvalue();
    RandomTensors random;
    for (unsigned int i = 0; i < 1000; ++i)
      {
        const Tensor2 strain = random();
        EXPECT_GE(strain * E.stress(strain),
                  smallest * (deviator(strain) * deviator(strain)));
      }
    Tensor4 compliance;
    for (const Tensor2 &b : basis())
      compliance += outer_product(E.strain(b), b);
    const Tensor2 mode   = spectrum(P * compliance * P).modes[5];
    const Tensor2 strain = E.strain(mode);
    EXPECT_NEAR(strain * E.stress(strain),
                smallest * (deviator(strain) * deviator(strain)),
                1e-12);
    EXPECT_GT(std::fabs(trace(strain)), 1e-3);
  }



  TEST(Stiffness, RefusesMatricesThatAreNotElliptic)
  {
    FullMatrix<double> C(IdentityMatrix(6));
    C(2, 4) = 0.5;
    expect_refusal([&] { Stiffness::anisotropic(C); },
                   "The Voigt matrix has 0.5 in row 3, column 5, and 0 in row "
                   "5, column 3; it must be symmetric and finite.");
    C(2, 4) = std::nan("");
    C(4, 2) = std::nan("");
    expect_refusal([&] { Stiffness::anisotropic(C); },
                   "it must be symmetric and finite.");
    // Eigenvalues 1 - 1.5 and 1 + 1.5 of the normal block; shears have 2.
    C       = IdentityMatrix(6);
    C(0, 1) = C(1, 0) = 1.5;
    expect_refusal([&] { Stiffness::anisotropic(C); },
                   "The smallest eigenvalue of the elastic tensor that the "
                   "Voigt matrix gives is -0.5, the largest 2.5; it must be "
                   "positive definite.");
    C(0, 1) = C(1, 0) = 1.;
    expect_refusal([&] { Stiffness::anisotropic(C); },
                   "it must be positive definite.");
  }



  TEST(Stiffness, PlaneStrainAgainstTwoDimensionalFormulas)
  {
    const double  nu     = 0.25;
    const double  mu     = 0.4;
    const double  lambda = 0.4;
    const double  exx = 0.3, eyy = -0.1, exy = 0.2;
    const Tensor2 stress = stiffness.stress(symmetric(exx, eyy, 0, exy));

    EXPECT_NEAR(stress[0][0], lambda * (exx + eyy) + 2 * mu * exx, 1e-15);
    EXPECT_NEAR(stress[1][1], lambda * (exx + eyy) + 2 * mu * eyy, 1e-15);
    EXPECT_NEAR(stress[0][1], 2 * mu * exy, 1e-15);
    EXPECT_NEAR(stress[2][2], nu * (stress[0][0] + stress[1][1]), 1e-15);
    EXPECT_EQ(stress[0][2], 0.);
    EXPECT_EQ(stress[1][2], 0.);
  }



  TEST(Stiffness, RefusesModuliThatAreNotElliptic)
  {
    for (const double modulus :
         {0., -1., std::nan(""), std::numeric_limits<double>::infinity()})
      expect_refusal([&] { Stiffness::isotropic(modulus, 0.3); },
                     "it must be positive and finite.");
    for (const double nu : {-1., 0.5, 0.7, std::nan("")})
      expect_refusal([&] { Stiffness::isotropic(1., nu); },
                     "it must be larger than -1 and smaller than 0.5.");
  }



  TEST(Stiffness, VonMises)
  {
    EXPECT_NEAR(von_mises(symmetric(3, 0, 0)), 3, 1e-14);
    EXPECT_NEAR(von_mises(symmetric(0, 0, 0, 1)), std::sqrt(3.), 1e-14);
    EXPECT_NEAR(von_mises(symmetric(5, 5, 5)), 0, 1e-14);
  }
} // namespace
