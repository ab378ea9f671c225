// SPDX-License-Identifier: LGPL-2.1-or-later

// The choice of time steps on model problems.

#include <viscoplastic_contact/time_stepping/step_control.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;

  constexpr double infinity = std::numeric_limits<double>::infinity();



  StepControlParameters
  with_tolerance(const double tolerance)
  {
    StepControlParameters parameters;
    parameters.tolerance = tolerance;
    return parameters;
  }



  /// The accepted steps of a run whose errors are a function of the step.
  std::vector<TimeStep>
  steps(StepControl                                       &control,
        const double                                       end,
        const std::function<StepErrors(const TimeStep &)> &errors,
        const std::function<bool(const TimeStep &)>       &event = {},
        const double                                       limit = infinity)
  {
    std::vector<TimeStep> result;
    double                t = 0.;
    for (unsigned int tries = 0; t < end && tries < 100000; ++tries)
      {
        const TimeStep step = control.propose(result.size(), t, limit);
        EXPECT_EQ(step.n, result.size() + 1);
        EXPECT_EQ(step.t_old, t);
        EXPECT_EQ(step.k, step.t - t);
        if (control.accepts(step, errors(step), event && event(step)))
          {
            result.push_back(step);
            t = step.t;
          }
      }
    EXPECT_EQ(t, end);
    return result;
  }



  double
  largest(const std::vector<TimeStep> &of, const double after = 0.)
  {
    double k = 0.;
    for (const TimeStep &step : of)
      if (step.t_old >= after)
        k = std::max(k, step.k);
    return k;
  }



  TEST(StepControl, WithoutToleranceStepsAreThoseOfThePhases)
  {
    const TimeSchedule          schedule("1: 3, 1.7: 7, 4: 1");
    const StepControlParameters off;
    StepControl control(off, StiffnessPolicy::refuse, schedule, 1, 0.);
    EXPECT_FALSE(control.may_reject());
    double t = 0.;
    for (unsigned int n = 0; n < schedule.n_steps(); ++n)
      {
        const TimeStep is     = control.propose(n, t, infinity),
                       wanted = schedule.step(n + 1);
        EXPECT_EQ(is.t, wanted.t);
        EXPECT_EQ(is.k, wanted.k);
        EXPECT_TRUE(control.accepts(is, {1e9, 0., 0.}, true));
        t = is.t;
      }
    EXPECT_EQ(t, 4.);
  }



  TEST(StepControl, NextTimesOfManyStepsAreExact)
  {
    const TimeSchedule schedule("0.1: 7, 3.3: 100003");
    double             t = 0.;
    for (unsigned int n = 1; n <= schedule.n_steps(); ++n)
      {
        ASSERT_EQ(schedule.next_time(t), schedule.step(n).t) << n;
        t = schedule.step(n).t;
      }
    EXPECT_EQ(schedule.phase_ending_at(0.1), 1u);
    EXPECT_EQ(schedule.phase_ending_at(3.3), 2u);
    EXPECT_EQ(schedule.phase_ending_at(0.2), 0u);
  }



  TEST(StepControl, WhatSolversLeaveChoosesNoOtherSteps)
  {
    const TimeSchedule schedule("10: 10");
    const auto         parameters = with_tolerance(0.1);
    const auto         run        = [&](const double noise) {
      StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
      unsigned int n = 0;
      return steps(control, 10., [&](const TimeStep &step) {
        const double c = 2. + std::sin(step.t);
        return StepErrors{c * step.k * step.k * (1. + noise * std::cos(++n)),
                          step.k,
                          step.t};
      });
    };
    const auto exact = run(0.), noisy = run(1e-5);
    ASSERT_EQ(exact.size(), noisy.size());
    for (unsigned int i = 0; i < exact.size(); ++i)
      EXPECT_EQ(exact[i].t, noisy[i].t);
  }



  TEST(StepControl, StepsFollowTheError)
  {
    // Errors c(t) k^2 of a solution that moves at unit speed give k = TOL/c.
    const TimeSchedule schedule("10: 10");
    const auto         parameters = with_tolerance(0.1);
    const auto         c = [](const double t) { return t < 5. ? 10. : 1.; };
    StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
    const auto  done = steps(control, 10., [&](const TimeStep &step) {
      return StepErrors{c(step.t) * step.k * step.k, step.k, step.t};
    });
    EXPECT_NEAR(largest(done, 6.), 0.1, 0.03);
    for (const TimeStep &step : done)
      EXPECT_LE(c(step.t) * step.k, 0.1 * (1. + 1e-12));
    double k_early = 0.;
    for (const TimeStep &step : done)
      if (step.t < 4.5)
        k_early = std::max(k_early, step.k);
    EXPECT_NEAR(k_early, 0.01, 0.003);
    // Few steps are rejected.
    EXPECT_LT(control.counts().rejected, done.size() / 10);
    EXPECT_EQ(control.counts().unresolved, 0u);
  }



  TEST(StepControl, WhatHappensAtSomeTimesOnlyMayUseMore)
  {
    // Between t = 0.3 and 0.4 of 10 the bound of an error in slip grows like k,
    // as does the share of a step that covers k of the remaining time.
    const auto slipped = [](const double t) {
      return 0.2 * std::clamp(t - 0.3, 0., 0.1);
    };
    const TimeSchedule schedule("10: 10");
    StepControl control({}, StiffnessPolicy::refuse, schedule, 2, 0., 0.1);
    control.expect_size(1.);
    const auto done = steps(control, 10., [&](const TimeStep &step) {
      StepErrors errors;
      errors.of_events = errors.indicator =
        slipped(step.t) - slipped(step.t_old);
      errors.size   = 1.;
      errors.before = slipped(step.t_old);
      return errors;
    });
    EXPECT_EQ(control.counts().unresolved, 0u);
    EXPECT_LT(done.size() + control.counts().rejected, 80u);
  }



  TEST(StepControl, AJumpIsPassedWithTheSmallestStep)
  {
    // No step size reduces the error at t = 0.31.
    const TimeSchedule schedule("1: 10");
    const auto         parameters = with_tolerance(0.1);
    StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
    const auto  done = steps(control, 1., [](const TimeStep &step) {
      const bool jumps = step.t_old < 0.31 && step.t >= 0.31;
      return StepErrors{jumps ? 1. : 0., step.k, 1.};
    });
    EXPECT_EQ(control.counts().unresolved, 1u);
    EXPECT_LT(done.size(), 80u);
    for (const TimeStep &step : done)
      if (step.t_old < 0.31 && step.t >= 0.31)
        {
          EXPECT_LE(step.k, 1e-6 * (1. + 1e-6));
        }
  }



  TEST(StepControl, LimitsHold)
  {
    const TimeSchedule schedule("1: 10");
    const auto         no_error = [](const TimeStep &step) {
      return StepErrors{0., step.k, 1.};
    };
    auto parameters = with_tolerance(0.1);
    {
      StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
      const auto  done = steps(control, 1., no_error, {}, 0.013);
      EXPECT_LE(largest(done), 0.013 * (1. + 1e-12)); // t carries rounding
      EXPECT_LE(done.size(), 80u);
    }
    {
      StepControl control(
        parameters, StiffnessPolicy::backward_euler, schedule, 1, 0.);
      EXPECT_GT(largest(steps(control, 1., no_error, {}, 0.013)), 0.1);
    }
    {
      // Without an estimate, steps of the phase are the largest.
      StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
      control.set_has_estimate(false);
      EXPECT_NEAR(largest(steps(control, 1., no_error)), 0.1, 1e-12);
    }
    {
      // Errors that are always too large cause no steps below the smallest.
      parameters.smallest_step = 0.01;
      StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
      const auto  too_large = [](const TimeStep &step) {
        return StepErrors{1., step.k, 1.};
      };
      EXPECT_LE(steps(control, 1., too_large).size(), 102u);
    }
    parameters.largest_step = 0.02;
    StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
    EXPECT_LE(largest(steps(control, 1., no_error)), 0.02 * (1. + 1e-12));
  }



  TEST(StepControl, SubdivisionIsIntoEqualSteps)
  {
    const TimeSchedule          schedule("1: 2");
    const StepControlParameters off;
    StepControl control(off, StiffnessPolicy::subdivide, schedule, 1, 0.);
    const auto  done = steps(
      control, 1., [](const TimeStep &) { return StepErrors(); }, {}, 0.13);
    ASSERT_EQ(done.size(), 8u);
    for (const TimeStep &step : done)
      EXPECT_NEAR(step.k, 0.125, 1e-12);
    EXPECT_EQ(done[3].t, 0.5);
    EXPECT_THROW(control.propose(0, 0., 1e-12), ExceptionBase);
  }



  TEST(StepControl, LandsOnKinksAndAroundJumps)
  {
    const TimeSchedule schedule("1: 10, 2: 10");
    auto               parameters = with_tolerance(0.1);
    parameters.landing_times      = "1.3";
    const auto no_error           = [](const TimeStep &step) {
      return StepErrors{0., step.k, 1.};
    };
    StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
    // Some of the times are ends of steps already, up to rounding.
    control.land_on({0.777, 1. + 1e-12, 1.3 - 1e-12, 2.}, {0.4});
    const auto            done = steps(control, 2., no_error);
    std::vector<TimeStep> around;
    for (const TimeStep &step : done)
      {
        EXPECT_GT(step.k, 0.9e-6);
        if (step.t_old < 0.4 && step.t > 0.4)
          around.push_back(step);
      }
    ASSERT_EQ(around.size(), 1u);
    EXPECT_NEAR(around[0].k, 1e-6, 1e-12);
    // Fields may make a step end at the jump itself, which is a kink, too.
    EXPECT_TRUE(control.has_kink_within(0.39, 0.4));
    EXPECT_TRUE(control.is_kink(0.4));
    const auto has = [&](const double t) {
      return std::any_of(done.begin(), done.end(), [&](const TimeStep &step) {
        return step.t == t;
      });
    };
    for (const double t : {0.777, 1., 1.3, 2.})
      EXPECT_TRUE(has(t)) << t;

    // Without a tolerance the steps of the phases stay.
    StepControl fixed({}, StiffnessPolicy::refuse, schedule, 1, 0.);
    fixed.land_on({0.777}, {0.4});
    EXPECT_EQ(steps(fixed, 2., no_error).size(), 20u);
    EXPECT_TRUE(fixed.has_kink_within(0.7, 0.8));
    EXPECT_TRUE(fixed.has_kink_within(0.7, 0.777));
    EXPECT_FALSE(fixed.has_kink_within(0.777, 0.8));
  }



  TEST(StepControl, LandsOnTimes)
  {
    const TimeSchedule schedule("1: 10, 2: 10");
    auto               parameters = with_tolerance(0.1);
    parameters.landing_times      = "1.2345, 0.777";
    StepControl control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.3);
    const auto  done = steps(control, 2., [](const TimeStep &step) {
      return StepErrors{0., step.k, 1.};
    });
    const auto  has  = [&](const double t) {
      return std::any_of(done.begin(), done.end(), [&](const TimeStep &step) {
        return step.t == t;
      });
    };
    for (const double t : {0.777, 1., 1.2345, 2.})
      EXPECT_TRUE(has(t)) << t;
    for (int i = 1; i <= 6; ++i)
      EXPECT_TRUE(has(i * 0.3)) << i;
    EXPECT_TRUE(control.is_kink(0.777));
    EXPECT_TRUE(control.is_kink(1.));
    EXPECT_FALSE(control.is_kink(0.3));
  }



  TEST(StepControl, EventsAreFound)
  {
    const TimeSchedule schedule("1: 4");
    const auto         parameters = with_tolerance(0.1);
    for (const double t : {0.1, 0.5, 0.501, 0.9999})
      {
        StepControl control(
          parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
        const auto has_event = [&](const TimeStep &step) {
          return step.t_old < t && step.t >= t;
        };
        const auto done = steps(
          control,
          1.,
          [](const TimeStep &step) {
            return StepErrors{0., step.k, 1.};
          },
          has_event);
        const auto step = std::find_if(done.begin(), done.end(), has_event);
        ASSERT_NE(step, done.end());
        EXPECT_LE(step->k, 1e-3 * (1. + 1e-9)) << t;
        EXPECT_GT(control.counts().events, 0u);
        // Bisection and growth take some dozen steps, not hundreds.
        EXPECT_LT(done.size() + control.counts().events, 60u) << t;
      }
  }



  TEST(StepControl, FailedStepsAreTriedAgainDownToTheSmallest)
  {
    const TimeSchedule schedule("1: 1");
    auto               parameters = with_tolerance(0.1);
    parameters.smallest_step      = 0.01;
    StepControl  control(parameters, StiffnessPolicy::refuse, schedule, 1, 0.);
    TimeStep     step    = control.propose(0, 0., infinity);
    unsigned int retries = 0;
    while (control.retries(step, false))
      {
        const TimeStep shorter = control.propose(0, 0., infinity);
        EXPECT_LT(shorter.k, 0.51 * step.k);
        step = shorter;
        ++retries;
      }
    EXPECT_EQ(retries, 3u); // 1, 1/4, 1/16, 1/64
    EXPECT_GE(step.k, 0.01);

    const StepControlParameters off;
    StepControl fixed(off, StiffnessPolicy::subdivide, schedule, 1, 0.);
    EXPECT_FALSE(fixed.retries(fixed.propose(0, 0., infinity), false));
    EXPECT_TRUE(fixed.retries(fixed.propose(0, 0., infinity), true));
    StepControl refuses(off, StiffnessPolicy::refuse, schedule, 1, 0.);
    EXPECT_FALSE(refuses.retries(refuses.propose(0, 0., infinity), true));
  }
} // namespace
