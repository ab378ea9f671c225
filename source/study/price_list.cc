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

    /// The longest step.
    double
    largest_step(const std::vector<StepsUntil> &phases)
    {
      double largest = 0., start = 0.;
      for (const StepsUntil &phase : phases)
        {
          const double end = Utilities::string_to_double(phase.end);
          largest          = std::max(largest, (end - start) / phase.n_steps);
          start            = end;
        }
      return largest;
    }



    /// The longest step that leaves the time part of the error at @p part.
    double
    step_for(const WorkPrecisionModel &model, const double part)
    {
      const double k = model.error.c_2 > 0. ?
                         std::pow(part / model.error.c_2, 1. / model.error.q) :
                         std::numeric_limits<double>::infinity();
      return std::min(k, model.largest_k);
    }
  } // namespace



  double
  WorkPrecisionModel::dofs_at(const double mesh_width) const
  {
    return dofs * std::pow(h / mesh_width, static_cast<double>(dim));
  }



  double
  WorkPrecisionModel::refinement_of_steps(const double step) const
  {
    return chosen_steps ? std::pow(k / step, 1. / order) : k / step;
  }



  double
  WorkPrecisionModel::steps_at(const double step) const
  {
    return chosen_steps ? (*chosen_steps)(1. / step, 1.) :
                          n_steps(phases) * refinement_of_steps(step);
  }



  double
  WorkPrecisionModel::seconds(const double mesh_width, const double step) const
  {
    const double n_phases = static_cast<double>(phases.size()),
                 steps    = std::max(n_phases, steps_at(step)),
                 planned =
                   std::max(n_phases,
                            n_steps(phases) * refinement_of_steps(step));
    return cost.seconds(dofs_at(mesh_width),
                        steps,
                        n_set_ups(steps,
                                  static_cast<unsigned int>(
                                    std::min(planned, most_steps))));
  }



  PredictedRun
  predict(const WorkPrecisionModel &model, const int mesh_level, const double k)
  {
    PredictedRun result;
    result.mesh_level = mesh_level;
    result.h          = model.h * std::pow(0.5, mesh_level);
    result.k          = std::min(k, model.largest_k);
    result.phases =
      scale_phases(model.phases, model.refinement_of_steps(result.k));
    const unsigned int n_planned = n_steps(result.phases);
    result.steps                 = n_planned;
    if (model.chosen_steps)
      result.steps = static_cast<unsigned int>(
        std::clamp(std::round(model.steps_at(result.k)),
                   static_cast<double>(model.phases.size()),
                   most_steps));
    else
      result.k = largest_step(result.phases);
    result.dofs            = model.dofs_at(result.h);
    result.error           = model.error(result.h, result.k);
    const double n_set_ups = model.n_set_ups(result.steps, n_planned);
    result.seconds = model.cost.seconds(result.dofs, result.steps, n_set_ups);
    result.memory  = model.cost.memory(result.dofs, result.steps, n_set_ups);
    result.solver  = choose_bulk_solver(
      model.cost.demand_at(result.dofs, result.steps, n_set_ups));
    result.is_far = result.h < 0.49 * model.smallest_h ||
                    result.k < std::pow(0.49, model.order) * model.smallest_k;
    return result;
  }



  std::optional<PredictedRun>
  cheapest(const WorkPrecisionModel &model, const double tolerance)
  {
    std::optional<PredictedRun> best;
    if (model.error.misfit.n_samples == 0)
      return best;
    for (int level = -model.coarsest_level; level <= finest_level; ++level)
      {
        const double rest =
          model.error.rest(tolerance,
                           model.error.first(model.h * std::pow(0.5, level)));
        if (rest <= 0.)
          continue;
        const double k = step_for(model, rest);
        if (model.steps_at(k) > most_steps)
          continue;
        const PredictedRun candidate = predict(model, level, k);
        if (!best || candidate.seconds < best->seconds)
          best = candidate;
      }
    return best;
  }



  std::optional<PredictedRun>
  most_accurate(const WorkPrecisionModel &model, const double seconds)
  {
    std::optional<PredictedRun> best;
    if (model.error.misfit.n_samples == 0)
      return best;
    for (int level = -model.coarsest_level; level <= finest_level; ++level)
      {
        // Steps cost the same each, up to rounding in phases.
        double coarse = model.largest_k, fine = model.k * 1e-6;
        if (!std::isfinite(coarse))
          coarse = model.k * n_steps(model.phases);
        if (predict(model, level, coarse).seconds > seconds)
          continue;
        for (unsigned int i = 0; i < 60; ++i)
          {
            const double middle = std::sqrt(coarse * fine);
            (predict(model, level, middle).seconds <= seconds ? coarse : fine) =
              middle;
          }
        const PredictedRun candidate = predict(model, level, coarse);
        if (!best || candidate.error < best->error)
          best = candidate;
      }
    return best;
  }



  double
  ideal_seconds(const WorkPrecisionModel &model, const double tolerance)
  {
    // A scan over the part of the error that the mesh may have.
    double lowest = std::numeric_limits<double>::infinity();
    for (unsigned int i = 1; i < 400; ++i)
      {
        const double share = i / 400.;
        const double h =
          model.error.c_1 > 0. ?
            std::pow(share * tolerance / model.error.c_1, 1. / model.error.p) :
            model.h * std::pow(2., model.coarsest_level);
        const double k =
          step_for(model,
                   model.error.c_1 > 0. ?
                     model.error.rest(tolerance, share * tolerance) :
                     tolerance);
        lowest = std::min(lowest, model.seconds(h, k));
      }
    return lowest;
  }



  std::vector<Price>
  list_prices(const WorkPrecisionModel  &model,
              const std::vector<double> &tolerances,
              const double               budget)
  {
    std::vector<Price> prices;
    for (const double tolerance : tolerances)
      {
        Price price;
        price.tolerance    = tolerance;
        price.run          = cheapest(model, tolerance);
        price.is_in_budget = price.run && price.run->seconds <= budget;
        if (price.run)
          price.halving = ideal_seconds(model, tolerance / 2.) /
                          ideal_seconds(model, tolerance);
        prices.push_back(price);
      }
    return prices;
  }



  std::string
  in_words(const WorkPrecisionModel &model,
           const Price              &price,
           const double              budget)
  {
    std::ostringstream text;
    const auto         describe = [&](const PredictedRun &run) {
      text << "h = " << digits(run.h) << " (mesh level " << run.mesh_level
           << "), ";
      if (model.chosen_steps)
        text << "step tolerance " << digits(run.k) << ", about ";
      text << run.steps << " steps, " << digits(run.dofs) << " unknowns, about "
           << seconds_in_words(run.seconds) << " and " << digits(run.memory, 2)
           << " MB (" << to_string(run.solver) << ')';
    };
    text << "Error " << digits(price.tolerance) << ": ";
    if (price.is_in_budget)
      {
        describe(*price.run);
        text << "; half of it costs " << digits(price.halving, 2)
             << " times as much";
        if (price.run->is_far)
          text << " (far beyond what was measured)";
        return text.str() + '.';
      }
    text << "not within " << seconds_in_words(budget);
    if (price.run && price.run->seconds < 3e8)
      text << ", it would take about " << seconds_in_words(price.run->seconds);
    if (const auto best = most_accurate(model, budget))
      {
        text << "; the smallest error there is about " << digits(best->error)
             << ": ";
        describe(*best);
      }
    return text.str() + '.';
  }



  std::string
  next_refinement(const WorkPrecisionModel &model)
  {
    const PredictedRun now = predict(model, 0, model.k);
    std::ostringstream text;
    text << "The scene as it is: error about " << digits(now.error) << " ("
         << digits(model.error.first(now.h), 2) << " of the mesh, "
         << digits(model.error.second(now.k), 2) << " of the steps), "
         << seconds_in_words(now.seconds) << ".";
    const auto add = [&](const std::string &what, const PredictedRun &next) {
      text << ' ' << what << ": error " << digits(next.error) << " for "
           << digits(next.seconds / now.seconds, 2) << " times the seconds.";
      return std::log(now.error / next.error) /
             std::log(std::max(1.001, next.seconds / now.seconds));
    };
    // In the first order, or with given steps, half of k; else a quarter.
    const double finer_k = model.k / std::pow(2., model.order);
    const double of_h    = add("Halving h", predict(model, 1, model.k)),
                 of_k =
                   add(!model.chosen_steps ? "Halving k" :
                       model.order == 1    ? "Half the step tolerance" :
                                             "A quarter of the step tolerance",
                       predict(model, 0, finer_k));
    add("Both", predict(model, 1, finer_k));
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
    // 1.2e+05 is for programs.
    if (std::abs(value) >= std::pow(10., n) - 0.5 && std::abs(value) < 1e9)
      return std::to_string(std::lround(value));
    std::ostringstream text;
    text << std::setprecision(n) << value;
    return text.str();
  }
} // namespace Viscoplastic
