// SPDX-License-Identifier: LGPL-2.1-or-later

// Derivatives of exact solutions, which are difference quotients, against
// closed forms.

#include <viscoplastic_contact/scene/exact_solution.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Viscoplastic;
  using Side = ExactSolution<2>::Side;

  constexpr double accuracy = 1e-7; // difference quotients have about 1e-8

  ExactSolution<2>
  solution()
  {
    ExactSolutionParameters parameters;
    parameters.displacement = "sin(t)*x*y; cos(2*x)*t^2";
    parameters.stress       = "x^2*t; y^2; t; sin(x+2*y)*exp(t)";
    parameters.data         = DataSource::solution;
    ExactSolution<2> result(parameters, 2.);
    result.set_body(1.5, nullptr);
    return result;
  }



  const Point<2>   x(0.3, 0.7);
  constexpr double t = 0.4;



  TEST(ExactSolution, Strain)
  {
    const auto strain = solution().strain(x, t);
    EXPECT_NEAR(strain[0][0], std::sin(t) * x[1], accuracy);
    EXPECT_NEAR(strain[1][1], 0., accuracy);
    EXPECT_NEAR(strain[0][1],
                0.5 * (std::sin(t) * x[0] - 2. * std::sin(2. * x[0]) * t * t),
                accuracy);
    for (unsigned int d = 0; d < 3; ++d)
      EXPECT_EQ(strain[2][d], 0.);
  }



  TEST(ExactSolution, BodyForceBalancesStress)
  {
    const auto   force = solution().body_force(x, t);
    const double c     = std::cos(x[0] + 2. * x[1]) * std::exp(t);
    EXPECT_NEAR(force[0], -(2. * x[0] * t + 2. * c), accuracy);
    EXPECT_NEAR(force[1], -(2. * x[1] + c), accuracy);
  }



  TEST(ExactSolution, TractionIsOnTheOuterSide)
  {
    Tensor<1, 2> normal;
    normal[1]           = -1.;
    const auto traction = solution().traction(x, normal, t);
    EXPECT_NEAR(traction[0], -std::sin(x[0] + 2. * x[1]) * std::exp(t), 1e-14);
    EXPECT_NEAR(traction[1], -x[1] * x[1], 1e-14);
  }



  TEST(ExactSolution, RatesFromBothSides)
  {
    for (const Side side : {Side::after, Side::before})
      {
        const auto velocity = solution().velocity(x, t, side);
        EXPECT_NEAR(velocity[0], std::cos(t) * x[0] * x[1], accuracy);
        EXPECT_NEAR(velocity[1], std::cos(2. * x[0]) * 2. * t, accuracy);
        const auto rate = solution().stress_rate(x, t, side);
        EXPECT_NEAR(rate[0][0], x[0] * x[0], accuracy);
        EXPECT_NEAR(rate[2][2], 1., accuracy);
        const auto strain_rate = solution().strain_rate(x, t, side);
        EXPECT_NEAR(strain_rate[0][0], std::cos(t) * x[1], accuracy);
      }
  }



  TEST(ExactSolution, KinksHaveTwoRates)
  {
    ExactSolutionParameters parameters;
    parameters.displacement = "min(t,1)*y; 0";
    parameters.stress       = "0; 0; 0; min(t,1)";
    ExactSolution<2> kink(parameters, 2.);
    kink.set_body(1., nullptr);
    EXPECT_NEAR(kink.velocity(x, 1., Side::before)[0], x[1], accuracy);
    EXPECT_NEAR(kink.velocity(x, 1., Side::after)[0], 0., accuracy);
    EXPECT_NEAR(kink.stress_rate(x, 1., Side::before)[0][1], 1., accuracy);
    EXPECT_NEAR(kink.stress_rate(x, 1., Side::after)[0][1], 0., accuracy);
    EXPECT_NO_THROW(kink.check_rates(x, 1.));
  }



  TEST(ExactSolution, RefusesVerticalTangents)
  {
    for (const std::string u : {"sqrt(t)*y; 0", "t^0.9; 0"})
      {
        ExactSolutionParameters parameters;
        parameters.displacement = u;
        ExactSolution<2> steep(parameters, 2.);
        EXPECT_THROW(steep.check_rates(x, 0.), ExceptionBase) << u;
      }
    EXPECT_NO_THROW(solution().check_rates(x, 0.));
  }
} // namespace
