// SPDX-License-Identifier: LGPL-2.1-or-later

// Fits to made-up errors and costs whose coefficients are known, and the prices
// that follow from them.

#include <viscoplastic_contact/study/price_list.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace
{
  using namespace Viscoplastic;

  constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  struct Truth
  {
    double c_h, p, c_k, q;

    double
    operator()(const double h, const double k) const
    {
      return c_h * std::pow(h, p) + c_k * std::pow(k, q);
    }
  };

  /// The ladders of a study with four levels; @p noise is that of log(error).
  std::vector<Sample>
  ladders(const Truth &truth,
          const double noise = 0.,
          const bool   space = true,
          const bool   time  = true,
          const bool   both  = true)
  {
    std::mt19937                     generator(3);
    std::normal_distribution<double> normal;
    std::vector<Sample>              samples;
    const auto                       add = [&](const int i, const int j) {
      const double h = 0.125 * std::pow(0.5, i), k = 0.05 * std::pow(0.5, j);
      samples.push_back(
        {h, k, truth(h, k) * std::exp(noise * normal(generator))});
    };
    for (int i = 0; i < 4; ++i)
      {
        if (space)
          add(i, 3);
        if (time && (i < 3 || !space))
          add(3, i);
        if (both && i < 3)
          add(i, i);
      }
    return samples;
  }

  TEST(StudyFit, KnownCoefficients)
  {
    for (const Truth &truth : {Truth{2., 1., 3., 1.},
                               Truth{2., 0.75, 3., 1.},
                               Truth{2., 1., 40., 2.},
                               Truth{0.1, 0.5, 0.3, 1.}})
      {
        const TwoPowers fit = fit_error(ladders(truth));
        EXPECT_EQ(fit.m, 1.);
        EXPECT_TRUE(fit.p_is_fitted);
        EXPECT_TRUE(fit.q_is_fitted);
        // The weak belief in 1 is all that is between.
        EXPECT_NEAR(fit.p, truth.p, 1e-4);
        EXPECT_NEAR(fit.q, truth.q, 1e-4);
        EXPECT_NEAR(fit.c_1, truth.c_h, 1e-3 * truth.c_h);
        EXPECT_NEAR(fit.c_2, truth.c_k, 1e-3 * truth.c_k);
        EXPECT_LT(fit.misfit.rms, 1e-5);
        EXPECT_EQ(fit.misfit.n_samples, 10u);
      }
  }



  TEST(StudyFit, Noise)
  {
    const Truth     truth{2., 1., 3., 1.};
    const TwoPowers fit = fit_error(ladders(truth, 0.05));
    EXPECT_NEAR(fit.p, 1., 0.1);
    EXPECT_NEAR(fit.q, 1., 0.2);
    EXPECT_GT(fit.misfit.rms, 0.01);
    EXPECT_LT(fit.misfit.rms, 0.06);
    EXPECT_LT(fit.misfit.worst_factor, 1.15);
    // One level beyond the samples.
    const double h = 0.125 / 16, k = 0.05 / 16;
    EXPECT_NEAR(fit(h, k), truth(h, k), 0.1 * truth(h, k));
  }



  TEST(StudyFit, Outlier)
  {
    const Truth truth{2., 1., 3., 1.};
    auto        samples = ladders(truth, 0.01);
    samples[4].y *= 3.;
    const TwoPowers fit = fit_error(samples);
    EXPECT_NEAR(fit.c_1, 2., 0.2);
    EXPECT_NEAR(fit.c_2, 3., 0.3);
    EXPECT_EQ(fit.misfit.worst_sample, 4u);
    EXPECT_NEAR(fit.misfit.worst_factor, 3., 0.2);
  }



  TEST(StudyFit, WhatOneLadderCannotTell)
  {
    const Truth     truth{2., 1., 3., 1.};
    const TwoPowers space = fit_error(ladders(truth, 0., true, false, false));
    EXPECT_TRUE(space.p_is_fitted);
    EXPECT_FALSE(space.q_is_fitted); // theoretical
    EXPECT_EQ(space.q, 1.);
    EXPECT_NEAR(space.c_1, 2., 1e-3);
    EXPECT_NEAR(space.c_2, 3., 1e-3);
    const TwoPowers time = fit_error(ladders(truth, 0., false, true, false));
    EXPECT_FALSE(time.p_is_fitted);
    EXPECT_NEAR(time.c_1, 2., 1e-3);
    EXPECT_NEAR(time.c_2, 3., 1e-3);
    const TwoPowers both = fit_error(ladders(truth, 0., false, false, true));
    EXPECT_FALSE(both.is_separable);
    EXPECT_NEAR(both(0.01, 0.004), truth(0.01, 0.004), 1e-6);
    EXPECT_NEAR(both.first(0.01), both.second(0.004), 1e-6);
  }



  TEST(StudyFit, PartsThatDoNotShow)
  {
    const TwoPowers h = fit_error(ladders({2., 1., 1e-9, 1.}));
    EXPECT_NEAR(h.c_1, 2., 1e-3);
    EXPECT_EQ(h.c_2, 0.);
    EXPECT_FALSE(h.q_is_fitted);
    const TwoPowers noisy = fit_error(ladders({2., 1., 1e-5, 1.}, 0.03));
    EXPECT_FALSE(noisy.q_is_fitted);
    EXPECT_LT(noisy.second(0.05), 0.1 * noisy.first(0.125 / 8));
    const TwoPowers k = fit_error(ladders({0., 1., 3., 1.}));
    EXPECT_EQ(k.c_1, 0.);
    EXPECT_FALSE(k.p_is_fitted);
    EXPECT_NEAR(k.c_2, 3., 1e-3);
  }



  TEST(StudyFit, DifferencesToAFinerRun)
  {
    const Truth truth{2., 1., 3., 1.};
    const Finer finer{0.125 / 16, 0.05 / 16, 2., 1.};
    auto        samples = ladders(truth);
    for (Sample &sample : samples)
      sample.y =
        2. * std::sqrt(std::pow(sample.x_1, 2) - std::pow(finer.x_1, 2)) +
        3. * (sample.x_2 - finer.x_2);
    const TwoPowers fit = fit_error(samples, finer);
    EXPECT_NEAR(fit.p, 1., 1e-3);
    EXPECT_NEAR(fit.q, 1., 1e-3);
    EXPECT_NEAR(fit.c_1, 2., 0.01);
    EXPECT_NEAR(fit.c_2, 3., 0.01);
    EXPECT_LT(fit.misfit.rms, 1e-4);
    // Taken for errors, they seem to fall faster.
    EXPECT_GT(fit_error(samples).q, 1.1);
    // The finest of the ladders in its place: its steps are those of the ladder
    // in space, and do not count there.
    const Finer corner{0.125 / 8, 0.05 / 8, 1., 1.};
    samples = ladders(truth);
    for (Sample &sample : samples)
      sample.y =
        2. * (sample.x_1 - corner.x_1) + 3. * (sample.x_2 - corner.x_2);
    const TwoPowers of_corner = fit_error(samples, corner);
    EXPECT_EQ(of_corner.misfit.n_samples, 9u);
    EXPECT_NEAR(of_corner.c_1, 2., 0.01);
    EXPECT_NEAR(of_corner.c_2, 3., 0.01);
  }



  TEST(StudyFit, OrthogonalParts)
  {
    auto samples = ladders({2., 1., 3., 1.});
    for (Sample &sample : samples)
      sample.y = std::hypot(2. * sample.x_1, 3. * sample.x_2);
    const TwoPowers fit = fit_error(samples);
    EXPECT_EQ(fit.m, 2.);
    EXPECT_NEAR(fit.p, 1., 1e-3);
    EXPECT_NEAR(fit.q, 1., 1e-3);
    EXPECT_NEAR(fit(0.01, 0.01), std::hypot(0.02, 0.03), 1e-4);
    EXPECT_NEAR(fit.rest(0.05, 0.03), 0.04, 1e-12);
    EXPECT_EQ(fit.rest(0.03, 0.05), 0.);
    // Against a finer run.
    const Finer finer{0.125 / 16, 0.05 / 16, 2., 1.};
    for (Sample &sample : samples)
      sample.y = std::hypot(2. * std::sqrt(std::pow(sample.x_1, 2) -
                                           std::pow(finer.x_1, 2)),
                            3. * (sample.x_2 - finer.x_2));
    const TwoPowers of_differences = fit_error(samples, finer);
    EXPECT_EQ(of_differences.m, 2.);
    EXPECT_NEAR(of_differences.c_1, 2., 0.02);
    EXPECT_NEAR(of_differences.c_2, 3., 0.03);
  }



  TEST(StudyFit, KnownParts)
  {
    const Truth         truth{2., 1., 0.03, 2.}; // steps hardly show
    const auto          samples = ladders(truth);
    std::vector<double> space, time;
    for (const Sample &sample : samples)
      {
        space.push_back(2. * sample.x_1);
        time.push_back(0.03 * sample.x_2 * sample.x_2);
      }
    const TwoPowers fit = fit_error_parts(samples, space, time);
    EXPECT_NEAR(fit.c_1, 2., 1e-3);
    EXPECT_NEAR(fit.q, 2., 1e-3);
    EXPECT_NEAR(fit.c_2, 0.03, 1e-4);
    EXPECT_LT(fit.misfit.rms, 1e-4);
    // An elastic body has no error of the steps.
    const TwoPowers elastic =
      fit_error_parts(samples, space, std::vector<double>(samples.size(), 0.));
    EXPECT_EQ(elastic.c_2, 0.);
    EXPECT_EQ(elastic.misfit.n_samples, samples.size());
  }



  TEST(StudyFit, UnusableSamples)
  {
    EXPECT_EQ(fit_error({}).misfit.n_samples, 0u);
    EXPECT_EQ(fit_error({{0.1, 0.1, 0.}, {0.1, 0.2, nan}, {0.2, 0.1, 1e-15}})
                .misfit.n_samples,
              0u);
    auto samples        = ladders({2., 1., 3., 1.});
    samples[1].y        = 0.;
    samples[5].y        = nan;
    samples[7].y        = std::numeric_limits<double>::infinity();
    const TwoPowers fit = fit_error(samples);
    EXPECT_EQ(fit.misfit.n_samples, 7u);
    EXPECT_NEAR(fit.c_1, 2., 1e-3);
    // A single one, and equal ones: no order, but a value.
    const TwoPowers one = fit_error({{0.1, 0.2, 0.05}, {0.1, 0.2, 0.05}});
    EXPECT_FALSE(one.p_is_fitted || one.q_is_fitted);
    EXPECT_NEAR(one(0.1, 0.2), 0.05, 1e-6);
  }



  /// A demand of a scene in two dimensions with that solver, or automatic.
  SolverDemand
  demand(const double dofs, const LinearSolver choice = LinearSolver::direct)
  {
    SolverDemand result;
    result.choice       = choice;
    result.n_dofs       = std::llround(dofs);
    result.n_first_dofs = 50;
    return result;
  }



  /// Runs with the direct solver. Beside it meshes fill 2 kB an unknown.
  std::vector<CostSample>
  costs(const LinearSolver choice = LinearSolver::direct)
  {
    std::vector<CostSample> samples;
    for (const double dofs : {1e3, 4e3, 1.6e4, 6.4e4})
      for (const double steps : {20., 40.})
        {
          const double set_up = 2e-6 * std::pow(dofs, 1.2);
          CostSample   sample{demand(dofs, choice),
                            steps,
                            1.,
                            set_up,
                            set_up +
                              steps * (1e-3 + 1e-6 * std::pow(dofs, 1.1)),
                            90. + 2e-3 * dofs};
          sample.demand.n_solves = static_cast<unsigned int>(steps);
          sample.memory +=
            1e-6 * expected_memory(BulkSolverKind::direct, sample.demand);
          samples.push_back(sample);
        }
    return samples;
  }



  TEST(StudyFit, Costs)
  {
    const CostModel model = fit_cost(costs());
    ASSERT_EQ(model.solvers.size(), 1u);
    const auto &direct = model.solvers.at(BulkSolverKind::direct);
    EXPECT_NEAR(direct.set_up.p, 1.2, 0.01);
    EXPECT_NEAR(direct.step.p, 1.1, 0.01);
    EXPECT_NEAR(model.memory(1e6, 100.),
                2090. +
                  1e-6 * expected_memory(BulkSolverKind::direct, demand(1e6)),
                20.);
    // Sixteen times the unknowns of the largest sample, to 1 %: what is
    // believed of the exponents has a weight.
    EXPECT_NEAR(model.seconds(1e6, 100.),
                2e-6 * std::pow(1e6, 1.2) +
                  100. * (1e-3 + 1e-6 * std::pow(1e6, 1.1)),
                5.);
    EXPECT_LT(model.misfit.worst_factor, 1.01);
    EXPECT_LT(model.memory_misfit.worst_factor, 1.01);
    EXPECT_GT(model.simple.misfit.worst_factor, 1.1);
    // One run: what is believed of sparse solvers.
    CostSample sample    = costs()[0];
    sample.demand.dim    = 3;
    const CostModel one  = fit_cost({sample});
    const auto     &step = one.solvers.at(BulkSolverKind::direct).step;
    EXPECT_NEAR(step(8e3, 1.) / step(1e3, 1.), 16., 1e-3);
    const CostModel none = fit_cost({});
    EXPECT_EQ(none.misfit.n_samples, 0u);
    EXPECT_EQ(none.seconds(1e4, 10.), 0.);
  }



  TEST(StudyFit, CostsOfTheSolverThatARunWouldHave)
  {
    // Small meshes have the direct solver. A large one that is kept for a few
    // steps only has multigrid, whose cost is known from elsewhere at first,
    std::vector<CostSample> samples = costs(LinearSolver::automatic);
    const CostModel         before  = fit_cost(samples);
    const BulkSolverKind    kind    = BulkSolverKind::geometric_multigrid;
    ASSERT_EQ(choose_bulk_solver(before.demand_at(1e6, 2.)), kind);
    ASSERT_EQ(choose_bulk_solver(before.demand_at(1e6, 1e3)),
              BulkSolverKind::direct);
    // however often: each new mesh has a solver of its own.
    ASSERT_EQ(choose_bulk_solver(before.demand_at(1e6, 1e3, 500.)), kind);
    EXPECT_NEAR(before.seconds(1e4, 1e3, 50.) - before.seconds(1e4, 1e3, 1.),
                49. * before.solvers.at(BulkSolverKind::direct).set_up(1e4, 1.),
                1e-9);
    const SolverDemand large = before.demand_at(1e6, 2.);
    const auto        &known = before.solvers.at(BulkSolverKind::direct);
    const SolverCost   there = expected_cost(BulkSolverKind::direct,
                                           before.demand_at(6.4e4, 2.)),
                     here    = expected_cost(kind, large);
    EXPECT_NEAR(before.seconds(1e6, 2.),
                known.set_up(6.4e4, 1.) * here.set_up / there.set_up +
                  2. * known.step(6.4e4, 1.) * here.step / there.step,
                1e-9);
    // and measured as soon as there is a run with it.
    CostSample timing{before.demand_at(2.5e5, 2.), 2., 1., 3., 4., 1000.};
    ASSERT_EQ(choose_bulk_solver(timing.demand), kind);
    samples.push_back(timing);
    const CostModel after = fit_cost(samples);
    EXPECT_EQ(after.solvers.at(kind).largest, 2.5e5);
    EXPECT_NEAR(after.seconds(2.5e5, 2.), 4., 1e-6);
    // One run does not tell how the seconds grow.
    EXPECT_NEAR(after.seconds(1e6, 2.),
                3. * here.set_up / expected_cost(kind, timing.demand).set_up +
                  1. * here.step / expected_cost(kind, timing.demand).step,
                1e-6);
    EXPECT_NEAR(after.seconds(6.4e4, 40.), before.seconds(6.4e4, 40.), 1e-9);
    // Prices look at far finer meshes than anybody has.
    for (const CostModel &model : {before, after})
      EXPECT_NEAR(model.seconds(1e13, 2.) / model.seconds(1e12, 2.), 10., 2.5);
    // Meshes that nobody has refined yet would be refined from the finest one.
    for (CostSample &sample : samples)
      sample.demand.n_first_dofs = 0;
    EXPECT_EQ(fit_cost(samples).demand_at(3e5, 2.).n_first_dofs, 0u);
    EXPECT_EQ(fit_cost(samples).demand_at(1e6, 2.).n_first_dofs, 250000u);
    // A face has one dimension less than its body.
    samples.back().demand.n_face_dofs = 300;
    EXPECT_EQ(fit_cost(samples).demand_at(1e6, 2.).n_face_dofs, 600u);
  }



  WorkPrecisionModel
  model()
  {
    WorkPrecisionModel result;
    result.error          = fit_error(ladders({2., 1., 3., 1.}));
    result.cost           = fit_cost(costs());
    result.h              = 0.125;
    result.k              = 0.05;
    result.dofs           = 162.;
    result.phases         = read_phases("0.5: 10, 1: 10");
    result.coarsest_level = 2;
    result.smallest_h     = 0.125 / 8;
    result.smallest_k     = 0.05 / 8;
    return result;
  }



  TEST(PriceList, Phases)
  {
    const auto phases = read_phases(" 1e-3: 10, 4e-3 : 33");
    EXPECT_EQ(write_phases(phases), "1e-3: 10, 4e-3: 33");
    EXPECT_EQ(write_phases(scale_phases(phases, 2.)), "1e-3: 20, 4e-3: 66");
    EXPECT_EQ(write_phases(scale_phases(phases, 0.25)), "1e-3: 3, 4e-3: 9");
    EXPECT_EQ(write_phases(scale_phases(phases, 1e-6)), "1e-3: 1, 4e-3: 1");
    EXPECT_EQ(n_steps(phases), 43u);
    EXPECT_EQ(write_phases(read_phases("1: 1e3")), "1: 1000");
  }



  TEST(PriceList, CheapestIsCheapest)
  {
    const WorkPrecisionModel m     = model();
    const auto               found = cheapest(m, 0.01);
    ASSERT_TRUE(found);
    EXPECT_LE(found->error, 0.01);
    // No level and no number of steps is cheaper.
    for (int level = -2; level <= 10; ++level)
      for (double k = 0.05; k > 1e-4; k /= 1.1)
        {
          const PredictedRun other = predict(m, level, k);
          if (other.error <= 0.01)
            {
              EXPECT_GE(other.seconds, 0.999 * found->seconds);
            }
        }
    EXPECT_LE(ideal_seconds(m, 0.01), 1.01 * found->seconds);
    EXPECT_GT(ideal_seconds(m, 0.01), 0.2 * found->seconds);
  }



  TEST(PriceList, Budget)
  {
    const WorkPrecisionModel m    = model();
    const auto               best = most_accurate(m, 10.);
    ASSERT_TRUE(best);
    EXPECT_LE(best->seconds, 10.);
    const auto prices = list_prices(m, {0.1, 1e-4}, 10.);
    EXPECT_TRUE(prices[0].is_in_budget);
    EXPECT_FALSE(prices[1].is_in_budget);
    // h^-2.2 for the mesh and k^-1: 3.2 powers of two at most.
    EXPECT_GT(prices[0].halving, 1.5);
    EXPECT_LT(prices[0].halving, 10.);
    const std::string sentence = in_words(m, prices[1], 10.);
    EXPECT_NE(sentence.find("not within 10 s"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("the smallest error there is about"),
              std::string::npos)
      << sentence;
    EXPECT_FALSE(most_accurate(m, 1e-6));
  }



  TEST(PriceList, StabilityLimit)
  {
    WorkPrecisionModel m = model();
    m.largest_k          = 0.01;
    EXPECT_LE(cheapest(m, 0.5)->k, 0.01);
  }



  TEST(PriceList, StepsToATolerance)
  {
    // Heun's method: 20 TOL^(-1/2) steps, and five for events.
    WorkPrecisionModel  m = model();
    std::vector<Sample> steps;
    for (const double tolerance : {0.16, 0.04, 0.01})
      steps.push_back(
        {1. / tolerance, 1., 20. * std::pow(tolerance, -0.5) + 5.});
    Prior prior;
    prior.p        = 0.5;
    m.chosen_steps = fit_two_powers(steps, prior);
    m.order        = 2;
    m.k            = 0.04;
    m.largest_k    = 0.16;
    m.smallest_k   = 0.01;

    const PredictedRun finer = predict(m, 0, 0.0025);
    EXPECT_EQ(finer.steps, 405u);
    EXPECT_EQ(finer.k, 0.0025);
    // A sixteenth of the tolerance: four times as many steps.
    EXPECT_EQ(write_phases(finer.phases), "0.5: 40, 1: 40");
    EXPECT_NEAR(finer.seconds, m.seconds(m.h, 0.0025), 1e-3 * finer.seconds);
    EXPECT_FALSE(finer.is_far); // one level beyond
    EXPECT_TRUE(predict(m, 0, 0.0006).is_far);
    EXPECT_EQ(predict(m, 0, 1.).k, 0.16); // coarser has not been measured

    const auto found = cheapest(m, 0.01);
    ASSERT_TRUE(found);
    EXPECT_LE(found->error, 0.01 * (1. + 1e-12));
    for (int level = -2; level <= 10; ++level)
      for (double k = 0.16; k > 1e-5; k /= 1.1)
        {
          const PredictedRun other = predict(m, level, k);
          if (other.error <= 0.01)
            {
              EXPECT_GE(other.seconds, 0.99 * found->seconds);
            }
        }
    EXPECT_LE(ideal_seconds(m, 0.01), 1.01 * found->seconds);
    EXPECT_NE(
      in_words(m, list_prices(m, {0.01}, 1e9)[0], 1e9).find("step tolerance"),
      std::string::npos);
    EXPECT_NE(next_refinement(m).find("A quarter of the step tolerance"),
              std::string::npos);
  }



  TEST(PriceList, ErrorsWithoutOnePart)
  {
    WorkPrecisionModel m = model();
    m.error              = fit_error(ladders({2., 1., 1e-9, 1.}));
    // Steps cost nothing: as few as there are phases.
    EXPECT_EQ(cheapest(m, 0.1)->steps, 2u);
    EXPECT_TRUE(std::isfinite(ideal_seconds(m, 0.1)));
    m.error = fit_error(ladders({0., 1., 3., 1.}));
    EXPECT_EQ(cheapest(m, 0.1)->mesh_level, -2);
    EXPECT_TRUE(std::isfinite(ideal_seconds(m, 0.1)));
    m.error = fit_error({});
    EXPECT_FALSE(cheapest(m, 0.1));
    EXPECT_FALSE(list_prices(m, {0.1}, 10.)[0].is_in_budget);
  }
} // namespace
