// SPDX-License-Identifier: LGPL-2.1-or-later

// Properties that all laws must have.

#include "law_bodies.h"
#include <viscoplastic_contact/laws/arrhenius.h>

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  /// A law in a body, with its bound.
  struct Case
  {
    std::string name;
    FlowingBody body;
    /// A bound of r for all stresses; zero if there is none.
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
        // The sum of the moduli over the viscosities.
        const std::string kelvin = "set Maxwell viscosity = 0.5\nset Kelvin "
                                   "modulus = 0.3\nset Kelvin viscosity = 0.2";
        add("burgers", make_law("burgers", kelvin), 3.5 * r + 1.5);
        // 1/(2 eta) at the cap, times 1 - m sigma_eq.
        add("lubby2",
            make_law("lubby2",
                     kelvin +
                       "\nset Maxwell viscosity exponent = -0.3\nset Kelvin "
                       "modulus exponent = -0.2\nset Kelvin viscosity exponent "
                       "= -0.4\nset Stress cap = 1.5"),
            (std::exp(0.45) * 1.45 + 2.5 * std::exp(0.6) * 1.6) * r +
              1.5 * std::exp(0.6));
        // At the temperature 2 it flows 1.2 times as fast as at 1.6.
        for (const bool hardens : {false, true})
          add(hardens ? "perzyna by temperature" : "norton by temperature",
              thermally_activated(hardens ? perzyna(0.5, 0.2, 0.3) :
                                            norton(0.2, 3., 1.5),
                                  std::log(1.2) / (1. / 1.6 - 1. / 2.),
                                  1.6),
              1.2 * (hardens ? 5 * r + 1.5 * std::sqrt(2. / 3.) * ratio :
                               1.5 * r * 0.2 * 3. * 2.25));
        add("norton, A = T/10",
            make_law("norton",
                     "set Rate factor = 0.1*T\nset Exponent = 3\n"
                     "set Stress cap = 1.5"),
            1.5 * r * 0.2 * 3. * 2.25);
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



  TEST(Laws, FlowOfACellIsThatOfItsPoints)
  {
    RandomTensors random;
    for (const Case &c : all_cases())
      {
        SCOPED_TRACE(c.name);
        const FlowingBody    &body = c.body;
        std::vector<Tensor2>  stress, strain;
        std::vector<LawPoint> points(8, body.point);
        for (unsigned int i = 0; i < points.size(); ++i)
          {
            const State state = random_state(body.stiffness, random);
            stress.push_back(i == 0 ? Tensor2() : state.stress);
            strain.push_back(state.strain);
          }
        // The parameters of the last point differ.
        points.back().parameters[0] *= 2.;
        std::vector<Flow> flow(points.size());
        body.law->flow(
          {8, stress.data(), strain.data(), points.data(), body.stiffness},
          flow.data());
        for (unsigned int i = 0; i < points.size(); ++i)
          {
            const Tensor2 rate =
              body.law->rate(stress[i], strain[i], body.stiffness, points[i]);
            expect_near(flow[i].rate, rate, 1e-14 * (1. + rate.norm()));
            const double r = body.law->relaxation_rate(stress[i],
                                                       strain[i],
                                                       body.stiffness,
                                                       points[i]);
            EXPECT_NEAR(flow[i].relaxation_rate, r, 1e-14 * (1. + r));
            EXPECT_EQ(flow[i].is_beyond_cap,
                      body.law->is_beyond_cap(stress[i], points[i]));
          }
      }
  }



  /// G is the law's rate times exp(-Q/R (1/T - 1/T_L)), and parameters may
  /// depend on T. All bodies here have T = 2.
  TEST(Laws, RatesByTemperature)
  {
    RandomTensors     random;
    const FlowingBody cold(norton(0.2, 3., 1.5)),
      hot(thermally_activated(norton(0.2, 3., 1.5), 3., 1.6)),
      boundless(thermally_activated(norton(0.2, 3., 1.5),
                                    3.,
                                    std::numeric_limits<double>::infinity())),
      of_T(make_law("norton",
                    "set Rate factor = 0.1*T\nset Exponent = 3\n"
                    "set Stress cap = 1.5"));
    EXPECT_TRUE(hot.law->depends_on_temperature());
    EXPECT_TRUE(of_T.law->depends_on_temperature());
    EXPECT_FALSE(cold.law->depends_on_temperature());
    for (unsigned int i = 0; i < 5; ++i)
      {
        const Tensor2 stress = random();
        const Tensor2 rate   = cold.rate(stress);
        const double  small  = 1e-14 * rate.norm();
        expect_near(hot.rate(stress),
                    std::exp(-3. * (1. / 2. - 1. / 1.6)) * rate,
                    10. * small);
        expect_near(boundless.rate(stress), std::exp(-1.5) * rate, small);
        expect_near(of_T.rate(stress), rate, small);
      }
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



  // Tangents are one-sided at kinks; some states are close to zero stress.
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



  // Rates by closed form; in isotropic bodies they are the largest eigenvalue.
  TEST(Laws, RelaxationRatesByHand)
  {
    const auto eigenvalue = [](const FlowingBody &body,
                               const Tensor2     &stress,
                               const Tensor2     &strain = {}) {
      return largest_eigenvalue(body.tangents(stress, strain).stress);
    };
    const Tensor2 stress = symmetric(2, 0, 0);
    struct
    {
      FlowingBody body;
      double      rate;
    } cases[] = {{FlowingBody(maxwell(0.5)), 0.8},
                 {FlowingBody(perzyna(0.7, 0.2)), 4.},
                 {FlowingBody(zener(0.5, 0., 4.)), 0.25},
                 {FlowingBody(norton(0.1, 3., 10.)), 3 * 0.4 * 0.1 * 3 * 4},
                 {FlowingBody(norton(0.1, 3., 1.)), 3 * 0.4 * 0.1 * 3 * 1},
                 {FlowingBody(norton(0.1, 1., 1.)), 3 * 0.4 * 0.1},
                 // The rate is largest where flow continues in its direction.
                 {FlowingBody(perzyna(0.7, 0.2, 0.6)),
                  (0.8 + std::sqrt(2. / 3.) * 0.6) / 0.2}};
    for (const auto &c : cases)
      {
        const Tensor2 strain = stiffness.strain(1.5 * stress);
        EXPECT_NEAR(c.body.relaxation_rate(stress, strain), c.rate, 1e-13);
        EXPECT_NEAR(eigenvalue(c.body, stress, strain), c.rate, 1e-12);
      }

    // Inside the elastic range the rate is that of the flow which may begin
    // within the next step.
    const FlowingBody body(perzyna(0.7, 0.2));
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
    const auto history = [](const FlowingBody &body,
                            const Tensor2     &strain_rate) {
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
          // Without flow, or if all modes relax alike, sigma_zz would be nu
          // (sigma_xx + sigma_yy).
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
              // With hardening, G is not monotone where flow reverses.
              if (c.name.find("hardening") == std::string::npos)
                {
                  EXPECT_LE(product(a - b, Ga - Gb), 1e-14);
                }
            }
        }
  }



  // Flow dissipates energy, and preserves volume if deviatoric_flow().
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

    const std::pair<FlowingBody, FlowingBody> pairs[] = {
      {FlowingBody(perzyna(0.1, 1., 0.2)),
       FlowingBody(perzyna(0.1 * stress_unit, viscosity, 0.2 * stress_unit),
                   rock)},
      {FlowingBody(zener(0.5, 0.2, 1.)),
       FlowingBody(zener(0.5 * stress_unit, 0.2, time_unit), rock)},
      {FlowingBody(norton(1., 3., 0.5)),
       FlowingBody(
         norton(std::pow(stress_unit, -3.) / time_unit, 3., 0.5 * stress_unit),
         rock)},
      {FlowingBody(parsed("(sigma_eq + 0.1*eps_eq)*exp(-0.1*p)")),
       FlowingBody(parsed("(sigma_eq/25e9 + 0.1*eps_eq)*exp(-0.1*p/25e9)",
                          "1/3e7"),
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
} // namespace
