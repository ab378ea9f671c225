// SPDX-License-Identifier: LGPL-2.1-or-later

// The choice of time steps in runs to a tolerance, on model problems.

#include <viscoplastic_contact/time_stepping/step_control.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;

  constexpr double no_limit = std::numeric_limits<double>::infinity();



  /// Run to @p tolerance, relative to a solution of size 2, with errors of k^2
  /// times the @p rate at the beginning of steps. Returns the largest sum of
  /// errors and the number of steps.
  std::pair<double, unsigned int>
  run_to_tolerance(const double                                 tolerance,
                   const std::function<double(const double t)> &rate)
  {
    const TimeSchedule          schedule("10: 10");
    const StepControlParameters entries;
    StepControl                 control(
      entries, StiffnessPolicy::refuse, schedule, 1, 0., tolerance);
    EXPECT_TRUE(control.is_on);
    control.expect_size(2.);
    double       sum = 0., largest = 0., t = 0.;
    unsigned int n = 0;
    for (unsigned int tries = 0; t < 10. && tries < 100000; ++tries)
      {
        const TimeStep   step = control.propose(n, t, no_limit);
        const double     d    = rate(step.t_old) * step.k * step.k;
        const StepErrors errors{std::abs(d), 0., 2., std::abs(sum)};
        if (!control.accepts(step, errors, false))
          continue;
        sum += d;
        largest = std::max(largest, std::abs(sum));
        t       = step.t;
        ++n;
      }
    EXPECT_EQ(t, 10.);
    return {largest, n};
  }



  TEST(StepControl, ErrorsOfARunToAToleranceAddUpToLess)
  {
    // 10 * 10 / 0.2 = 500 equal steps would use up the tolerance.
    const auto same = run_to_tolerance(0.1, [](const double) { return 1.; });
    EXPECT_LT(same.first, 0.2);
    EXPECT_GT(same.first, 0.1);
    EXPECT_NEAR(same.second, 500., 150.);
    // Errors that cancel may be larger.
    const auto half =
      run_to_tolerance(0.1, [](const double t) { return t < 5. ? 1. : -1.; });
    EXPECT_LT(half.first, 1.05 * 0.2); // as far as the least rest allows
    EXPECT_LT(half.second, 0.8 * same.second);
    const auto often = run_to_tolerance(0.1, [](const double t) {
      return std::sin(8. * t) > 0. ? 1. : -1.;
    });
    EXPECT_LT(often.first, 0.2);
    EXPECT_LT(often.second, 0.5 * same.second);
  }



  TEST(StepControl, WhatIsFastButSmallHasFewSteps)
  {
    // Shares in proportion to time alone would take 0.1 / 2e-4 = 500 steps
    // before t = 0.1, with a hundredth of the allowed error.
    const auto [sum, n] = run_to_tolerance(0.1, [](const double t) {
      return t < 0.1 ? 100. : 0.01;
    });
    EXPECT_LT(sum, 0.2);
    EXPECT_LT(n, 150u);
  }



  TEST(StepControl, StepThatIsRepeatedIsTheSame)
  {
    const TimeSchedule          schedule("10: 10");
    const StepControlParameters entries;
    StepControl control(entries, StiffnessPolicy::refuse, schedule, 1, 0., 0.1);
    control.expect_size(1.);
    double t = 0.;
    for (unsigned int n = 0; n < 20; ++n)
      {
        TimeStep         step = control.propose(n, t, no_limit);
        const StepErrors errors{0.1 * step.k * step.k, 0., 1., 1e-4 * n};
        while (!control.accepts(step, errors, false))
          step = control.propose(n, t, no_limit);
        const TimeStep next = control.propose(n + 1, step.t, no_limit);
        control.repeat();
        const TimeStep again = control.propose(n, t, no_limit);
        EXPECT_EQ(again.k, step.k);
        // Relaxation after a change of mesh neither rejects nor shortens steps
        // unless it uses too much of the remaining tolerance.
        StepErrors shock = errors;
        shock.indicator  = 0.01;
        EXPECT_TRUE(control.accepts(again, shock, false));
        EXPECT_EQ(control.propose(n + 1, step.t, no_limit).k, next.k);
        if (step.k > 2e-5) // the smallest step is accepted anyway
          {
            control.repeat();
            shock.indicator = 0.09;
            EXPECT_FALSE(control.accepts(again, shock, false));
            EXPECT_LT(control.propose(n, t, no_limit).k, step.k);
            EXPECT_TRUE(control.accepts(again, errors, false));
          }
        t = step.t;
      }
  }
} // namespace
