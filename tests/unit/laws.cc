// SPDX-License-Identifier: LGPL-2.1-or-later

// The viscoplastic laws, their registry, and the elastic tensor they share.

#include <deal.II/lac/lapack_full_matrix.h>

#include <viscoplastic_contact/stiffness.h>
#include <viscoplastic_contact/viscoplastic_law.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iomanip>
#include <limits>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;

  using Tensor2 = SymmetricTensor<2, 3>;
  using Tensor4 = SymmetricTensor<4, 3>;

  // mu = 0.4, K = 2/3.
  const Stiffness stiffness = Stiffness::isotropic(1., 0.25);
  const LawPoint  origin;



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
  make_law(const std::string &name, const std::string &entries = "")
  {
    ParameterHandler prm;
    declare_viscoplastic_law_parameters(prm);
    prm.parse_input_from_string("subsection " + name + "\n" + entries +
                                "\nend\n");
    return make_viscoplastic_law(name, prm);
  }

  std::string
  exact(const double value)
  {
    std::ostringstream out;
    out << std::setprecision(17) << value;
    return out.str();
  }

  std::unique_ptr<ViscoplasticLaw>
  maxwell(const double viscosity)
  {
    return make_law("maxwell", "set Viscosity = " + exact(viscosity));
  }

  std::unique_ptr<ViscoplasticLaw>
  perzyna(const double yield_radius, const double viscosity)
  {
    return make_law("perzyna",
                    "set Yield radius = " + exact(yield_radius) +
                      "\nset Viscosity = " + exact(viscosity));
  }



  /// What every law with a deviatoric flow must satisfy, on some stresses.
  struct Case
  {
    std::string                      name;
    std::unique_ptr<ViscoplasticLaw> law;
    double                           rate;
    // Norms of the deviators to try, away from kinks.
    std::vector<double> deviators;
  };

  std::vector<Case>
  all_cases()
  {
    std::vector<Case> cases;
    cases.push_back({"maxwell", maxwell(0.5), 0.8, {0., 1e-3, 1., 1e3}});
    cases.push_back({"perzyna inside", perzyna(0.7, 0.2), 4., {0., 0.1, 0.69}});
    cases.push_back(
      {"perzyna outside", perzyna(0.7, 0.2), 4., {0.71, 1., 70.}});
    cases.push_back({"perzyna, k_Y = 0", perzyna(0., 0.2), 4., {1e-3, 1.}});
    return cases;
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
      {
        EXPECT_NEAR(matrix.eigenvalue(i).imag(), 0, 1e-6);
        largest = std::max(largest, matrix.eigenvalue(i).real());
      }
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
    expect_near(
      maxwell(0.5)->rate(symmetric(3, 0, 0, 1), {}, stiffness, origin),
      symmetric(-1.6, 0.8, 0.8, -0.8),
      1e-14);
    EXPECT_TRUE(maxwell(0.5)->deviatoric_flow());
  }



  TEST(Perzyna, RateByHand)
  {
    // |dev diag(3, 0, 0)| = sqrt(6): half of the deviator is in excess.
    expect_near(perzyna(std::sqrt(6.) / 2, 2.)
                  ->rate(symmetric(3, 0, 0), {}, stiffness, origin),
                symmetric(-0.4, 0.2, 0.2),
                1e-14);

    // |dev sigma| = sqrt(2) for the shear stress 1.
    const auto law = perzyna(0.1, 1.);
    expect_near(law->rate(symmetric(0, 0, 0, 0, 1), {}, stiffness, origin),
                symmetric(0, 0, 0, 0, -0.8 * (1 - 0.1 / std::sqrt(2.))),
                1e-14);

    // Elastic under any pressure, and up to the yield surface.
    expect_near(law->rate(symmetric(-9, -9, -9), {}, stiffness, origin), {}, 0);
    expect_near(law->rate(symmetric(0, 0, 0, 0.0707), {}, stiffness, origin),
                {},
                0);
    EXPECT_TRUE(law->deviatoric_flow());
  }



  TEST(Perzyna, WithoutElasticRangeIsMaxwell)
  {
    RandomTensors random;
    const auto    a = perzyna(0., 3.);
    const auto    b = maxwell(1.5);
    for (unsigned int i = 0; i < 10; ++i)
      {
        const Tensor2 stress = random();
        expect_near(a->rate(stress, {}, stiffness, origin),
                    b->rate(stress, {}, stiffness, origin),
                    1e-15);
      }
    expect_near(a->rate({}, {}, stiffness, origin), {}, 0);
  }



  TEST(Laws, TangentsAgainstCentralDifferences)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      for (const double deviator_norm : c.deviators)
        {
          SCOPED_TRACE(c.name + ", deviator " + std::to_string(deviator_norm));
          const Tensor2 stress = random.with_deviator(deviator_norm);
          const Tensor2 strain = random();
          const auto    tangents =
            c.law->tangents(stress, strain, stiffness, origin);
          const double h = 1e-5 * (deviator_norm > 0 ? deviator_norm : 1e-3);
          for (const Tensor2 &direction : basis())
            {
              const Tensor2 by_stress =
                (c.law->rate(
                   stress + h * direction, strain, stiffness, origin) -
                 c.law->rate(
                   stress - h * direction, strain, stiffness, origin)) /
                (2 * h);
              // Cancellation in the differences limits the accuracy.
              const double tolerance =
                1e-8 * c.rate + 1e-15 * c.rate * (stress.norm() + 1) / h;
              expect_near(tangents.stress * direction, by_stress, tolerance);

              const Tensor2 by_strain =
                (c.law->rate(
                   stress, strain + h * direction, stiffness, origin) -
                 c.law->rate(
                   stress, strain - h * direction, stiffness, origin)) /
                (2 * h);
              expect_near(tangents.strain * direction, by_strain, tolerance);
            }
        }
  }



  TEST(Laws, RelaxationRateIsTheLargestEigenvalue)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      for (const double deviator_norm : c.deviators)
        {
          SCOPED_TRACE(c.name + ", deviator " + std::to_string(deviator_norm));
          const Tensor2 stress = random.with_deviator(deviator_norm);
          const double  r =
            c.law->relaxation_rate(stress, {}, stiffness, origin);
          const double eigenvalue = largest_eigenvalue(
            -1. * c.law->tangents(stress, {}, stiffness, origin).stress);

          EXPECT_NEAR(r, c.rate, 1e-13 * c.rate);
          // Inside the elastic range the rate is that of the flow which may
          // begin within the next step.
          if (c.name == "perzyna inside")
            EXPECT_EQ(eigenvalue, 0.);
          else
            EXPECT_NEAR(eigenvalue, r, 1e-12 * r);
        }
  }



  // Forward Euler at fixed strain on either side of the limit k = 2/r.
  TEST(Laws, RelaxationRateLimitsForwardEuler)
  {
    const Tensor2 start = symmetric(2, -1, -1, 3, 0.5, -0.7);
    for (const Case &c : all_cases())
      {
        SCOPED_TRACE(c.name);
        const double r = c.law->relaxation_rate(start, {}, stiffness, origin);
        for (const double factor : {1.9, 2.5})
          {
            Tensor2 stress = start;
            for (unsigned int n = 0; n < 200; ++n)
              stress += factor / r * c.law->rate(stress, {}, stiffness, origin);
            if (factor < 2)
              EXPECT_LE(stress.norm(), 0.71);
            else
              EXPECT_GE(stress.norm(), 1.);
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
        const auto law    = perzyna(yield_radius, 0.2);
        Tensor2    stress = start;
        for (unsigned int n = 1; n <= 40; ++n)
          {
            stress += k * law->rate(stress, {}, stiffness, origin);
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
    const auto history = [](const ViscoplasticLaw &law,
                            const Tensor2         &strain_rate) {
      const double k = 0.02;
      Tensor2      strain, irreversible;
      for (unsigned int n = 0; n < 100; ++n)
        {
          const Tensor2 stress = stiffness.stress(strain) + irreversible;
          irreversible += k * law.rate(stress, strain, stiffness, origin);
          strain += k * strain_rate;
        }
      return stiffness.stress(strain) + irreversible;
    };

    const Tensor2 strain_rate = symmetric(1, -0.3, 0, 0.8);
    for (const Case &c : all_cases())
      {
        SCOPED_TRACE(c.name);
        const Tensor2 plane = history(*c.law, strain_rate);
        EXPECT_EQ(plane[0][2], 0.);
        EXPECT_EQ(plane[1][2], 0.);
        // Elastically it would be nu (sigma_xx + sigma_yy).
        EXPECT_GT(std::fabs(plane[2][2] - 0.25 * (plane[0][0] + plane[1][1])),
                  0.01);

        for (const auto &axes : {std::array<unsigned int, 3>{{1, 2, 0}},
                                 std::array<unsigned int, 3>{{0, 2, 1}}})
          expect_near(history(*c.law, permute(strain_rate, axes)),
                      permute(plane, axes),
                      1e-13);
      }
  }



  // (2.8), and with it that a step of Euler within the limit is a contraction:
  // in the scalar product of E^-1, -G is monotone with the constant r.
  TEST(Laws, LipschitzAndMonotone)
  {
    RandomTensors random;
    const auto    product = [](const Tensor2 &a, const Tensor2 &b) {
      return a * stiffness.strain(b);
    };
    for (const Case &c : all_cases())
      {
        SCOPED_TRACE(c.name);
        const double r = c.law->relaxation_rate({}, {}, stiffness, origin);
        for (unsigned int i = 0; i < 200; ++i)
          {
            const Tensor2 a  = (i % 3 == 0 ? 0.5 : 3.) * random();
            const Tensor2 b  = (i % 2 == 0 ? 0.5 : 3.) * random();
            const Tensor2 Ga = c.law->rate(a, {}, stiffness, origin);
            const Tensor2 Gb = c.law->rate(b, {}, stiffness, origin);

            EXPECT_LE(std::sqrt(product(Ga - Gb, Ga - Gb)),
                      r * std::sqrt(product(a - b, a - b)) * (1 + 1e-12));
            EXPECT_LE(product(a - b, Ga - Gb), 1e-14);
            // Viscous dissipation is never negative.
            EXPECT_LE(product(a, Ga), 1e-14);
            EXPECT_NEAR(trace(Ga), 0, 1e-13);
          }
      }
  }



  // SI units: nothing may depend on the size of the numbers.
  TEST(Laws, Scaling)
  {
    const double    stress_unit = 25e9, time_unit = 3e7;
    const Stiffness rock   = Stiffness::isotropic(stress_unit, 0.25);
    const Tensor2   stress = symmetric(0.3, -0.2, 0.1, 0.5, 0.1, -0.4);
    const auto      salt = perzyna(0.1 * stress_unit, stress_unit * time_unit);
    const auto      law  = perzyna(0.1, 1.);

    expect_near(salt->rate(stress_unit * stress, {}, rock, origin) *
                  (time_unit / stress_unit),
                law->rate(stress, {}, stiffness, origin),
                1e-14);
    EXPECT_NEAR(salt->relaxation_rate({}, {}, rock, origin) * time_unit,
                law->relaxation_rate({}, {}, stiffness, origin),
                1e-14);
  }



  TEST(Laws, NaNIsNotTakenForElastic)
  {
    const Tensor2 stress = symmetric(std::nan(""), 0, 0);
    for (const Case &c : all_cases())
      EXPECT_TRUE(std::isnan(c.law->rate(stress, {}, stiffness, origin)[0][0]))
        << c.name;
  }



  TEST(Registry, NamesAndManual)
  {
    EXPECT_EQ(viscoplastic_law_names(), "elastic|maxwell|perzyna");

    const std::string manual = viscoplastic_law_help();
    for (const std::string name : {"elastic", "maxwell", "perzyna"})
      EXPECT_NE(manual.find(name + ": G = "), std::string::npos) << name;
  }



  TEST(Registry, ElasticIsTheAbsenceOfALaw)
  {
    ParameterHandler prm;
    EXPECT_EQ(make_viscoplastic_law("elastic", prm), nullptr);
  }



  TEST(Registry, DefaultsAndSubsections)
  {
    ParameterHandler prm;
    declare_viscoplastic_law_parameters(prm);
    for (const std::string name : {"maxwell", "perzyna"})
      {
        EXPECT_NE(make_viscoplastic_law(name, prm), nullptr) << name;
        prm.enter_subsection(name);
        EXPECT_GT(prm.get_double("Viscosity"), 0);
        prm.leave_subsection();
      }
  }



  TEST(Registry, RefusesAnUnknownName)
  {
    ParameterHandler prm;
    expect_refusal([&] { make_viscoplastic_law("bingham", prm); },
                   "There is no viscoplastic law `bingham'; the laws are "
                   "elastic|maxwell|perzyna.");
  }



  TEST(Registry, RefusesParametersOutsideTheirRange)
  {
    expect_refusal([] { make_law("maxwell", "set Viscosity = 0"); },
                   "The entry `Viscosity' of the subsection `maxwell' is 0; "
                   "it must be positive and finite.");
    expect_refusal([] { make_law("perzyna", "set Viscosity = -1e3"); },
                   "The entry `Viscosity' of the subsection `perzyna' is "
                   "-1e3; it must be positive and finite.");
    expect_refusal([] { make_law("perzyna", "set Yield radius = -0.1"); },
                   "The entry `Yield radius' of the subsection `perzyna' is "
                   "-0.1; it must be zero or positive, and finite.");
    for (const std::string value : {"nan", "inf", "1e999", "viscous"})
      EXPECT_NE(message_of(
                  [&] { make_law("maxwell", "set Viscosity = " + value); }),
                "")
        << value;
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
} // namespace
