// SPDX-License-Identifier: LGPL-2.1-or-later

// Each law by itself: rates, tangents and energies by hand.

#include "law_bodies.h"
#include "refusals.h"

#include <gtest/gtest.h>


namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  TEST(Maxwell, RateByHand)
  {
    // mu/eta = 0.8; dev sigma = diag(2, -1, -1) + shear 1.
    const FlowingBody body(maxwell(0.5));
    expect_near(body.rate(symmetric(3, 0, 0, 1)),
                symmetric(-1.6, 0.8, 0.8, -0.8),
                1e-14);
    EXPECT_TRUE(body.law->deviatoric_flow());
  }



  TEST(Perzyna, RateByHand)
  {
    // |dev diag(3, 0, 0)| = sqrt(6), of which half exceeds the yield radius.
    expect_near(
      FlowingBody(perzyna(std::sqrt(6.) / 2, 2.)).rate(symmetric(3, 0, 0)),
      symmetric(-0.4, 0.2, 0.2),
      1e-14);

    // |dev sigma| = sqrt(2) for the shear stress 1.
    const FlowingBody body(perzyna(0.1, 1.));
    expect_near(body.rate(symmetric(0, 0, 0, 0, 1)),
                symmetric(0, 0, 0, 0, -0.8 * (1 - 0.1 / std::sqrt(2.))),
                1e-14);

    // The body is elastic under any pressure and inside the yield surface.
    expect_near(body.rate(symmetric(-9, -9, -9)), {}, 0);
    expect_near(body.rate(symmetric(0, 0, 0, 0.0707)), {}, 0);
    EXPECT_TRUE(body.law->deviatoric_flow());
  }



  TEST(Perzyna, HardeningByHand)
  {
    // A viscoplastic shear strain of 0.3 has |d| = 0.3 sqrt(2), so that
    // R = 0.1 sqrt(2) + 0.5 sqrt(2/3) 0.3 sqrt(2); stress 1 in shear.
    const FlowingBody body(perzyna(0.1 * std::sqrt(2.), 1., 0.5));
    const Tensor2     stress = symmetric(0, 0, 0, 1);
    const Tensor2 strain = stiffness.strain(stress) + symmetric(0, 0, 0, 0.3);
    const double  R      = 0.1 + 0.5 * std::sqrt(2. / 3.) * 0.3;
    expect_near(body.rate(stress, strain),
                symmetric(0, 0, 0, -0.8 * (1 - R)),
                1e-14);
    // Volumetric strain does not harden; the sign of the strain is irrelevant.
    expect_near(body.rate(stress, strain + symmetric(1, 1, 1)),
                body.rate(stress, strain),
                1e-14);
    expect_near(body.rate(stress, strain - symmetric(0, 0, 0, 0.6)),
                body.rate(stress, strain),
                1e-14);
    // There is no flow inside the hardened elastic range.
    expect_near(body.rate(0.9 * R * stress,
                          stiffness.strain(0.9 * R * stress) +
                            symmetric(0, 0, 0, 0.3)),
                {},
                0);
  }



  TEST(Perzyna, WithoutElasticRangeIsMaxwell)
  {
    RandomTensors     random;
    const FlowingBody a(perzyna(0., 3.));
    const FlowingBody b(maxwell(1.5));
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
    const FlowingBody body(zener(0.5, 0., 2.));
    expect_near(body.rate(symmetric(3, 0, 0, 1), symmetric(2, 4, 0, 0.4)),
                symmetric(-1, 1, 0, -0.4),
                1e-14);
    EXPECT_EQ(body.relaxation_rate(), 0.5);
    EXPECT_FALSE(body.law->deviatoric_flow());

    expect_near(FlowingBody(zener(0., 0.3, 2.)).rate(symmetric(3, 0, 0, 1)),
                symmetric(-1.5, 0, 0, -0.5),
                1e-15);
  }



  // A spring of E_inf beside one of E - E_inf with a dashpot: after a step of
  // strain the stress falls from E eps to E_inf eps, and what the second
  // spring held is dissipated.
  TEST(Zener, EnergyByHand)
  {
    const FlowingBody body(zener(0.5, 0.25, 2.)); // E_inf = E/2
    const Tensor2     strain = symmetric(0.1, -0.05, 0, 0.2, 0, 0.07);
    const Tensor2     stress = stiffness.stress(strain);
    const double      energy = 0.5 * (stress * strain);
    EXPECT_TRUE(body.law->has_own_energy());
    EXPECT_NEAR(body.stored_energy(stress, strain), energy, 1e-16);
    EXPECT_NEAR(body.stored_energy(0.5 * stress, strain), energy / 2, 1e-16);
    EXPECT_NEAR(body.stored_energy(0.75 * stress, strain),
                energy / 2 + energy / 8,
                1e-16);
    // The second spring has the whole strain at first, and none at the end.
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



  // With E_inf = E for pressure, that mode has no second spring. Its energy is
  // 1/2 E^-1 sigma : sigma, also with an initial pressure.
  TEST(Zener, PressureThatDoesNotRelax)
  {
    EXPECT_NEAR(Stiffness::isotropic(6. / 11, 4. / 11).bulk_modulus(),
                stiffness.bulk_modulus(),
                1e-15);
    for (const Stiffness &E : {stiffness, as_matrix()})
      {
        const FlowingBody body(zener(6. / 11, 4. / 11, 0.5), E);
        const Tensor2     I      = unit_symmetric_tensor<3>();
        const Tensor2     shear  = symmetric(0, 0, 0, 0.1);
        const Tensor2     strain = 0.1 * I + shear;
        const Tensor2     stress = E.stress(strain);
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
        const FlowingBody body(zener(1., 0.25, 0.5), E);
        const Tensor2     stress = random(), strain = random();
        expect_near(body.law->driving_strain(stress, strain, E, body.point),
                    E.strain(stress),
                    1e-14);
        EXPECT_NEAR(body.stored_energy(stress, strain),
                    0.5 * (stress * E.strain(stress)),
                    1e-14);
      }
  }



  // The energy is balanced for an initial stress in any mode.
  TEST(Zener, EnergyBalanceWhereModesDoNotRelax)
  {
    // E is E_inf plus three modes that are no eigenvectors of E_inf.
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

    const FlowingBody bodies[] = {
      {zener(6. / 11, 4. / 11, 0.5), stiffness},
      {zener(6. / 11, 4. / 11, 0.5), as_matrix()},
      {zener(0.8, 0., 0.5), stiffness}, // mu_inf = mu, K_inf < K
      {zener(1., 0.25, 0.5), stiffness},
      {zener(1., 0.25, 0.5), as_matrix()},
      {zener(0.5, 0.25, 0.5), Stiffness::anisotropic(matrix)}};
    RandomTensors random;
    for (const FlowingBody &body : bodies)
      for (unsigned int i = 0; i < 10; ++i)
        EXPECT_NEAR(energy_balance_defect(body, random(), random(), random()),
                    0.,
                    1e-13);
  }



  TEST(Zener, MatrixOfAnIsotropicBody)
  {
    const FlowingBody a(zener(0.4, 0.1, 0.5)),
      b(zener(0.4, 0.1, 0.5), as_matrix());
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
    expect_refusal([] { FlowingBody(zener(1.2, 0.25, 1.)); },
                   "'Material/zener/Long-term Young's modulus' = 1.2 with "
                   "Poisson's ratio 0.25 makes the body stiffer in the long "
                   "term than at once, at x = (0 0 0): Young's modulus is 1; "
                   "it must not be below the long-term one.");
    // Young's modulus is smaller, the bulk modulus larger.
    expect_refusal([] { FlowingBody(zener(0.9, 0.4, 1.)); },
                   "the ratio must be at least 0.125 and at most 0.275.");
    expect_refusal([] { FlowingBody(zener(0.9, 0.4, 1.), as_matrix()); },
                   "makes the body stiffer in the long term than at once");
    EXPECT_NO_THROW(FlowingBody(zener(1., 0.25, 1.)));
    EXPECT_NO_THROW(FlowingBody(zener(0.4, 0.1, 1.), triclinic()));
    expect_refusal([] { FlowingBody(zener(1., 0.25, 1.), triclinic()); },
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
    const FlowingBody body(norton(3., 3., 10.));
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
        expect_near(FlowingBody(norton(3., 1., 1.)).rate(stress),
                    FlowingBody(maxwell(1. / 9)).rate(stress),
                    1e-14);
      }
  }



  TEST(Norton, TangentBeyondTheCap)
  {
    // 3*2^3 + 3*3*2^2 (sigma - 2)
    const FlowingBody body(norton(3., 3., 2.));
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

    const FlowingBody salt(norton(1e-40, 5., 5e7), rock);
    expect_near(rock.strain(salt.rate(1e7 * unit)), -1.5e-5 * unit, 1e-18);
    // sigma^(n - 1) is 1e294, and 1e336 at ten times the stress.
    const FlowingBody stiff(norton(1e-300, 43., 5e8), rock);
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
    const FlowingBody none(norton(0., 1., 1.), rock);
    expect_near(none.rate(1e7 * unit), {}, 0);
    expect_near(none.tangents(1e7 * unit).stress * unit, {}, 0);
  }



  TEST(Parsed, RateByHand)
  {
    // sigma_eq = 2, p = -2/3.
    const FlowingBody body(parsed("sigma_eq^3 - 3*p + 0*t", "3"));
    expect_near(stiffness.strain(body.rate(symmetric(2, 0, 0))),
                symmetric(-30, 15, 15),
                1e-13);
    // eps_eq of a viscoplastic tension diag(2, -1, -1) is 2.
    const Tensor2 stress = symmetric(2, 0, 0);
    expect_near(stiffness.strain(
                  FlowingBody(parsed("eps_eq"))
                    .rate(stress,
                          stiffness.strain(stress) + symmetric(2, -1, -1))),
                symmetric(-2, 1, 1),
                1e-14);
    // Without a direction there is no flow.
    expect_near(FlowingBody(parsed("1")).rate(symmetric(1, 1, 1)), {}, 0);
    EXPECT_TRUE(body.law->deviatoric_flow());
  }



  TEST(Parsed, IsNortonForThePower)
  {
    RandomTensors random;
    for (const Stiffness &E : {stiffness, triclinic()})
      {
        const FlowingBody a(parsed("sigma_eq^3", "0.2"), E);
        const FlowingBody b(norton(0.2, 3., 100.), E);
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
                   "rate' cannot be parsed: there is no 'q'; its variables are "
                   "sigma_eq, p, eps_eq, T and t, and pi");
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
    const FlowingBody body(parsed("sigma_eq*(1 - t)"),
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



  TEST(Laws, TangentsAtKinks)
  {
    const auto check = [](const FlowingBody &body,
                          const Tensor2     &stress,
                          const Tensor2     &strain) {
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
          check(FlowingBody(perzyna(0.7, 0.2), E), stress, {});
          // A von Mises cap of 0.7 sqrt(3/2) is |dev sigma| = 0.7.
          check(FlowingBody(norton(0.5, 3., 0.7 * std::sqrt(1.5)), E),
                stress,
                {});
          // The hardened yield radius is 0.7 at this viscoplastic strain.
          check(FlowingBody(perzyna(0.5, 0.2, 0.5), E),
                stress,
                E.strain(stress) + 0.4 * std::sqrt(1.5) /
                                     deviator(stress).norm() *
                                     deviator(stress));
          check(FlowingBody(parsed("max(0, sigma_eq - 0.7*sqrt(3/2))"), E),
                stress,
                {});
        }

    for (const FlowingBody &body : {FlowingBody(perzyna(0., 0.2)),
                                    FlowingBody(norton(1., 1., 1.)),
                                    FlowingBody(norton(1., 2., 1.)),
                                    FlowingBody(parsed("sigma_eq"))})
      {
        // Rounding of a pressure would exceed such a small stress.
        check(body, deviator(random.with_deviator(1e-9)), {});
        const Tensor4 at_zero = body.tangents({}).stress;
        EXPECT_NEAR(largest_eigenvalue(at_zero),
                    body.relaxation_rate({}),
                    1e-12);
      }
  }



  TEST(Laws, RelaxationAtFixedStrain)
  {
    const Tensor2 start   = symmetric(2, 1, -6, 3, 0, 0);
    const double  length  = deviator(start).norm();
    const Tensor2 e       = deviator(start) / length;
    const Tensor2 average = trace(start) / 3 * unit_symmetric_tensor<3>();
    const double  k       = 0.05;

    for (const double yield_radius : {0., 0.7})
      {
        const FlowingBody body(perzyna(yield_radius, 0.2));
        Tensor2           stress = start;
        for (unsigned int n = 1; n <= 40; ++n)
          {
            stress += k * body.rate(stress);
            const double excess =
              (length - yield_radius) * std::pow(1 - k * 4., n);
            expect_near(stress, average + (yield_radius + excess) * e, 1e-13);
          }
      }
  }
} // namespace
