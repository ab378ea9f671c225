// SPDX-License-Identifier: LGPL-2.1-or-later

// The search finds all kinks and jumps of data in time and nothing else.

#include <viscoplastic_contact/scene/data_in_time.h>

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;

  std::vector<Kink>
  kinks_of(const std::string &text, const std::string &phases = "0.5: 3, 2: 40")
  {
    std::vector<Point<2>> places;
    for (unsigned int i = 0; i < 64; ++i)
      places.emplace_back((i + 0.5) / 64., 1.);
    return find_kinks(Expression<2>(text, "Traction"),
                      places,
                      TimeSchedule(phases));
  }



  void
  expect_kinks(const std::string         &text,
               const std::vector<double> &times,
               const bool                 are_jumps = false,
               const std::string         &phases    = "0.5: 3, 2: 40")
  {
    SCOPED_TRACE(text);
    const auto found = kinks_of(text, phases);
    ASSERT_EQ(found.size(), times.size());
    for (std::size_t i = 0; i < times.size(); ++i)
      {
        EXPECT_NEAR(found[i].t, times[i], 1e-9);
        EXPECT_EQ(found[i].is_jump, are_jumps);
      }
  }



  TEST(KinksInTime, AreFoundWhereTheyAre)
  {
    expect_kinks("0.3*min(t, 2 - t)", {1.});
    expect_kinks("1e-9*max(0, 1 - abs(t - 1.23456789))",
                 {0.23456789, 1.23456789});
    expect_kinks("if(t < 0.3, t, if(t < 0.71, 0.3, 1.01 - t))", {0.3, 0.71});
    expect_kinks("abs(sin(pi*t/0.4))", {0.4, 0.8, 1.2, 1.6});
    expect_kinks("min(t, 0.007)*exp(x)", {0.007});
    // These kinks are closer to each other than the windows of a short phase.
    expect_kinks("max(0, 0.01 - abs(t - 1))", {0.99, 1., 1.01});
    expect_kinks("max(0, t - 40)^1.01 + max(0, t - 17)",
                 {17., 40.},
                 false,
                 "100: 10");
    // A weak kink is on a curved function.
    expect_kinks("sin(t) + 0.2*abs(t - 0.77)", {0.77});
    // Rounding of asin near 1 limits the accuracy.
    const auto folds = kinks_of("asin(sin(pi*t))");
    ASSERT_EQ(folds.size(), 2u);
    EXPECT_NEAR(folds[0].t, 0.5, 1e-8);
    EXPECT_NEAR(folds[1].t, 1.5, 1e-8);
    // Times given as short decimal numbers are found exactly.
    EXPECT_EQ(kinks_of("abs(t - 0.375)").at(0).t, 0.375);
    EXPECT_EQ(kinks_of("abs(t - 1.1)").at(0).t, 1.1);
    // So are ends of phases, which need not be short decimal numbers.
    EXPECT_EQ(
      kinks_of("min(t*6, 1)", "0.16666666666666666: 3, 1000: 40").at(0).t,
      1. / 6.);
  }



  TEST(KinksInTime, JumpsAreFoundAtTheEndsOfWindows)
  {
    // The jumps are at points of the search, up to rounding.
    for (unsigned int i = 1; i < 30; ++i)
      if (i != 20)
        {
          std::ostringstream text;
          text << "if(t < " << 0.05 * i << ", 1, 0)";
          expect_kinks(text.str(), {0.05 * i}, true, "1: 1, 1.5: 4");
        }
  }



  TEST(KinksInTime, JumpsAreToldFromKinks)
  {
    expect_kinks("if(t < 0.37, 0, 1)", {0.37}, true);
    expect_kinks("t + (t >= 1.5)*x", {1.5}, true);
    const auto both = kinks_of("min(t, 0.8) + if(t > 1.3, 1, 0)");
    ASSERT_EQ(both.size(), 2u);
    EXPECT_FALSE(both[0].is_jump);
    EXPECT_TRUE(both[1].is_jump);
  }



  TEST(KinksInTime, SmoothDataHaveNone)
  {
    for (const char *text : {"sin(300*t) + 0*abs(t)",
                             "exp(-30*t)*(1 + 0*min(t, 1))",
                             "abs(3 + sin(40*t))",
                             "max(t, -1)^3",
                             "max(t - 1, 0)^2",
                             "0*abs(t - 1)",
                             "t", // no kink possible
                             "abs(t - 1)*0 + 7"})
      expect_kinks(text, {});
    // Moving loads have a kink somewhere at all times.
    expect_kinks("abs(x - t/2)", {});
    expect_kinks("max(0, 1 - 20*abs(x - t/2))", {});
    // Kinks at the ends of the run do not count.
    expect_kinks("abs(t)", {});
    expect_kinks("abs(t - 2)", {});
    // The expression has no value after t = 1.
    expect_kinks("if(t > 1, log(-t), t)", {});
  }
} // namespace
