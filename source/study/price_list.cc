// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/progress.h>
#include <viscoplastic_contact/study/price_list.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    constexpr int    finest_level = 12;
    constexpr double most_steps   = 1e8;

    double
    length(const std::vector<StepsUntil> &phases, const std::size_t i)
    {
      const double start =
        i == 0 ? 0. : Utilities::string_to_double(phases[i - 1].end);
      return Utilities::string_to_double(phases[i].end) - start;
    }



    /// The longest step.
    double
    largest_step(const std::vector<StepsUntil> &phases)
    {
      double largest = 0.;
      for (std::size_t i = 0; i < phases.size(); ++i)
        largest = std::max(largest, length(phases, i) / phases[i].n_steps);
      return largest;
    }



    /// The longest step that leaves the time part of the error at @p part.
    double
    step_for(const Market &market, const double part)
    {
      const double k =
        market.error.c_2 > 0. ?
          std::pow(part / market.error.c_2, 1. / market.error.q) :
          std::numeric_limits<double>::infinity();
      return std::min(k, market.largest_k);
    }
  } // namespace



  std::vector<StepsUntil>
  read_phases(const std::string &text)
  {
    std::vector<StepsUntil> phases;
    for (const std::string &phase : Utilities::split_string_list(text, ','))
      {
        const auto parts = Utilities::split_string_list(phase, ':');
        phases.push_back(
          {parts.at(0),
           static_cast<unsigned int>(Utilities::string_to_int(parts.at(1)))});
      }
    return phases;
  }



  std::vector<StepsUntil>
  scale_phases(std::vector<StepsUntil> phases, const double factor)
  {
    for (StepsUntil &phase : phases)
      phase.n_steps = static_cast<unsigned int>(std::clamp(
        std::ceil(factor * phase.n_steps * (1. - 1e-12)), 1., most_steps));
    return phases;
  }



  std::string
  write_phases(const std::vector<StepsUntil> &phases)
  {
    std::string text;
    for (const StepsUntil &phase : phases)
      text += (text.empty() ? "" : ", ") + phase.end + ": " +
              std::to_string(phase.n_steps);
    return text;
  }



  unsigned int
  n_steps(const std::vector<StepsUntil> &phases)
  {
    unsigned int n = 0;
    for (const StepsUntil &phase : phases)
      n += phase.n_steps;
    return n;
  }



  double
  Market::dofs_at(const double mesh_width) const
  {
    return dofs * std::pow(h / mesh_width, static_cast<double>(dim));
  }



  double
  Market::seconds(const double mesh_width, const double steps) const
  {
    return cost.seconds(dofs_at(mesh_width),
                        steps,
                        steps_per_mesh > 0. ?
                          std::max(1., std::ceil(steps / steps_per_mesh)) :
                          1.);
  }



  Offer
  offer(const Market &market, const int mesh_level, const double k)
  {
    Offer result;
    result.mesh_level = mesh_level;
    result.h          = market.h * std::pow(0.5, mesh_level);
    result.phases =
      scale_phases(market.phases, market.k / std::min(k, market.largest_k));
    result.k       = largest_step(result.phases);
    result.steps   = n_steps(result.phases);
    result.dofs    = market.dofs_at(result.h);
    result.error   = market.error(result.h, result.k);
    result.seconds = market.seconds(result.h, result.steps);
    result.memory  = market.cost.memory(result.dofs);
    result.is_far  = result.h < 0.49 * market.smallest_h ||
                    result.k < 0.49 * market.smallest_k;
    return result;
  }



  std::optional<Offer>
  cheapest(const Market &market, const double tolerance)
  {
    std::optional<Offer> best;
    if (market.error.n_samples == 0)
      return best;
    for (int level = -market.coarsest_level; level <= finest_level; ++level)
      {
        const double rest = market.error.rest(
          tolerance, market.error.first(market.h * std::pow(0.5, level)));
        if (rest <= 0.)
          continue;
        const double k = step_for(market, rest);
        if (market.k / k * n_steps(market.phases) > most_steps)
          continue;
        const Offer candidate = offer(market, level, k);
        if (!best || candidate.seconds < best->seconds)
          best = candidate;
      }
    return best;
  }



  std::optional<Offer>
  most_accurate(const Market &market, const double seconds)
  {
    std::optional<Offer> best;
    if (market.error.n_samples == 0)
      return best;
    for (int level = -market.coarsest_level; level <= finest_level; ++level)
      {
        // Steps cost the same each, up to rounding in phases.
        double coarse = market.largest_k, fine = market.k * 1e-6;
        if (!std::isfinite(coarse))
          coarse = market.k * n_steps(market.phases);
        if (offer(market, level, coarse).seconds > seconds)
          continue;
        for (unsigned int i = 0; i < 60; ++i)
          {
            const double middle = std::sqrt(coarse * fine);
            (offer(market, level, middle).seconds <= seconds ? coarse : fine) =
              middle;
          }
        const Offer candidate = offer(market, level, coarse);
        if (!best || candidate.error < best->error)
          best = candidate;
      }
    return best;
  }



  double
  ideal_seconds(const Market &market, const double tolerance)
  {
    // A scan over the part of the error that the mesh may have.
    double lowest = std::numeric_limits<double>::infinity();
    for (unsigned int i = 1; i < 400; ++i)
      {
        const double share = i / 400.;
        const double h     = market.error.c_1 > 0. ?
                               std::pow(share * tolerance / market.error.c_1,
                                    1. / market.error.p) :
                               market.h * std::pow(2., market.coarsest_level);
        const double k =
          step_for(market,
                   market.error.c_1 > 0. ?
                     market.error.rest(tolerance, share * tolerance) :
                     tolerance);
        const double steps =
          std::max<double>(market.phases.size(),
                           n_steps(market.phases) * market.k / k);
        lowest = std::min(lowest, market.seconds(h, steps));
      }
    return lowest;
  }



  std::vector<Price>
  list_prices(const Market              &market,
              const std::vector<double> &tolerances,
              const double               budget)
  {
    std::vector<Price> prices;
    for (const double tolerance : tolerances)
      {
        Price price;
        price.tolerance    = tolerance;
        price.offer        = cheapest(market, tolerance);
        price.is_in_budget = price.offer && price.offer->seconds <= budget;
        if (price.offer)
          price.halving = ideal_seconds(market, tolerance / 2.) /
                          ideal_seconds(market, tolerance);
        prices.push_back(price);
      }
    return prices;
  }



  std::string
  in_words(const Market &market, const Price &price, const double budget)
  {
    std::ostringstream text;
    const auto         describe = [&text](const Offer &offer) {
      text << "h = " << digits(offer.h) << " (mesh level " << offer.mesh_level
           << "), " << offer.steps << " steps, " << digits(offer.dofs)
           << " unknowns, about " << seconds_in_words(offer.seconds) << " and "
           << digits(offer.memory, 2) << " MB";
    };
    text << "Error " << digits(price.tolerance) << ": ";
    if (price.is_in_budget)
      {
        describe(*price.offer);
        text << "; half of it costs " << digits(price.halving, 2)
             << " times as much";
        if (price.offer->is_far)
          text << " (far beyond what was measured)";
        return text.str() + '.';
      }
    text << "not within " << seconds_in_words(budget);
    if (price.offer && price.offer->seconds < 3e8)
      text << ", it would take about "
           << seconds_in_words(price.offer->seconds);
    if (const auto best = most_accurate(market, budget))
      {
        text << "; the smallest error there is about " << digits(best->error)
             << ": ";
        describe(*best);
      }
    return text.str() + '.';
  }



  std::string
  next_refinement(const Market &market)
  {
    const Offer        now = offer(market, 0, market.k);
    std::ostringstream text;
    text << "The scene as it is: error about " << digits(now.error) << " ("
         << digits(market.error.first(now.h), 2) << " of the mesh, "
         << digits(market.error.second(now.k), 2) << " of the steps), "
         << seconds_in_words(now.seconds) << ".";
    const auto add = [&](const std::string &what, const Offer &next) {
      text << " Halving " << what << ": error " << digits(next.error) << " for "
           << digits(next.seconds / now.seconds, 2) << " times the seconds.";
      return std::log(now.error / next.error) /
             std::log(std::max(1.001, next.seconds / now.seconds));
    };
    const double of_h = add("h", offer(market, 1, market.k)),
                 of_k = add("k", offer(market, 0, market.k / 2.));
    add("both", offer(market, 1, market.k / 2.));
    text << " Refine "
         << (of_h > 1.2 * of_k ? "the mesh" :
             of_k > 1.2 * of_h ? "the steps" :
                                 "both")
         << " next.";
    return text.str();
  }



  std::string
  seconds_in_words(const double seconds)
  {
    return seconds < 100. ? digits(seconds, 2) + " s" : duration(seconds);
  }



  std::string
  digits(const double value, const unsigned int n)
  {
    std::ostringstream text;
    text << std::setprecision(n) << value;
    // 1.2e+05 is for programs.
    if (std::abs(value) >= std::pow(10., n) - 0.5 && std::abs(value) < 1e9)
      {
        std::ostringstream whole;
        whole << std::lround(value);
        return whole.str();
      }
    return text.str();
  }
} // namespace Viscoplastic
