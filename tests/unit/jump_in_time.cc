// SPDX-License-Identifier: LGPL-2.1-or-later

// Jumps of data in time; kinks, steep ramps and moving loads, which are none;
// and changes of data within time steps that the ends of steps do not show.

#include <viscoplastic_contact/scene/data_in_time.h>

#include <gtest/gtest.h>

#include <string>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;

  std::optional<double>
  jump_of(const std::string &text, const std::string &phases = "0.5: 3, 2: 40")
  {
    std::vector<Point<2>> places;
    for (unsigned int i = 0; i < 64; ++i)
      places.emplace_back((i + 0.5) / 64., 1.);
    return find_jump(Expression<2>(text, "Traction"),
                     places,
                     TimeSchedule(phases));
  }



  std::optional<double>
  unseen_change_of(const std::string &text, const std::string &phases)
  {
    std::vector<Point<2>> places;
    for (unsigned int i = 0; i < 64; ++i)
      places.emplace_back((i + 0.5) / 64., 1.);
    return find_unseen_change(Expression<2>(text, "Traction"),
                              places,
                              TimeSchedule(phases));
  }



  TEST(JumpInTime, IsFoundWhereItIs)
  {
    for (const char *time : {"0.37", "0.5", "1.23456789", "2"})
      {
        const std::string t = time;
        for (const std::string &text : {"if(t < " + t + ", 0, 1)",
                                        "(t >= " + t + ")*x",
                                        "1e-9*sin(t)*(t < " + t + " ? 1 : 2)",
                                        "1e5*(1 + floor(min(1, t/" + t + ")))"})
          {
            const auto jump = jump_of(text);
            ASSERT_TRUE(jump) << text;
            EXPECT_NEAR(*jump, std::stod(t), 2e-10) << text;
          }
      }
    // The jump is right after the initial state.
    EXPECT_NEAR(jump_of("if(t > 0, 1, 0)").value_or(1.), 0., 1e-11);
    // The jump is on a part of the boundary only.
    EXPECT_NEAR(jump_of("if(x < 0.2 && t > 1, 1, 0)").value_or(0.), 1., 1e-11);
    // The jump is in a phase a billionth as long as others, or reverts soon.
    EXPECT_TRUE(
      jump_of("if(t < 0.5000000005, 0, 1)", "0.5: 10, 0.500000001: 1, 1: 10"));
    EXPECT_TRUE(jump_of("if(abs(t - 1) < 0.01, 0, 1)"));
  }



  TEST(JumpInTime, OtherThingsAreNone)
  {
    for (const char *text : {"if(t < 1, t, 2 - t)",               // a kink
                             "if(t < 1, 0, min(1, 1e6*(t - 1)))", // a ramp
                             "if(x < 0.5, t, 0)",                 // in space
                             "if(abs(x - t) < 0.2, 1, 0)",        // wanders
                             "if(t < 1, 0, 0.02) + sin(t)",       // small
                             "if(t < 1, 0, 0)",
                             "if(t < 1, t, 1/(2 - t))",
                             "if(t > 2, 1, 0)", // later
                             "min(t, 2 - t)*exp(-x)",
                             "if(x > 2, 1, 0)"})
      EXPECT_FALSE(jump_of(text)) << text << ": " << *jump_of(text);
  }



  TEST(JumpInTime, IsLookedForWhereItMayBe)
  {
    for (const char *text : {"if(t > 1, 1, 0)", "t > 1", "rint(t)", "t != 1"})
      EXPECT_TRUE(Expression<2>(text, "").may_jump()) << text;
    for (const char *text :
         {"min(t, 1)", "if(x > 1, 1, 0)", "sin(pi*t)", "1", "abs(t - 1)"})
      EXPECT_FALSE(Expression<2>(text, "").may_jump()) << text;
  }



  TEST(UnseenChange, OfDataInTimeWithTheSteps)
  {
    // The data have periods of one, two and a third of a step.
    for (const char *text : {"0.3*sin(2*pi*16*t)",
                             "x*sin(2*pi*8*t)",
                             "1 - cos(2*pi*48*t)",
                             "5 + sin(2*pi*16*t)",
                             "abs(sin(pi*16*t))"})
      for (const std::string phases : {"1: 16, 2: 16", "3: 48", "1e5: 1600000"})
        EXPECT_TRUE(unseen_change_of(text, phases)) << text << ", " << phases;
    // A short pulse, or a short pause, is within one step.
    const auto blow = unseen_change_of("exp(-(100*(t - 0.53))^2)", "1: 10");
    ASSERT_TRUE(blow);
    EXPECT_NEAR(*blow, 0.53, 0.02);
    EXPECT_TRUE(unseen_change_of("if(abs(t - 0.53) < 0.01, 0, 1)", "1: 10"));
    EXPECT_TRUE(unseen_change_of("t*(1 - t)", "1: 1"));
    EXPECT_TRUE(unseen_change_of("if(t < 0.5, 0, (t - 0.5)*(0.6 - t))",
                                 "0.5: 20, 0.6: 1"));
  }



  TEST(UnseenChange, IsNoneOfWhatStepsFollow)
  {
    for (const char *text : {"sin(2*pi*t)",
                             "sin(2*pi*t + 0.1)",
                             "min(t, 2 - t)",
                             "t*(1 - t)",
                             "exp(-10*t)",
                             "if(t < 0.55, 0, 1)",           // a jump
                             "min(1, max(0, 1e6*(t-0.55)))", // a ramp
                             "if(abs(x - t) < 0.1, 1, 0)",   // wanders
                             "exp(-((x - t)/0.05)^2)",
                             "100 + sin(2*pi*64*t)", // small
                             "x"})
      for (const char *phases : {"1: 3, 2: 3", "1: 4, 2: 4", "2: 50", "2: 6"})
        EXPECT_FALSE(unseen_change_of(text, phases)) << text << ", " << phases;
    // The expression has no finite value in a part of the step.
    EXPECT_FALSE(
      unseen_change_of("if(t > 0 && t < 0.3, 1/max(0, t - 1), t)", "1: 1"));
  }
} // namespace
