// SPDX-License-Identifier: LGPL-2.1-or-later

// Fits to made-up runs to a tolerance whose laws are known, and the prices that
// follow from them.

#include <viscoplastic_contact/study/tolerance_model.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Viscoplastic;

  /// In two dimensions with a scheme of second order, all laws are those of
  /// theory but for the constants: those of seconds and steps are seen in
  /// large tolerances.
  ToleranceSample
  sample(const double tolerance, const double exponent = 2.5)
  {
    const double x = 1. / tolerance;
    return {tolerance,
            0.6 * tolerance,
            0.4 + 2e-4 * std::pow(x, exponent),
            0.5 * x * x,
            1.2 * x * x,
            6. + 2. * std::sqrt(x),
            60. + 1e-3 * x * x};
  }



  std::vector<ToleranceSample>
  ladder(const double finest, const unsigned int n, const double exponent = 2.5)
  {
    std::vector<ToleranceSample> samples;
    for (unsigned int i = 0; i < n; ++i)
      samples.push_back(sample(finest * std::pow(2., n - 1. - i), exponent));
    return samples;
  }



  TEST(ToleranceModel, KnownLaws)
  {
    const ToleranceModel model = fit_tolerance(ladder(0.01, 5), 2, 2);
    EXPECT_NEAR(model.error.p, 1., 1e-3);
    EXPECT_NEAR(model.error.c_1, 0.6, 1e-3);
    EXPECT_NEAR(model.seconds.p, 2.5, 0.01);
    EXPECT_NEAR(model.seconds.c_2, 0.4, 0.02);
    EXPECT_NEAR(model.cells.p, 2., 0.01);
    EXPECT_NEAR(model.exponent(model.seconds), 2.5, 0.02);
    const PredictedToleranceRun run   = model.predict(0.005);
    const ToleranceSample       truth = sample(0.005);
    EXPECT_NEAR(run.error / truth.error, 1., 0.01);
    EXPECT_NEAR(run.seconds / truth.seconds, 1., 0.03);
    EXPECT_NEAR(run.cells / truth.cells, 1., 0.03);
    EXPECT_NEAR(run.dofs / truth.dofs, 1., 0.03);
    EXPECT_NEAR(run.steps / truth.steps, 1., 0.03);
    EXPECT_NEAR(run.memory / truth.memory, 1., 0.03);
  }



  TEST(ToleranceModel, ExponentsOfTheRunsBeatThoseOfTheory)
  {
    const ToleranceModel model = fit_tolerance(ladder(0.01, 5, 3.2), 2, 2);
    EXPECT_TRUE(model.seconds.p_is_fitted);
    EXPECT_NEAR(model.seconds.p, 3.2, 0.05);
  }



  TEST(ToleranceModel, OneRunIsScaledByTheory)
  {
    const ToleranceModel model = fit_tolerance({sample(0.04)}, 3, 1);
    EXPECT_FALSE(model.seconds.p_is_fitted);
    EXPECT_NEAR(model.predict(0.04).seconds, sample(0.04).seconds, 1e-6);
    EXPECT_NEAR(model.predict(0.02).seconds,
                std::pow(2., 3 + 1) * sample(0.04).seconds,
                1e-3);
    EXPECT_NEAR(model.predict(0.02).error, 0.6 * 0.02, 1e-6);
  }



  /// Squares of orthogonal errors subtract.
  TEST(ToleranceModel, TheErrorOfTheReferenceIsNoPartOfTheLaw)
  {
    constexpr double             reference = 0.005;
    std::vector<ToleranceSample> samples   = ladder(0.01, 4);
    for (ToleranceSample &sample : samples)
      sample.error = 0.6 * std::sqrt(sample.tolerance * sample.tolerance -
                                     reference * reference);
    const ToleranceModel model = fit_tolerance(samples, 2, 2, reference);
    EXPECT_NEAR(model.error.p, 1., 2e-3);
    EXPECT_NEAR(model.predict(0.01).error, 0.006, 1e-4);
  }



  TEST(ToleranceModel, ToleranceOfAnError)
  {
    ToleranceModel model = fit_tolerance(ladder(0.02, 4), 2, 2);
    EXPECT_NEAR(model.tolerance_for(0.006), 0.01, 1e-4);
    EXPECT_EQ(model.tolerance_for(0.4), 0.5);
    // What is promised is not exceeded although less is expected.
    model.is_kept = true;
    EXPECT_EQ(model.tolerance_for(0.006), 0.006);

    const double seconds = model.predict(0.007).seconds;
    EXPECT_NEAR(*model.tolerance_within(seconds), 0.007, 1e-6);
    EXPECT_FALSE(model.tolerance_within(0.1)); // less than the constant
  }



  TEST(ToleranceModel, PricesInWords)
  {
    const ToleranceModel model = fit_tolerance(ladder(0.02, 4), 2, 2);
    const TolerancePrice price = price_of(model, 0.006, 1000.);
    EXPECT_TRUE(price.is_in_budget);
    EXPECT_FALSE(price.is_far);
    EXPECT_GT(price.halving, 4.);
    EXPECT_LT(price.halving, 5.7);
    EXPECT_EQ(
      in_words(model, price, 1000.).find("Error 0.006: tolerance 0.01, "), 0u)
      << in_words(model, price, 1000.);
    EXPECT_TRUE(price_of(model, 0.001, 1e9).is_far);

    const TolerancePrice large = price_of(model, 1e-5, 20.);
    EXPECT_FALSE(large.is_in_budget);
    const std::string text = in_words(model, large, 20.);
    EXPECT_NE(text.find("not within 20 s, it would take about"),
              std::string::npos)
      << text;
    EXPECT_NE(text.find("the smallest error there is about 0.00"),
              std::string::npos)
      << text;
  }
} // namespace
