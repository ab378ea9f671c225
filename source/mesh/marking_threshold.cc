// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/mesh/marking_threshold.h>

#include <algorithm>

namespace Viscoplastic
{
  namespace
  {
    // Values within this relative distance may end up on either side.
    constexpr double window = 0.01;

    /// Remove values whose neighbors on both sides are @p near from the sorted
    /// @p values, since no wide gap begins or ends there.
    std::vector<double>
    ends_of_gaps(const std::vector<double> &values, const double near)
    {
      std::vector<double> result;
      for (std::size_t i = 0; i < values.size(); ++i)
        if (i == 0 || i + 1 == values.size() ||
            values[i] - values[i - 1] > near ||
            values[i + 1] - values[i] > near)
          result.push_back(values[i]);
      return result;
    }
  } // namespace



  double
  marking_threshold(std::vector<std::pair<double, double>> values,
                    const double                           target,
                    const ThresholdSide                    side,
                    const MPI_Comm                         communicator)
  {
    std::sort(values.begin(), values.end());
    // weights[i] is the sum of the weights of values i and above.
    std::vector<double> weights(values.size() + 1, 0.);
    for (std::size_t i = values.size(); i-- > 0;)
      weights[i] = weights[i + 1] + values[i].second;
    const auto first_above = [&values](const double bound) {
      return std::upper_bound(values.begin(),
                              values.end(),
                              bound,
                              [](const double b, const auto &value) {
                                return b < value.first;
                              }) -
             values.begin();
    };
    const auto reached_above = [&](const double bound) {
      return Utilities::MPI::sum(weights[first_above(bound)], communicator) >=
             target;
    };

    double lower = 0.;
    double upper =
      Utilities::MPI::max(values.empty() ? 0. : values.back().first,
                          communicator);
    if (!reached_above(lower))
      return 0.;
    while (upper - lower > 1e-4 * window * upper)
      {
        const double middle                     = 0.5 * (lower + upper);
        (reached_above(middle) ? lower : upper) = middle;
      }
    const std::size_t below = first_above(upper);
    const double      critical =
      Utilities::MPI::max(below > 0 ? values[below - 1].first : 0.,
                          communicator);

    const double begin =
      side == ThresholdSide::below ? critical / (1. + window) : critical;
    const double end =
      side == ThresholdSide::below ? critical : critical * (1. + window);
    std::vector<double> inside{begin, end};
    for (const auto &value : values)
      if (begin < value.first && value.first < end)
        inside.push_back(value.first);
    std::sort(inside.begin(), inside.end());
    std::vector<double> all;
    for (const auto &part :
         Utilities::MPI::all_gather(communicator,
                                    ends_of_gaps(inside, 1e-3 * (end - begin))))
      all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end());
    std::size_t widest = 1;
    for (std::size_t i = 2; i < all.size(); ++i)
      if (all[i] - all[i - 1] > all[widest] - all[widest - 1])
        widest = i;
    return 0.5 * (all[widest - 1] + all[widest]);
  }
} // namespace Viscoplastic
