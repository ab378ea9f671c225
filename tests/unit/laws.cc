// SPDX-License-Identifier: LGPL-2.1-or-later

// The viscoplastic laws, their registry, their parameters, and the elastic
// tensor; and the materials that these make.

#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/material.h>
#include <viscoplastic_contact/stiffness.h>
#include <viscoplastic_contact/viscoplastic_law.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  // The worked example of doc/adding_a_law.md; not in the registry.
  LawDescription
  garofalo_description();
} // namespace Viscoplastic

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;

  using Tensor2 = SymmetricTensor<2, 3>;
  using Tensor4 = SymmetricTensor<4, 3>;

  // mu = 0.4, K = 2/3.
  const Stiffness stiffness = Stiffness::isotropic(1., 0.25);



  Tensor2
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

    /// With a deviator of this norm.
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
  std::array<Tensor2, 6>
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



  void
  expect_near(const Tensor2 &a, const Tensor2 &b, const double tolerance)
  {
    EXPECT_LE((a - b).norm(), tolerance) << a << "\n" << b;
  }



  std::string
  message_of(const std::function<void()> &action)
  {
    try
      {
        action();
      }
    catch (const std::exception &exception)
      {
        // deal.II breaks long lines, and so the sentences.
        std::istringstream words(exception.what());
        std::string        message, word;
        while (words >> word)
          message += (message.empty() ? "" : " ") + word;
        return message;
      }
    return "";
  }



  void
  expect_refusal(const std::function<void()> &action,
                 const std::string           &sentence)
  {
    EXPECT_NE(message_of(action).find(sentence), std::string::npos)
      << "expected: " << sentence << "\nobtained: " << message_of(action);
  }



  std::unique_ptr<ViscoplasticLaw>
  make_law(const std::string &name,
           const std::string &entries = "",
           const unsigned int dim     = 3)
  {
    ParameterHandler prm;
    declare_viscoplastic_law_parameters(prm);
    prm.parse_input_from_string("subsection " + name + "\n" + entries +
                                "\nend\n");
    return make_viscoplastic_law(name, prm, "Material", dim);
  }

  std::string
  exact(const double value)
  {
    std::ostringstream out;
    out << std::setprecision(17) << value;
    return out.str();
  }



  /// A law in a body, at one point and time.
  struct Body
  {
    Body(std::unique_ptr<ViscoplasticLaw> law_,
         const Stiffness                 &stiffness = ::stiffness,
         const Point<3>                  &x         = Point<3>(),
         const double                     t         = 0)
      : law(std::move(law_))
      , stiffness(stiffness)
      , point(law->point(x, t))
    {
      law->check(stiffness, point);
    }

    Tensor2
    rate(const Tensor2 &stress, const Tensor2 &strain = {}) const
    {
      return law->rate(stress, strain, stiffness, point);
    }

    ViscoplasticLaw::Tangents
    tangents(const Tensor2 &stress, const Tensor2 &strain = {}) const
    {
      return law->tangents(stress, strain, stiffness, point);
    }

    double
    relaxation_rate(const Tensor2 &stress = {},
                    const Tensor2 &strain = {}) const
    {
      return law->relaxation_rate(stress, strain, stiffness, point);
    }

    double
    dissipation(const Tensor2 &stress, const Tensor2 &strain) const
    {
      return -rate(stress, strain) *
             law->driving_strain(stress, strain, stiffness, point);
    }

    double
    stored_energy(const Tensor2 &stress, const Tensor2 &strain) const
    {
      return law->stored_energy(stress, strain, stiffness, point);
    }

    std::unique_ptr<ViscoplasticLaw> law;
    Stiffness                        stiffness;
    LawPoint                         point;
  };

  std::unique_ptr<ViscoplasticLaw>
  maxwell(const double viscosity)
  {
    return make_law("maxwell", "set Viscosity = " + exact(viscosity));
  }

  std::unique_ptr<ViscoplasticLaw>
  perzyna(const double yield_radius,
          const double viscosity,
          const double hardening = 0)
  {
    return make_law("perzyna",
                    "set Yield radius = " + exact(yield_radius) +
                      "\nset Hardening modulus = " + exact(hardening) +
                      "\nset Viscosity = " + exact(viscosity));
  }

  std::unique_ptr<ViscoplasticLaw>
  zener(const double youngs_modulus,
        const double poissons_ratio,
        const double relaxation_time)
  {
    return make_law("zener",
                    "set Long-term Young's modulus = " + exact(youngs_modulus) +
                      "\nset Long-term Poisson's ratio = " +
                      exact(poissons_ratio) +
                      "\nset Relaxation time = " + exact(relaxation_time));
  }

  std::unique_ptr<ViscoplasticLaw>
  norton(const double rate_factor, const double exponent, const double cap)
  {
    return make_law("norton",
                    "set Rate factor = " + exact(rate_factor) +
                      "\nset Exponent = " + exact(exponent) +
                      "\nset Stress cap = " + exact(cap));
  }

  std::unique_ptr<ViscoplasticLaw>
  parsed(const std::string &strain_rate, const std::string &factor = "1")
  {
    return make_law("parsed",
                    "set Strain rate = " + strain_rate +
                      "\nset Factor = " + factor);
  }



  std::unique_ptr<ViscoplasticLaw>
  garofalo(const double rate_factor,
           const double stress_scale,
           const double cap)
  {
    const LawDescription law = garofalo_description();
    ParameterHandler     prm;
    law.declare(prm);
    prm.set("Rate factor", exact(rate_factor));
    prm.set("Stress scale", exact(stress_scale));
    prm.set("Stress cap", exact(cap));
    return law.make({prm, "Material/garofalo", 3});
  }



  FullMatrix<double>
  voigt(const std::array<std::array<double, 6>, 6> &rows)
  {
    FullMatrix<double> matrix(6, 6);
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        matrix(i, j) = rows[i][j];
    return matrix;
  }

  /// Without any symmetry, of the size of the isotropic one above.
  Stiffness
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



  /// The isotropic one above.
  Stiffness
  as_matrix()
  {
    return Stiffness::anisotropic(voigt({{{{1.2, 0.4, 0.4, 0, 0, 0}},
                                          {{0.4, 1.2, 0.4, 0, 0, 0}},
                                          {{0.4, 0.4, 1.2, 0, 0, 0}},
                                          {{0, 0, 0, 0.4, 0, 0}},
                                          {{0, 0, 0, 0, 0.4, 0}},
                                          {{0, 0, 0, 0, 0, 0.4}}}}));
  }



  /// What every law must satisfy.
  struct Case
  {
    std::string name;
    Body        body;
    /// At least r of all stresses; zero where there is no such bound.
    double lipschitz;
  };

  std::vector<Case>
  all_cases()
  {
    std::vector<Case> cases;
    for (const Stiffness &E : {stiffness, triclinic()})
      {
        const std::string body = E.is_isotropic() ? "" : " (triclinic)";
        const double      r    = E.largest_deviatoric_eigenvalue();
        const double ratio = std::sqrt(r / E.smallest_deviatoric_eigenvalue());
        const auto   add   = [&](const std::string               &name,
                             std::unique_ptr<ViscoplasticLaw> law,
                             const double                     lipschitz) {
          cases.push_back({name + body, {std::move(law), E}, lipschitz});
        };
        add("maxwell", maxwell(0.5), r);
        add("perzyna", perzyna(0.7, 0.2), 5 * r);
        add("perzyna, k_Y = 0", perzyna(0., 0.2), 5 * r);
        add("perzyna, hardening",
            perzyna(0.5, 0.2, 0.3),
            5 * r + 1.5 * std::sqrt(2. / 3.) * ratio);
        add("zener", zener(0.4, 0.1, 0.5), 2.);
        add("zener, all relaxes", zener(0., 0.3, 0.5), 2.);
        add("norton", norton(0.2, 3., 1.5), 1.5 * r * 0.2 * 3. * 2.25);
        add("norton, n = 1", norton(0.2, 1., 1e-3), 1.5 * r * 0.2);
        add("norton, n = 1.2", norton(0.2, 1.2, 1.), 1.5 * r * 0.2 * 1.2);
        add("parsed", parsed("0.3*sigma_eq", "2"), 1.5 * r * 0.6);
        add("example",
            garofalo(0.4, 0.8, 1.2),
            1.5 * r * 0.4 / 0.8 * std::cosh(1.5));
        add("parsed, all arguments",
            parsed("0.1*sigma_eq^2*(1 + 0.5*tanh(p))/(1 + eps_eq)"),
            0.);
        add("parsed, yield stress",
            parsed("0.5*max(0, sigma_eq - 1 - 0.1*eps_eq)"),
            0.);
      }
    // K_inf = K, mu_inf = mu/2.
    cases.push_back({"zener, elastic pressure",
                     {zener(6. / 11, 4. / 11, 0.5), stiffness},
                     2.});
    return cases;
  }

  /// Stresses and strains on both sides of kinks and at some distance from
  /// them, with pressures of a body that began without stress.
  struct State
  {
    Tensor2 stress, strain;
  };

  State
  random_state(const Stiffness &E, RandomTensors &random)
  {
    const Tensor2 strain = random();
    return {E.stress(strain + deviator(random())), strain};
  }



  double
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



  TEST(Stiffness, ModuliAndUniaxialStress)
  {
    EXPECT_NEAR(stiffness.shear_modulus(), 0.4, 1e-15);
    EXPECT_NEAR(stiffness.bulk_modulus(), 2. / 3., 1e-15);

    // Uniaxial stress is how E and nu are defined.
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



  TEST(Maxwell, RateByHand)
  {
    // mu/eta = 0.8; dev sigma = diag(2, -1, -1) + shear 1.
    const Body body(maxwell(0.5));
    expect_near(body.rate(symmetric(3, 0, 0, 1)),
                symmetric(-1.6, 0.8, 0.8, -0.8),
                1e-14);
    EXPECT_TRUE(body.law->deviatoric_flow());
  }



  TEST(Perzyna, RateByHand)
  {
    // |dev diag(3, 0, 0)| = sqrt(6): half of the deviator is in excess.
    expect_near(Body(perzyna(std::sqrt(6.) / 2, 2.)).rate(symmetric(3, 0, 0)),
                symmetric(-0.4, 0.2, 0.2),
                1e-14);

    // |dev sigma| = sqrt(2) for the shear stress 1.
    const Body body(perzyna(0.1, 1.));
    expect_near(body.rate(symmetric(0, 0, 0, 0, 1)),
                symmetric(0, 0, 0, 0, -0.8 * (1 - 0.1 / std::sqrt(2.))),
                1e-14);

    // Elastic under any pressure, and up to the yield surface.
    expect_near(body.rate(symmetric(-9, -9, -9)), {}, 0);
    expect_near(body.rate(symmetric(0, 0, 0, 0.0707)), {}, 0);
    EXPECT_TRUE(body.law->deviatoric_flow());
  }



  TEST(Perzyna, HardeningByHand)
  {
    // A viscoplastic shear strain of 0.3 has |d| = 0.3 sqrt(2), so that
    // R = 0.1 sqrt(2) + 0.5 sqrt(2/3) 0.3 sqrt(2); stress 1 in shear.
    const Body    body(perzyna(0.1 * std::sqrt(2.), 1., 0.5));
    const Tensor2 stress = symmetric(0, 0, 0, 1);
    const Tensor2 strain = stiffness.strain(stress) + symmetric(0, 0, 0, 0.3);
    const double  R      = 0.1 + 0.5 * std::sqrt(2. / 3.) * 0.3;
    expect_near(body.rate(stress, strain),
                symmetric(0, 0, 0, -0.8 * (1 - R)),
                1e-14);
    // Volumetric strain does not harden, and flow back hardens likewise.
    expect_near(body.rate(stress, strain + symmetric(1, 1, 1)),
                body.rate(stress, strain),
                1e-14);
    expect_near(body.rate(stress, strain - symmetric(0, 0, 0, 0.6)),
                body.rate(stress, strain),
                1e-14);
    // Inside the larger range.
    expect_near(body.rate(0.9 * R * stress,
                          stiffness.strain(0.9 * R * stress) +
                            symmetric(0, 0, 0, 0.3)),
                {},
                0);
  }



  TEST(Perzyna, WithoutElasticRangeIsMaxwell)
  {
    RandomTensors random;
    const Body    a(perzyna(0., 3.));
    const Body    b(maxwell(1.5));
    for (unsigned int i = 0; i < 10; ++i)
      {
        const Tensor2 stress = random();
        expect_near(a.rate(stress), b.rate(stress), 1e-15);
      }
    expect_near(a.rate({}), {}, 0);
  }



  TEST(Zener, RateByHand)
  {
    // E_inf = 0.5, nu_inf = 0: stress 0.5 eps.
    const Body body(zener(0.5, 0., 2.));
    expect_near(body.rate(symmetric(3, 0, 0, 1), symmetric(2, 4, 0, 0.4)),
                symmetric(-1, 1, 0, -0.4),
                1e-14);
    EXPECT_EQ(body.relaxation_rate(), 0.5);
    EXPECT_FALSE(body.law->deviatoric_flow());

    expect_near(Body(zener(0., 0.3, 2.)).rate(symmetric(3, 0, 0, 1)),
                symmetric(-1.5, 0, 0, -0.5),
                1e-15);
  }



  // A spring of E_inf beside one of E - E_inf with a dashpot: after a step of
  // strain the stress falls from E eps to E_inf eps, and what the second
  // spring held is dissipated.
  TEST(Zener, EnergyByHand)
  {
    const Body    body(zener(0.5, 0.25, 2.)); // E_inf = E/2
    const Tensor2 strain = symmetric(0.1, -0.05, 0, 0.2, 0, 0.07);
    const Tensor2 stress = stiffness.stress(strain);
    const double  energy = 0.5 * (stress * strain);
    EXPECT_TRUE(body.law->has_own_energy());
    EXPECT_NEAR(body.stored_energy(stress, strain), energy, 1e-16);
    EXPECT_NEAR(body.stored_energy(0.5 * stress, strain), energy / 2, 1e-16);
    EXPECT_NEAR(body.stored_energy(0.75 * stress, strain),
                energy / 2 + energy / 8,
                1e-16);
    // In the second spring the whole strain, then nothing.
    expect_near(body.law->driving_strain(stress, strain, stiffness, body.point),
                strain,
                1e-15);
    expect_near(
      body.law->driving_strain(0.5 * stress, strain, stiffness, body.point),
      {},
      1e-15);
    // q : B^-1 q/theta with q = stress/2 and B^-1 q = strain.
    EXPECT_NEAR(body.dissipation(stress, strain), energy / 2, 1e-16);
  }



  /// What d/dt (stored energy) + dissipation = sigma : eps' lacks, with
  /// sigma' = E eps' + G.
  double
  energy_balance_defect(const Body    &body,
                        const Tensor2 &stress,
                        const Tensor2 &strain,
                        const Tensor2 &strain_rate)
  {
    const Tensor2 stress_rate =
      body.stiffness.stress(strain_rate) + body.rate(stress, strain);
    // The energy is quadratic, so that a large step is exact.
    const double h     = 1.;
    const auto   after = [&](const double time) {
      return body.stored_energy(stress + time * stress_rate,
                                strain + time * strain_rate);
    };
    return (after(h) - after(-h)) / (2 * h) + body.dissipation(stress, strain) -
           stress * strain_rate;
  }



  // E_inf = E in pressure: that mode has no second spring. What the body has
  // there is 1/2 E^-1 sigma : sigma, also if it began with pressure.
  TEST(Zener, PressureThatDoesNotRelax)
  {
    EXPECT_NEAR(Stiffness::isotropic(6. / 11, 4. / 11).bulk_modulus(),
                stiffness.bulk_modulus(),
                1e-15);
    for (const Stiffness &E : {stiffness, as_matrix()})
      {
        const Body    body(zener(6. / 11, 4. / 11, 0.5), E);
        const Tensor2 I      = unit_symmetric_tensor<3>();
        const Tensor2 shear  = symmetric(0, 0, 0, 0.1);
        const Tensor2 strain = 0.1 * I + shear;
        const Tensor2 stress = E.stress(strain);
        expect_near(body.rate(stress, strain),
                    symmetric(0, 0, 0, -0.08),
                    1e-15);
        // The pressure is -9 K 0.1/3 + initial.
        for (const double initial : {0., 1.})
          {
            const double pressure = initial - 0.2;
            expect_near(body.law->driving_strain(
                          stress - initial * I, strain, E, body.point),
                        shear - pressure / 2 * I,
                        1e-14);
            // 1/2 (4 mu 0.01 + p^2/K)
            EXPECT_NEAR(body.stored_energy(stress - initial * I, strain),
                        0.5 * (0.016 + 1.5 * pressure * pressure),
                        1e-14);
          }
      }
  }



  TEST(Zener, WithoutSecondSpringEnergyIsThatOfOtherLaws)
  {
    RandomTensors random;
    for (const Stiffness &E : {stiffness, as_matrix()})
      {
        const Body    body(zener(1., 0.25, 0.5), E);
        const Tensor2 stress = random(), strain = random();
        expect_near(body.law->driving_strain(stress, strain, E, body.point),
                    E.strain(stress),
                    1e-14);
        EXPECT_NEAR(body.stored_energy(stress, strain),
                    0.5 * (stress * E.strain(stress)),
                    1e-14);
      }
  }



  // An initial stress may be in any mode.
  TEST(Zener, EnergyBalanceWhereModesDoNotRelax)
  {
    // E_inf, half of the isotropic one, and three modes which are not its own.
    FullMatrix<double> matrix      = voigt({{{{0.6, 0.2, 0.2, 0, 0, 0}},
                                             {{0.2, 0.6, 0.2, 0, 0, 0}},
                                             {{0.2, 0.2, 0.6, 0, 0, 0}},
                                             {{0, 0, 0, 0.2, 0, 0}},
                                             {{0, 0, 0, 0, 0.2, 0}},
                                             {{0, 0, 0, 0, 0, 0.2}}}});
    const double       modes[3][6] = {{0.5, 0.25, -0.5, 0.25, 0.5, -0.25},
                                      {0.25, -0.5, 0.5, 0.5, 0.25, 0.5},
                                      {0.5, 0.5, 0.25, -0.25, 0.25, 0.25}};
    for (const auto &mode : modes)
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j < 6; ++j)
          matrix(i, j) += mode[i] * mode[j];

    const Body bodies[] = {
      {zener(6. / 11, 4. / 11, 0.5), stiffness},
      {zener(6. / 11, 4. / 11, 0.5), as_matrix()},
      {zener(0.8, 0., 0.5), stiffness}, // mu_inf = mu, K_inf < K
      {zener(1., 0.25, 0.5), stiffness},
      {zener(1., 0.25, 0.5), as_matrix()},
      {zener(0.5, 0.25, 0.5), Stiffness::anisotropic(matrix)}};
    RandomTensors random;
    for (const Body &body : bodies)
      for (unsigned int i = 0; i < 10; ++i)
        EXPECT_NEAR(energy_balance_defect(body, random(), random(), random()),
                    0.,
                    1e-13);
  }



  TEST(Zener, MatrixOfAnIsotropicBody)
  {
    const Body    a(zener(0.4, 0.1, 0.5)), b(zener(0.4, 0.1, 0.5), as_matrix());
    RandomTensors random;
    for (unsigned int i = 0; i < 10; ++i)
      {
        const Tensor2 stress = random(), strain = random();
        expect_near(a.law->driving_strain(stress, strain, a.stiffness, a.point),
                    b.law->driving_strain(stress, strain, b.stiffness, b.point),
                    1e-13);
        EXPECT_NEAR(a.stored_energy(stress, strain),
                    b.stored_energy(stress, strain),
                    1e-13);
      }
  }



  TEST(Zener, RefusesLongTermModuliBeyondTheElasticOnes)
  {
    expect_refusal([] { Body(zener(1.2, 0.25, 1.)); },
                   "'Material/zener/Long-term Young's modulus' = 1.2 with "
                   "Poisson's ratio 0.25 makes the body stiffer in the long "
                   "term than at once, at x = (0 0 0): the smallest "
                   "eigenvalue of E - E_inf is -0.4; it must be zero or "
                   "positive.");
    // Young's modulus is smaller, the bulk modulus larger.
    expect_refusal([] { Body(zener(0.9, 0.4, 1.)); },
                   "makes the body stiffer in the long term than at once");
    expect_refusal([] { Body(zener(0.9, 0.4, 1.), as_matrix()); },
                   "makes the body stiffer in the long term than at once");
    EXPECT_NO_THROW(Body(zener(1., 0.25, 1.)));
    EXPECT_NO_THROW(Body(zener(0.4, 0.1, 1.), triclinic()));
    expect_refusal([] { Body(zener(1., 0.25, 1.), triclinic()); },
                   "makes the body stiffer in the long term than at once");
    expect_refusal(
      [] { make_law("zener", "set Long-term Young's modulus = 1 + t"); },
      "'Material/zener/Long-term Young's modulus' depends on t; elastic "
      "moduli must be functions of position only.");
    expect_refusal(
      [] { make_law("zener", "set Long-term Poisson's ratio = 0.5"); },
      "'Material/zener/Long-term Poisson's ratio' is 0.5; it must be larger "
      "than -1 and smaller than 0.5.");
  }



  TEST(Norton, RateByHand)
  {
    // Uniaxial stress 2: strain rate 3*2^3 along, half of it across.
    const Body body(norton(3., 3., 10.));
    expect_near(stiffness.strain(body.rate(symmetric(2, 0, 0))),
                symmetric(-24, 12, 12),
                1e-13);
    // r = 3 mu A n sigma^2
    EXPECT_NEAR(body.relaxation_rate(symmetric(2, 0, 0)),
                3 * 0.4 * 3 * 3 * 4,
                1e-13);
    EXPECT_EQ(body.relaxation_rate(symmetric(7, 7, 7)), 0.);
    EXPECT_TRUE(body.law->deviatoric_flow());
    EXPECT_TRUE(body.law->has_cap());
    EXPECT_FALSE(body.law->is_beyond_cap(symmetric(9.99, 0, 0), body.point));
    EXPECT_TRUE(body.law->is_beyond_cap(symmetric(10.01, 0, 0), body.point));
    EXPECT_FALSE(maxwell(1.)->has_cap());

    // n = 1 is maxwell with eta = 1/(3 A).
    RandomTensors random;
    for (unsigned int i = 0; i < 10; ++i)
      {
        const Tensor2 stress = random();
        expect_near(Body(norton(3., 1., 1.)).rate(stress),
                    Body(maxwell(1. / 9)).rate(stress),
                    1e-14);
      }
  }



  TEST(Norton, TangentBeyondTheCap)
  {
    // 3*2^3 + 3*3*2^2 (sigma - 2)
    const Body body(norton(3., 3., 2.));
    expect_near(stiffness.strain(body.rate(symmetric(5, 0, 0))),
                symmetric(-132, 66, 66),
                1e-12);
    EXPECT_NEAR(body.relaxation_rate(symmetric(5, 0, 0)),
                3 * 0.4 * 3 * 3 * 4,
                1e-13);
    EXPECT_EQ(body.law->announcement(),
              "continued linearly beyond the von Mises "
              "stress 'Material/norton/Stress cap' = 2");
    expect_refusal([] { make_law("norton"); },
                   "'Material/norton/Stress cap' is not given; beyond this von "
                   "Mises stress the power law is continued linearly, so "
                   "choose one well above the stress you expect.");
    expect_refusal([] { make_law("norton", "set Stress cap = 0"); },
                   "'Material/norton/Stress cap' is 0; it must be positive.");
    expect_refusal(
      [] { make_law("norton", "set Stress cap = 1\nset Exponent = 0.9"); },
      "'Material/norton/Exponent' is 0.9; it must be at least 1.");
  }



  // Constants in SI units whose powers are beyond the range of a double.
  TEST(Norton, LargeExponentsInPascals)
  {
    const Stiffness rock = Stiffness::isotropic(25e9, 0.25);
    const Tensor2   unit = symmetric(2. / 3, -1. / 3, -1. / 3);

    const Body salt(norton(1e-40, 5., 5e7), rock);
    expect_near(rock.strain(salt.rate(1e7 * unit)), -1.5e-5 * unit, 1e-18);
    // sigma^(n - 1) is 1e294, and 1e336 at ten times the stress.
    const Body stiff(norton(1e-300, 43., 5e8), rock);
    for (const double factor : {1., 10.})
      {
        const double expected = 10 * std::pow(factor, 43.);
        EXPECT_NEAR(-rock.strain(stiff.rate(factor * 1e7 * unit))[0][0] /
                      expected,
                    1.,
                    1e-12);
        EXPECT_NEAR(stiff.relaxation_rate(factor * 1e7 * unit) * factor * 1e7 /
                      (3 * 10e9 * 43 * expected),
                    1.,
                    1e-12);
      }
    // Underflow is no flow, and no NaN.
    expect_near(stiff.rate(1e-3 * unit), {}, 0);
    EXPECT_EQ(stiff.relaxation_rate(1e-3 * unit), 0.);
    const Body none(norton(0., 1., 1.), rock);
    expect_near(none.rate(1e7 * unit), {}, 0);
    expect_near(none.tangents(1e7 * unit).stress * unit, {}, 0);
  }



  TEST(Parsed, RateByHand)
  {
    // sigma_eq = 2, p = -2/3.
    const Body body(parsed("sigma_eq^3 - 3*p + 0*t", "3"));
    expect_near(stiffness.strain(body.rate(symmetric(2, 0, 0))),
                symmetric(-30, 15, 15),
                1e-13);
    // eps_eq of a viscoplastic tension diag(2, -1, -1) is 2.
    const Tensor2 stress = symmetric(2, 0, 0);
    expect_near(stiffness.strain(
                  Body(parsed("eps_eq"))
                    .rate(stress,
                          stiffness.strain(stress) + symmetric(2, -1, -1))),
                symmetric(-2, 1, 1),
                1e-14);
    // Without a direction there is no flow.
    expect_near(Body(parsed("1")).rate(symmetric(1, 1, 1)), {}, 0);
    EXPECT_TRUE(body.law->deviatoric_flow());
  }



  TEST(Parsed, IsNortonForThePower)
  {
    RandomTensors random;
    for (const Stiffness &E : {stiffness, triclinic()})
      {
        const Body a(parsed("sigma_eq^3", "0.2"), E);
        const Body b(norton(0.2, 3., 100.), E);
        for (unsigned int i = 0; i < 20; ++i)
          {
            const Tensor2 stress = random();
            expect_near(a.rate(stress), b.rate(stress), 1e-14);
            EXPECT_NEAR(a.relaxation_rate(stress) / b.relaxation_rate(stress),
                        1,
                        1e-9);
            EXPECT_LE(
              (a.tangents(stress).stress - b.tangents(stress).stress).norm(),
              1e-9 * b.relaxation_rate(stress));
          }
      }
  }



  TEST(Parsed, Refusals)
  {
    expect_refusal([] { parsed("sigma_eq + q"); },
                   "The expression 'sigma_eq + q' of 'Material/parsed/Strain "
                   "rate' cannot be parsed: Unexpected token \"q\" found at "
                   "position 11.");
    expect_refusal([] { parsed("x*sigma_eq"); }, "cannot be parsed");
    expect_refusal([] { parsed(""); },
                   "The expression of 'Material/parsed/Strain rate' is "
                   "empty.");
    expect_refusal([] { parsed("sigma_eq/eps_eq"); },
                   "'Material/parsed/Strain rate' has the value -nan at "
                   "sigma_eq,p,eps_eq = (0 0 0), t = 0; it must be finite.");
    expect_refusal([] { parsed("sigma_eq - 1"); },
                   "'Material/parsed/Strain rate' is -1 at sigma_eq = 0, p = "
                   "0, eps_eq = 0, t = 0; it must be zero or positive, since "
                   "flow against the stress would create energy.");
    expect_refusal([] { parsed("sigma_eq", "-1"); },
                   "'Material/parsed/Factor' is -1; it must be zero or "
                   "positive.");
    const Body body(parsed("sigma_eq*(1 - t)"),
                    stiffness,
                    Point<3>(),
                    /* t = */ 2);
    expect_refusal([&] { body.rate(symmetric(2, 0, 0)); },
                   "is -2 at sigma_eq = 2, p = -0.666667, eps_eq = 1.66667, t "
                   "= 2; it must be zero or positive");
    EXPECT_TRUE(body.law->depends_on_time());
    EXPECT_FALSE(body.law->depends_on_position());
    EXPECT_FALSE(parsed("sigma_eq")->depends_on_time());
    EXPECT_TRUE(parsed("sigma_eq", "exp(-x)")->depends_on_position());
  }



  TEST(Laws, TangentsAgainstCentralDifferences)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      for (unsigned int i = 0; i < 20; ++i)
        {
          SCOPED_TRACE(c.name);
          const State  state    = random_state(c.body.stiffness, random);
          const auto   tangents = c.body.tangents(state.stress, state.strain);
          const double r =
            c.body.relaxation_rate(state.stress, state.strain) + 1e-3;
          const double h = 1e-6;
          for (const Tensor2 &direction : basis())
            {
              const Tensor2 by_stress =
                (c.body.rate(state.stress + h * direction, state.strain) -
                 c.body.rate(state.stress - h * direction, state.strain)) /
                (2 * h);
              // Truncation h^2, cancellation 1e-16/h, and the differences
              // that the parsed law takes itself.
              expect_near(tangents.stress * direction, by_stress, 1e-8 * r);

              const Tensor2 by_strain =
                (c.body.rate(state.stress, state.strain + h * direction) -
                 c.body.rate(state.stress, state.strain - h * direction)) /
                (2 * h);
              expect_near(tangents.strain * direction, by_strain, 1e-8 * r);
            }
        }
  }



  // One-sided derivatives at either side of a kink, and close to zero stress.
  TEST(Laws, TangentsAtKinks)
  {
    const auto check =
      [](const Body &body, const Tensor2 &stress, const Tensor2 &strain) {
        const auto   tangents = body.tangents(stress, strain);
        const double h        = 1e-5 * deviator(stress).norm();
        for (const Tensor2 &direction : basis())
          {
            const Tensor2 difference =
              (body.rate(stress + h * direction, strain) -
               body.rate(stress - h * direction, strain)) /
              (2 * h);
            expect_near(tangents.stress * direction,
                        difference,
                        1e-7 * body.relaxation_rate(stress, strain));
          }
      };
    RandomTensors random;
    for (const Stiffness &E : {stiffness, triclinic()})
      for (const double factor : {0.999, 1.001, 10.})
        {
          SCOPED_TRACE(factor);
          const Tensor2 stress = random.with_deviator(factor * 0.7);
          check(Body(perzyna(0.7, 0.2), E), stress, {});
          // Of a von Mises cap of 0.7 sqrt(3/2).
          check(Body(norton(0.5, 3., 0.7 * std::sqrt(1.5)), E), stress, {});
          // The radius is 0.7 with the strain of this length.
          check(Body(perzyna(0.5, 0.2, 0.5), E),
                stress,
                E.strain(stress) + 0.4 * std::sqrt(1.5) /
                                     deviator(stress).norm() *
                                     deviator(stress));
          check(Body(parsed("max(0, sigma_eq - 0.7*sqrt(3/2))"), E),
                stress,
                {});
        }

    for (const Body &body : {Body(perzyna(0., 0.2)),
                             Body(norton(1., 1., 1.)),
                             Body(norton(1., 2., 1.)),
                             Body(parsed("sigma_eq"))})
      {
        // Without pressure, in which such a stress would be lost.
        check(body, deviator(random.with_deviator(1e-9)), {});
        const Tensor4 at_zero = body.tangents({}).stress;
        EXPECT_NEAR(largest_eigenvalue(at_zero),
                    body.relaxation_rate({}),
                    1e-12);
      }
  }



  TEST(Laws, RelaxationRateIsAtLeastTheLargestEigenvalue)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      for (unsigned int i = 0; i < 50; ++i)
        {
          SCOPED_TRACE(c.name);
          const State  state = random_state(c.body.stiffness, random);
          const double r = c.body.relaxation_rate(state.stress, state.strain);
          EXPECT_GE(r * (1 + 1e-12),
                    largest_eigenvalue(
                      c.body.tangents(state.stress, state.strain).stress));
          if (c.lipschitz > 0)
            {
              EXPECT_LE(r, c.lipschitz * (1 + 1e-9));
            }
        }
  }



  // The table of the method: in isotropic bodies the rate is the eigenvalue.
  TEST(Laws, RelaxationRatesByHand)
  {
    const auto eigenvalue =
      [](const Body &body, const Tensor2 &stress, const Tensor2 &strain = {}) {
        return largest_eigenvalue(body.tangents(stress, strain).stress);
      };
    const Tensor2 stress = symmetric(2, 0, 0);
    struct
    {
      Body   body;
      double rate;
    } cases[] = {{Body(maxwell(0.5)), 0.8},
                 {Body(perzyna(0.7, 0.2)), 4.},
                 {Body(zener(0.5, 0., 4.)), 0.25},
                 {Body(norton(0.1, 3., 10.)), 3 * 0.4 * 0.1 * 3 * 4},
                 {Body(norton(0.1, 3., 1.)), 3 * 0.4 * 0.1 * 3 * 1},
                 {Body(norton(0.1, 1., 1.)), 3 * 0.4 * 0.1},
                 // Most where flow goes on, at fixed strain, as it began.
                 {Body(perzyna(0.7, 0.2, 0.6)),
                  (0.8 + std::sqrt(2. / 3.) * 0.6) / 0.2}};
    for (const auto &c : cases)
      {
        const Tensor2 strain = stiffness.strain(1.5 * stress);
        EXPECT_NEAR(c.body.relaxation_rate(stress, strain), c.rate, 1e-13);
        EXPECT_NEAR(eigenvalue(c.body, stress, strain), c.rate, 1e-12);
      }

    // Inside the elastic range the rate is that of the flow which may begin
    // within the next step.
    const Body body(perzyna(0.7, 0.2));
    EXPECT_EQ(eigenvalue(body, symmetric(0.3, 0, 0)), 0.);
    EXPECT_NEAR(body.relaxation_rate(symmetric(0.3, 0, 0)), 4., 1e-13);
  }



  // Forward Euler at fixed strain on either side of the limit k = 2/r.
  TEST(Laws, RelaxationRateLimitsForwardEuler)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      if (c.lipschitz > 0)
        {
          SCOPED_TRACE(c.name);
          const State   state = random_state(c.body.stiffness, random);
          const Tensor2 start = 3. * state.stress;
          for (const double factor : {1.9, 20.})
            {
              Tensor2 stress = start;
              for (unsigned int n = 0;
                   n < 200 && stress.norm() < 100 * start.norm();
                   ++n)
                stress +=
                  factor / c.lipschitz * c.body.rate(stress, state.strain);
              if (factor < 2)
                EXPECT_LE(stress.norm(), 2 * start.norm());
              else
                EXPECT_GE(deviator(stress).norm(), 2 * start.norm());
            }
        }
  }



  // sigma' = G with the strain held: k steps of Euler multiply the excess of
  // the deviator by (1 - k r) each, and the pressure stays.
  TEST(Laws, RelaxationAtFixedStrain)
  {
    const Tensor2 start   = symmetric(2, 1, -6, 3, 0, 0);
    const double  length  = deviator(start).norm();
    const Tensor2 e       = deviator(start) / length;
    const Tensor2 average = trace(start) / 3 * unit_symmetric_tensor<3>();
    const double  k       = 0.05;

    for (const double yield_radius : {0., 0.7})
      {
        const Body body(perzyna(yield_radius, 0.2));
        Tensor2    stress = start;
        for (unsigned int n = 1; n <= 40; ++n)
          {
            stress += k * body.rate(stress);
            const double excess =
              (length - yield_radius) * std::pow(1 - k * 4., n);
            expect_near(stress, average + (yield_radius + excess) * e, 1e-13);
          }
      }
  }



  // The same plane deformation in three coordinate planes, with creep: the
  // stress must be the same up to the names of the axes, in particular the
  // normal stress out of the plane, which creeps although its strain is zero.
  TEST(Laws, PlaneStrainAgainstThreeDimensions)
  {
    const auto permute = [](const Tensor2                     &t,
                            const std::array<unsigned int, 3> &axes) {
      Tensor2 result;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j)
          result[axes[i]][axes[j]] = t[i][j];
      return result;
    };
    const auto history = [](const Body &body, const Tensor2 &strain_rate) {
      const double k = 0.02;
      Tensor2      strain, irreversible;
      for (unsigned int n = 0; n < 100; ++n)
        {
          const Tensor2 stress = stiffness.stress(strain) + irreversible;
          irreversible += k * body.rate(stress, strain);
          strain += k * strain_rate;
        }
      return stiffness.stress(strain) + irreversible;
    };

    const Tensor2 strain_rate = symmetric(1, -0.3, 0, 0.8);
    for (const Case &c : all_cases())
      if (c.body.stiffness.is_isotropic())
        {
          SCOPED_TRACE(c.name);
          const Tensor2 plane = history(c.body, strain_rate);
          EXPECT_EQ(plane[0][2], 0.);
          EXPECT_EQ(plane[1][2], 0.);
          // Elastically, or if all relaxes alike, it would be
          // nu (sigma_xx + sigma_yy).
          if (c.body.law->deviatoric_flow())
            {
              EXPECT_GT(std::fabs(plane[2][2] -
                                  0.25 * (plane[0][0] + plane[1][1])),
                        0.003);
            }

          for (const auto &axes : {std::array<unsigned int, 3>{{1, 2, 0}},
                                   std::array<unsigned int, 3>{{0, 2, 1}}})
            expect_near(history(c.body, permute(strain_rate, axes)),
                        permute(plane, axes),
                        1e-13);
        }
  }



  // (2.8), and with it that a step of Euler within the limit is a contraction:
  // in the scalar product of E^-1, -G is monotone with the constant r.
  TEST(Laws, LipschitzAndMonotone)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      if (c.lipschitz > 0)
        {
          SCOPED_TRACE(c.name);
          const auto product = [&c](const Tensor2 &a, const Tensor2 &b) {
            return a * c.body.stiffness.strain(b);
          };
          for (unsigned int i = 0; i < 200; ++i)
            {
              const Tensor2 strain = random();
              const Tensor2 a      = (i % 3 == 0 ? 0.5 : 3.) * random();
              const Tensor2 b      = (i % 2 == 0 ? 0.5 : 3.) * random();
              const Tensor2 Ga     = c.body.rate(a, strain);
              const Tensor2 Gb     = c.body.rate(b, strain);
              EXPECT_LE(std::sqrt(product(Ga - Gb, Ga - Gb)),
                        c.lipschitz * std::sqrt(product(a - b, a - b)) *
                          (1 + 1e-12));
              // With hardening, G is not monotone where the flow turns back.
              if (c.name.find("hardening") == std::string::npos)
                {
                  EXPECT_LE(product(a - b, Ga - Gb), 1e-14);
                }
            }
        }
  }



  // Flow dissipates, and preserves volume where it says so.
  TEST(Laws, Dissipation)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      {
        SCOPED_TRACE(c.name);
        double largest = 0;
        for (unsigned int i = 0; i < 200; ++i)
          {
            State        state = random_state(c.body.stiffness, random);
            const double power = c.body.dissipation(state.stress, state.strain);
            EXPECT_GE(power, -1e-15);
            largest                 = std::max(largest, power);
            const double dilatation = trace(
              c.body.stiffness.strain(c.body.rate(state.stress, state.strain)));
            if (c.body.law->deviatoric_flow())
              {
                EXPECT_NEAR(dilatation, 0, 1e-13); // of rates up to 10
              }
          }
        EXPECT_GT(largest, 0.01);
      }
  }



  TEST(Laws, EnergyBalance)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      for (unsigned int i = 0; i < 20; ++i)
        {
          SCOPED_TRACE(c.name);
          const State state = random_state(c.body.stiffness, random);
          EXPECT_NEAR(
            energy_balance_defect(c.body, state.stress, state.strain, random()),
            0.,
            1e-13);
        }
  }



  // SI units: nothing may depend on the size of the numbers.
  TEST(Laws, Scaling)
  {
    const double    stress_unit = 25e9, time_unit = 3e7;
    const Stiffness rock      = Stiffness::isotropic(stress_unit, 0.25);
    const Tensor2   stress    = symmetric(0.3, -0.2, 0.1, 0.5, 0.1, -0.4);
    const Tensor2   strain    = symmetric(0.3, 0.2, -0.2, 0.1, 0.4, -0.1);
    const double    viscosity = stress_unit * time_unit;

    const std::pair<Body, Body> pairs[] = {
      {Body(perzyna(0.1, 1., 0.2)),
       Body(perzyna(0.1 * stress_unit, viscosity, 0.2 * stress_unit), rock)},
      {Body(zener(0.5, 0.2, 1.)),
       Body(zener(0.5 * stress_unit, 0.2, time_unit), rock)},
      {Body(norton(1., 3., 0.5)),
       Body(
         norton(std::pow(stress_unit, -3.) / time_unit, 3., 0.5 * stress_unit),
         rock)},
      {Body(parsed("(sigma_eq + 0.1*eps_eq)*exp(-0.1*p)")),
       Body(parsed("(sigma_eq/25e9 + 0.1*eps_eq)*exp(-0.1*p/25e9)", "1/3e7"),
            rock)}};
    for (const auto &[unit, si] : pairs)
      {
        expect_near(si.rate(stress_unit * stress, strain) *
                      (time_unit / stress_unit),
                    unit.rate(stress, strain),
                    1e-13);
        EXPECT_NEAR(si.relaxation_rate(stress_unit * stress, strain) *
                      time_unit,
                    unit.relaxation_rate(stress, strain),
                    1e-9);
        const auto a = si.tangents(stress_unit * stress, strain);
        const auto b = unit.tangents(stress, strain);
        // The parsed law takes differences.
        EXPECT_LE((a.stress * time_unit - b.stress).norm(), 1e-8);
        EXPECT_LE((a.strain * (time_unit / stress_unit) - b.strain).norm(),
                  1e-8);
      }
  }



  TEST(Laws, NaNIsNotTakenForElastic)
  {
    const Tensor2 stress = symmetric(std::nan(""), 0, 0);
    for (const Case &c : all_cases())
      {
        Tensor2 rate;
        try
          {
            rate = c.body.rate(stress);
          }
        catch (const ExceptionBase &)
          {
            // Expressions are refused where they have no value.
            EXPECT_EQ(c.name.find("parsed"), 0u) << c.name;
            continue;
          }
        EXPECT_TRUE(std::isnan(rate[0][0])) << c.name;
      }
  }



  TEST(ExampleLaw, RateByHand)
  {
    // sinh(log 2) = 3/4, cosh(log 2) = 5/4.
    const Body body(garofalo(2., 1., 10.));
    expect_near(stiffness.strain(body.rate(symmetric(std::log(2.), 0, 0))),
                symmetric(-1.5, 0.75, 0.75),
                1e-14);
    EXPECT_NEAR(body.relaxation_rate(symmetric(std::log(2.), 0, 0)),
                1.5 * 0.8 * 2.5,
                1e-14);
    expect_near(Body(garofalo(2., 1., std::log(2.)))
                  .rate(symmetric(std::log(2.) + 1, 0, 0)),
                stiffness.stress(symmetric(-4, 2, 2)),
                1e-14);
  }



  // What the manual shows is what is compiled here, and the registry looks as
  // the manual says.
  TEST(ExampleLaw, IsTheOneInTheManual)
  {
    const auto contents = [](const std::string &name) {
      std::ifstream file(VISCOPLASTIC_CONTACT_SOURCE_DIR "/" + name);
      EXPECT_TRUE(file) << name;
      return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const std::string manual  = contents("doc/adding_a_law.md");
    const std::string example = contents("tests/unit/example_law.cc");
    EXPECT_NE(manual.find("```cpp\n" + example + "```\n"), std::string::npos);

    // Each line of the manual's list, the new one excepted.
    const std::string registry = contents("source/viscoplastic_law.cc");
    const std::size_t begin    = manual.find("#define VISCOPLASTIC_LAWS");
    ASSERT_NE(begin, std::string::npos);
    std::istringstream list(
      manual.substr(begin, manual.find("```", begin) - begin));
    std::string  line;
    unsigned int n_lines = 0;
    while (std::getline(list, line))
      if (line.find("garofalo") == std::string::npos)
        {
          EXPECT_NE(registry.find(line), std::string::npos) << line;
          ++n_lines;
        }
    EXPECT_EQ(n_lines, 6);
  }



  TEST(LawParameters, VaryInSpaceAndTime)
  {
    auto law = make_law("perzyna",
                        "set Yield radius = if(x < 1, 0.1, 0.2)\n"
                        "set Hardening modulus = z\n"
                        "set Viscosity = 1 + t");
    EXPECT_TRUE(law->depends_on_position());
    EXPECT_TRUE(law->depends_on_time());
    const LawPoint point = law->point(Point<3>(2, 0, 0.3), 4.);
    EXPECT_EQ(point.parameters[0], 0.2);
    EXPECT_EQ(point.parameters[1], 0.3);
    EXPECT_EQ(point.parameters[2], 5.);
    EXPECT_EQ(point.t, 4.);
    EXPECT_EQ(point.x, Point<3>(2, 0, 0.3));
    EXPECT_EQ(law->point(Point<3>(), 0.).parameters[0], 0.1);

    RandomTensors random;
    const Tensor2 stress = random(), strain = random();
    expect_near(law->rate(stress, strain, stiffness, point),
                Body(perzyna(0.2, 5., 0.3)).rate(stress, strain),
                1e-16);

    EXPECT_FALSE(maxwell(1.)->depends_on_position());
    EXPECT_FALSE(maxwell(1.)->depends_on_time());
  }



  TEST(LawParameters, AreRefusedOutsideTheirRange)
  {
    expect_refusal([] { make_law("maxwell", "set Viscosity = 0"); },
                   "'Material/maxwell/Viscosity' is 0; it must be positive.");
    expect_refusal([] { make_law("perzyna", "set Viscosity = -1e3"); },
                   "'Material/perzyna/Viscosity' is -1000; it must be "
                   "positive.");
    expect_refusal([] { make_law("perzyna", "set Yield radius = -0.1"); },
                   "'Material/perzyna/Yield radius' is -0.1; it must be zero "
                   "or positive.");
    expect_refusal([] { make_law("perzyna", "set Hardening modulus = -2"); },
                   "'Material/perzyna/Hardening modulus' is -2; it must be "
                   "zero or positive.");
    expect_refusal([] { make_law("maxwell", "set Viscosity = 1/0"); },
                   "The expression '1/0' of 'Material/maxwell/Viscosity' has "
                   "the value inf at x = (0 0 0), t = 0; it must be finite.");
    expect_refusal([] { make_law("maxwell", "set Viscosity = viscous"); },
                   "The expression 'viscous' of 'Material/maxwell/Viscosity' "
                   "cannot be parsed: Unexpected token \"viscous\" found at "
                   "position 0.");

    const auto law = make_law("maxwell", "set Viscosity = x - t");
    EXPECT_EQ(law->point(Point<3>(3, 0, 0), 1.).parameters[0], 2.);
    expect_refusal([&] { law->point(Point<3>(3, 0, 0), 4.); },
                   "'Material/maxwell/Viscosity' is -1 at x = (3 0 0), t = 4; "
                   "it must be positive.");
  }



  TEST(LawParameters, KnowNoZInThePlane)
  {
    EXPECT_NO_THROW(make_law("maxwell", "set Viscosity = 1 + x^2 + y", 2));
    EXPECT_NO_THROW(make_law("maxwell", "set Viscosity = 1 + z^2", 3));
    expect_refusal([] { make_law("maxwell", "set Viscosity = 1 + z^2", 2); },
                   "The expression '1 + z^2' of 'Material/maxwell/Viscosity' "
                   "cannot be parsed: Unexpected token \"z\" found at "
                   "position 4.");
  }



  TEST(Registry, NamesAndManual)
  {
    EXPECT_EQ(viscoplastic_law_names(),
              "elastic|maxwell|zener|perzyna|norton|parsed");

    const std::string manual = viscoplastic_law_help();
    for (const std::string name :
         {"elastic", "maxwell", "zener", "perzyna", "norton", "parsed"})
      EXPECT_NE(manual.find(name + ": G = "), std::string::npos) << name;
  }



  TEST(Registry, ElasticIsTheAbsenceOfALaw)
  {
    ParameterHandler prm;
    EXPECT_EQ(make_viscoplastic_law("elastic", prm), nullptr);
  }



  // All but the cap, which depends on the problem, have a default.
  TEST(Registry, Defaults)
  {
    for (const std::string name : {"maxwell", "zener", "perzyna", "parsed"})
      EXPECT_NO_THROW(Body(make_law(name))) << name;
    EXPECT_NO_THROW(Body(make_law("norton", "set Stress cap = 2")));
  }



  TEST(Registry, RefusesAnUnknownName)
  {
    ParameterHandler prm;
    expect_refusal([&] { make_viscoplastic_law("bingham", prm); },
                   "There is no viscoplastic law `bingham'; the laws are "
                   "elastic|maxwell|zener|perzyna|norton|parsed.");
  }



  // A refusal must leave the handler where the caller had it.
  TEST(Registry, RefusalLeavesTheSubsection)
  {
    ParameterHandler prm;
    declare_viscoplastic_law_parameters(prm);
    prm.parse_input_from_string(
      "subsection maxwell\n set Viscosity = -1\nend\n");
    EXPECT_THROW(make_viscoplastic_law("maxwell", prm), ExceptionBase);
    EXPECT_NE(make_viscoplastic_law("perzyna", prm), nullptr);
  }



  template <int dim>
  Material<dim>
  make_material(const std::string &entries)
  {
    ParameterHandler   prm;
    MaterialParameters parameters;
    prm.enter_subsection("Material 2");
    parameters.declare(prm);
    prm.leave_subsection();
    prm.parse_input_from_string("subsection Material 2\n" + entries +
                                "\nend\n");
    return Material<dim>("Material 2", parameters, prm);
  }

  const std::string plane_voigt_matrix =
    "set Voigt matrix = 5, 1, 2, 0, 0, 0.3; 1, 6, 3, 0, 0, 0.4; 2, 3, 7, 0, "
    "0, 0.5; 0, 0, 0, 8, 0.6, 0; 0, 0, 0, 0.6, 9, 0; 0.3, 0.4, 0.5, 0, 0, 10";



  TEST(Materials, Isotropic)
  {
    const auto material = make_material<2>("set Young's modulus = 1 + x\n"
                                           "set Poisson's ratio = 0.1*y");
    EXPECT_EQ(material.section, "Material 2");
    EXPECT_EQ(material.law_name, "elastic");
    EXPECT_EQ(material.law, nullptr);
    EXPECT_FALSE(material.is_uniform());
    const Stiffness expected = Stiffness::isotropic(4., 0.2);
    const Stiffness E        = material.stiffness(Point<2>(3., 2.));
    EXPECT_EQ(E.shear_modulus(), expected.shear_modulus());
    EXPECT_EQ(E.bulk_modulus(), expected.bulk_modulus());
    EXPECT_TRUE(make_material<3>("set Young's modulus = 2e9").is_uniform());
  }



  TEST(Materials, VoigtMatrix)
  {
    const auto plane = make_material<2>(plane_voigt_matrix);
    EXPECT_TRUE(plane.is_uniform());
    const Stiffness E = plane.stiffness(Point<2>());
    expect_near(E.stress(symmetric(1, 0, 0)), symmetric(5, 1, 2, 0.3), 1e-14);
    expect_near(E.stress(symmetric(0, 0, 0, 0.5)),
                symmetric(0.3, 0.4, 0.5, 10),
                1e-14);
    // A plane strain has no shear stress out of the plane.
    const Tensor2 stress = E.stress(symmetric(0.3, -0.4, 0, 0.7));
    EXPECT_EQ(stress[0][2], 0.);
    EXPECT_EQ(stress[1][2], 0.);

    // Coupling with yz, xz is for 3D only.
    std::string text = plane_voigt_matrix;
    text.replace(text.find("2, 3, 7, 0,"), 11, "2, 3, 7, 0.1,");
    text.replace(text.find("0, 0, 0, 8"), 10, "0, 0, 0.1, 8");
    EXPECT_NO_THROW(make_material<3>(text));
    expect_refusal([&] { make_material<2>(text); },
                   "'Material 2/Voigt matrix': the entry in row 3, column 4 "
                   "couples deformations in the plane with shear out of it; "
                   "it must be zero in plane strain (2D), or the scene be "
                   "3D.");
  }



  TEST(Materials, Refusals)
  {
    const auto refusal = [](const std::string &entries,
                            const std::string &sentence) {
      expect_refusal([&] { make_material<2>(entries); }, sentence);
    };
    refusal("set Young's modulus = -2e9",
            "'Material 2/Young's modulus' is -2e+09; it must be positive.");
    refusal("set Young's modulus = 1 + t",
            "'Material 2/Young's modulus' depends on t; elastic moduli must be "
            "functions of position only.");
    refusal("set Poisson's ratio = 0.5",
            "'Material 2/Poisson's ratio' is 0.5; it must be larger than -1 "
            "and smaller than 0.5.");
    refusal("set Poisson's ratio = -1", "'Material 2/Poisson's ratio' is -1;");
    refusal("set Poisson's ratio = z",
            "The expression 'z' of 'Material 2/Poisson's ratio' cannot be "
            "parsed: Unexpected token \"z\" found at position 0.");
    const auto material = make_material<2>("set Young's modulus = 1 - x\n"
                                           "set Poisson's ratio = 1/y");
    expect_refusal([&] { material.stiffness(Point<2>(1., 4.)); },
                   "'Material 2/Young's modulus' is 0 at x = (1 4); it must be "
                   "positive.");
    expect_refusal([&] { material.stiffness(Point<2>(0., 2.)); },
                   "'Material 2/Poisson's ratio' is 0.5 at x = (0 2); it must "
                   "be larger than -1 and smaller than 0.5.");
    expect_refusal([&] { material.stiffness(Point<2>(0., 0.)); },
                   "The expression '1/y' of 'Material 2/Poisson's ratio' has "
                   "the value inf at x = (0 0), t = 0; it must be finite.");

    refusal(plane_voigt_matrix + "\nset Poisson's ratio = 0.2",
            "'Material 2' has a `Voigt matrix' and Young's modulus or "
            "Poisson's ratio; give either the matrix or these.");
    refusal("set Voigt matrix = 1, 2, 3",
            "'Material 2/Voigt matrix': there must be 6 rows separated by "
            "semicolons, not 1.");
    refusal("set Voigt matrix = 1; 2; 3; 4; 5; 6",
            "'Material 2/Voigt matrix': row 1 must have 6 numbers separated by "
            "commas, not 1.");
    std::string text = plane_voigt_matrix;
    text.replace(text.find("10"), 2, "ten");
    refusal(text, "'Material 2/Voigt matrix': 'ten' in row 6 is not a number.");
    text = plane_voigt_matrix;
    text.replace(text.find("10"), 2, "-10");
    refusal(text,
            "'Material 2/Voigt matrix': The smallest eigenvalue of the elastic "
            "tensor that the Voigt matrix gives is -20.");
    text = plane_voigt_matrix;
    text.replace(text.find("0.3"), 3, "0.4");
    refusal(text,
            "'Material 2/Voigt matrix': The Voigt matrix has 0.4 in row 1, "
            "column 6, and 0.3 in row 6, column 1; it must be symmetric and "
            "finite.");
  }



  TEST(Materials, HaveALaw)
  {
    const auto material =
      make_material<2>("set Law = maxwell\n"
                       "subsection maxwell\n set Viscosity = 3*x\nend");
    EXPECT_EQ(material.law_name, "maxwell");
    ASSERT_NE(material.law, nullptr);
    EXPECT_EQ(material.law->point(Point<3>(2, 0, 0), 0.).parameters[0], 6.);

    ParameterHandler   prm;
    MaterialParameters parameters;
    prm.enter_subsection("Material 7");
    parameters.declare(prm);
    prm.leave_subsection();
    prm.parse_input_from_string("subsection Material 7\n"
                                "set Law = perzyna\n"
                                "subsection perzyna\n"
                                "set Viscosity = x - z\nend\nend\n");
    expect_refusal([&] { Material<2>("Material 7", parameters, prm); },
                   "The expression 'x - z' of 'Material 7/perzyna/Viscosity' "
                   "cannot be parsed: Unexpected token \"z\" found at "
                   "position 4.");
    // The handler is at the top again.
    EXPECT_NO_THROW(Material<3>("Material 7", parameters, prm));
  }
} // namespace
