// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/mesh/marking_threshold.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace Viscoplastic;

namespace
{
  using Values = std::vector<std::pair<double, double>>;

  /// Estimates over some orders of magnitude, each four times, as in a body
  /// with two symmetries.
  std::vector<double>
  estimates()
  {
    std::mt19937                           generator(5);
    std::uniform_real_distribution<double> exponent(-9., 0.);
    std::vector<double>                    result;
    for (unsigned int i = 0; i < 100; ++i)
      result.insert(result.end(), 4, std::pow(10., exponent(generator)));
    return result;
  }



  /// The values of this rank, each its own weight, if all are dealt out to the
  /// ranks in turn.
  Values
  dealt_out(const std::vector<double> &values)
  {
    const unsigned int n    = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
    Values             mine;
    for (std::size_t i = rank; i < values.size(); i += n)
      mine.emplace_back(values[i], values[i]);
    return mine;
  }



  TEST(MarkingThreshold, SeparatesTheFraction)
  {
    const std::vector<double> values = estimates();
    double                    total  = 0.;
    for (const double value : values)
      total += value;
    for (const double fraction : {0.05, 0.3, 0.5, 0.95, 0.999})
      {
        const double threshold = marking_threshold(dealt_out(values),
                                                   fraction * total,
                                                   ThresholdSide::below,
                                                   MPI_COMM_WORLD);
        double       chosen = 0., smallest = 1.;
        for (const double value : values)
          if (value > threshold)
            {
              chosen += value;
              smallest = std::min(smallest, value);
            }
        EXPECT_GE(chosen, fraction * total);
        // The four copies stay together, with values up to a per cent smaller.
        double without = 0.;
        for (const double value : values)
          if (value > 1.02 * smallest)
            without += value;
        EXPECT_LT(without, fraction * total);
      }
  }



  TEST(MarkingThreshold, DoesNotHangOnWhatIterationsLeave)
  {
    const std::vector<double> values = estimates();
    double                    total  = 0.;
    for (const double value : values)
      total += value;
    std::mt19937                           generator(7);
    std::uniform_real_distribution<double> error(-1e-5, 1e-5);
    for (double fraction = 0.02; fraction < 0.97; fraction += 0.02)
      for (const ThresholdSide side :
           {ThresholdSide::below, ThresholdSide::above})
        {
          const double threshold = marking_threshold(dealt_out(values),
                                                     fraction * total,
                                                     side,
                                                     MPI_COMM_WORLD);
          for (unsigned int trial = 0; trial < 5; ++trial)
            {
              std::vector<double> perturbed(values);
              for (double &value : perturbed)
                value *= 1. + error(generator);
              const double other = marking_threshold(dealt_out(perturbed),
                                                     fraction * total,
                                                     side,
                                                     MPI_COMM_WORLD);
              for (std::size_t i = 0; i < values.size(); ++i)
                EXPECT_EQ(values[i] > threshold, perturbed[i] > other)
                  << "fraction " << fraction << ", value " << values[i];
            }
        }
  }



  TEST(MarkingThreshold, EqualValuesStayTogether)
  {
    // Values differ by rounding, and other ranks have none.
    Values mine;
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      for (unsigned int i = 0; i < 16; ++i)
        mine.emplace_back(0.3 * (1. + 1e-15 * i), 1.);
    EXPECT_LT(marking_threshold(mine, 8., ThresholdSide::below, MPI_COMM_WORLD),
              0.299);
    EXPECT_GT(marking_threshold(mine, 8., ThresholdSide::above, MPI_COMM_WORLD),
              0.301);
  }



  TEST(MarkingThreshold, TargetsBeyondAllValues)
  {
    EXPECT_EQ(marking_threshold(
                Values{{1., 1.}}, 1000., ThresholdSide::below, MPI_COMM_WORLD),
              0.);
    EXPECT_EQ(
      marking_threshold(Values{}, 1., ThresholdSide::above, MPI_COMM_WORLD),
      0.);
  }
} // namespace
