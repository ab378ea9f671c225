// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/price_list.h>
#include <viscoplastic_contact/study/tolerance_model.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  PredictedToleranceRun
  ToleranceModel::predict(const double tolerance) const
  {
    const double x = 1. / tolerance;
    return {tolerance,
            error(tolerance, 1.),
            seconds(x, 1.),
            cells(x, 1.),
            dofs(x, 1.),
            steps(x, 1.),
            memory(x, 1.)};
  }



  double
  ToleranceModel::tolerance_for(const double wanted, const double largest) const
  {
    double tolerance = std::pow(wanted / error.c_1, 1. / error.p);
    // What a run promises is worth more than what it is expected to give.
    if (is_kept)
      tolerance = std::min(tolerance, wanted);
    return std::min(tolerance, largest);
  }



  std::optional<double>
  ToleranceModel::tolerance_within(const double limit) const
  {
    const double rest = limit - seconds.second(1.);
    if (rest <= 0. || seconds.c_1 <= 0.)
      return {};
    return std::pow(rest / seconds.c_1, -1. / seconds.p);
  }



  ToleranceModel
  fit_tolerance(const std::vector<ToleranceSample> &samples,
                const unsigned int                  dim,
                const unsigned int                  order,
                const std::optional<double>         reference,
                const double                        m)
  {
    ToleranceModel model;
    model.smallest_tolerance = std::numeric_limits<double>::infinity();
    for (const ToleranceSample &sample : samples)
      model.smallest_tolerance =
        std::min(model.smallest_tolerance, sample.tolerance);

    // Meshes come in generations of cells: errors and costs are off their
    // powers by some 10 %, as seconds are.
    const auto prior = [](const double exponent, const double weight = 0.3) {
      Prior result;
      result.p      = exponent;
      result.weight = weight;
      return result;
    };
    std::vector<Sample> errors;
    for (const ToleranceSample &sample : samples)
      errors.push_back({sample.tolerance, 1., sample.error});
    Prior of_error       = prior(1.);
    of_error.is_one_term = true;
    std::optional<Finer> finer;
    if (reference)
      finer = Finer{*reference, 1., m, 1.};
    model.error = fit_two_powers(errors, of_error, 1e-13, finer);

    const auto fit = [&](double ToleranceSample::*cost, const Prior &of_cost) {
      std::vector<Sample> costs;
      for (const ToleranceSample &sample : samples)
        costs.push_back({1. / sample.tolerance, 1., sample.*cost});
      return fit_two_powers(costs, of_cost);
    };
    const double d = dim, of_steps = 1. / order;
    model.seconds = fit(&ToleranceSample::seconds, prior(d + of_steps));
    model.cells   = fit(&ToleranceSample::cells, prior(d));
    model.dofs    = fit(&ToleranceSample::dofs, prior(d));
    model.steps   = fit(&ToleranceSample::steps, prior(of_steps));
    // The program itself hides it.
    model.memory = fit(&ToleranceSample::memory, prior(d, 10.));
    return model;
  }



  TolerancePrice
  price_of(const ToleranceModel &model, const double error, const double budget)
  {
    TolerancePrice price;
    price.error        = error;
    price.run          = model.predict(model.tolerance_for(error));
    price.is_in_budget = price.run.seconds <= budget;
    price.is_far       = price.run.tolerance < 0.24 * model.smallest_tolerance;
    price.halving = model.predict(model.tolerance_for(error / 2.)).seconds /
                    price.run.seconds;
    return price;
  }



  std::string
  in_words(const ToleranceModel &model,
           const TolerancePrice &price,
           const double          budget)
  {
    std::ostringstream text;
    const auto         describe = [&text](const PredictedToleranceRun &run) {
      text << "tolerance " << digits(run.tolerance) << ", on average "
           << digits(run.cells) << " cells and " << digits(run.dofs)
           << " unknowns, " << std::lround(run.steps) << " steps, about "
           << seconds_in_words(run.seconds) << " and " << digits(run.memory, 2)
           << " MB";
    };
    text << "Error " << digits(price.error) << ": ";
    if (price.is_in_budget)
      {
        describe(price.run);
        text << "; half of it costs " << digits(price.halving, 2)
             << " times as much";
        if (price.is_far)
          text << " (far beyond what was measured)";
        return text.str() + '.';
      }
    text << "not within " << seconds_in_words(budget);
    if (price.run.seconds < 3e8)
      text << ", it would take about " << seconds_in_words(price.run.seconds);
    if (const auto tolerance = model.tolerance_within(budget))
      {
        const PredictedToleranceRun best = model.predict(*tolerance);
        text << "; the smallest error there is about " << digits(best.error)
             << ": ";
        describe(best);
      }
    return text.str() + '.';
  }



  std::string
  exponents_in_words(const ToleranceModel &model)
  {
    std::ostringstream text;
    const auto         exponent = [&](const TwoPowers &cost) {
      return "error^-" + digits(model.exponent(cost), 2);
    };
    text << "Seconds grow as " << exponent(model.seconds)
         << ", the mean number of cells as " << exponent(model.cells)
         << ", steps as " << exponent(model.steps) << '.';
    return text.str();
  }
} // namespace Viscoplastic
