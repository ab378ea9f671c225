// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/parameters/time_schedule.h>
#include <viscoplastic_contact/study/study_analysis.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    bool
    is_norm(const std::string &measure)
    {
      return std::find(field_errors.begin(), field_errors.end(), measure) !=
             field_errors.end();
    }



    /// "friction_force_x" as "friction_force" and 'x'; others are scalars.
    bool
    is_component(const std::string &quantity)
    {
      const std::size_t n = quantity.size();
      return n > 2 && quantity[n - 2] == '_' && quantity[n - 1] >= 'x';
    }



    /// What has the same unit.
    std::string
    kind_of(const std::string &quantity)
    {
      const auto contains = [&quantity](const std::string &word) {
        return quantity.find(word) != std::string::npos;
      };
      return contains("force") || contains("reaction")     ? "force" :
             contains("dissipation") || contains("energy") ? "energy" :
             contains("point") || contains("displacement") ? "length" :
                                                             quantity;
    }



    /// The size of a quantity; for a component that of its vector. Zero for
    /// what only rounding keeps from being that.
    double
    size_of(const RunRecord &record, const std::string &quantity)
    {
      double size = 0., largest = 0.;
      for (const auto &[name, value] : record.quantities)
        {
          if (!std::isfinite(value))
            continue;
          if (name == quantity ||
              (is_component(name) && is_component(quantity) &&
               name.compare(
                 0, name.size() - 1, quantity, 0, quantity.size() - 1) == 0))
            size += value * value;
          if (kind_of(name) == kind_of(quantity))
            largest = std::max(largest, std::abs(value));
        }
      size = std::sqrt(size);
      return size > 1e-9 * largest ? size : 0.;
    }
  } // namespace



  double
  quantity_error(const RunRecord   &record,
                 const std::string &quantity,
                 const RunRecord   *reference)
  {
    if (reference == nullptr || record.key == reference->key)
      return not_a_number;
    const double size = size_of(*reference, quantity);
    return size > 0. ? std::abs(record.quantity(quantity) -
                                reference->quantity(quantity)) /
                         size :
                       not_a_number;
  }



  double
  error_of(const RunRecord   &record,
           const std::string &measure,
           const RunRecord   *reference)
  {
    if (record.numbers.count(measure) > 0)
      return record.number(measure);
    if (measure != "quantities")
      return quantity_error(record,
                            measure.substr(0, measure.rfind("_error")),
                            reference);
    double largest = not_a_number;
    for (const auto &entry : record.quantities)
      {
        const double error = quantity_error(record, entry.first, reference);
        if (std::isfinite(error) && !(error <= largest))
          largest = error;
      }
    return largest;
  }



  std::string
  best_measure(const Records     &records,
               const RunRecord   *reference,
               const unsigned int n_least)
  {
    for (const std::string measure :
         {"estimate_quantity", "error_energy", "estimate_total", "quantities"})
      if (std::count_if(
            records.begin(), records.end(), [&](const RunRecord *record) {
              const double error = error_of(*record, measure, reference);
              return std::isfinite(error) && error > 0.;
            }) >= static_cast<long>(n_least))
        return measure;
    return "";
  }



  std::string
  measure_in_words(const std::string &measure)
  {
    static const std::map<std::string, std::string> words{
      {"estimate_quantity", "estimated error of the quantity of interest"},
      {"error_energy", "error of u in the energy norm"},
      {"estimate_total", "estimated error of u in the energy norm"},
      {"quantities", "largest error of all quantities of interest"}};
    return words.at(measure);
  }



  Records
  of_variant(const Records &records, const MethodVariant &variant)
  {
    Records result;
    for (const RunRecord *record : records)
      if (record->key.variant == variant)
        result.push_back(record);
    return result;
  }



  TwoPowers
  fit_measure(const Records     &records,
              const std::string &measure,
              const RunRecord   *reference)
  {
    std::vector<Sample> samples;
    std::vector<double> space, time;
    bool                are_differences = false;
    for (const RunRecord *record : records)
      {
        samples.push_back({record->number("h"),
                           record->step_measure(),
                           error_of(*record, measure, reference)});
        space.push_back(record->number("estimate_space") +
                        record->number("estimate_initial"));
        time.push_back(record->number("estimate_time"));
        are_differences |= record->numbers.count("is_difference") > 0;
      }
    if (measure == "estimate_total")
      return fit_error_parts(samples, space, time);
    // A reference with meshes of its own is on no ladder of h and k.
    if (reference == nullptr || reference->numbers.count("tolerance") > 0 ||
        (is_norm(measure) && !are_differences))
      return fit_error(samples);
    return fit_error(samples,
                     Finer{reference->number("h"),
                           reference->step_measure(),
                           is_norm(measure) ? 2. : 1.,
                           1.});
  }



  TwoPowers
  fit_chosen_steps(const Records &records)
  {
    std::vector<Sample> samples;
    for (const RunRecord *record : records)
      samples.push_back(
        {1. / record->number("step_tolerance"), 1., record->number("steps")});
    Prior prior;
    prior.p      = 1. / records.front()->key.variant.order();
    prior.weight = 0.3; // some 10 % of chance
    return fit_two_powers(samples, prior);
  }



  double
  expected_steps(const StudyRuns &runs,
                 const Records   &records,
                 const RunKey    &key)
  {
    const double planned = n_steps(runs.phases_of(key));
    if (!runs.scene.step_control.is_on())
      return planned;
    const double n_phases = static_cast<double>(runs.phases.size());
    return std::max(n_phases,
                    fit_chosen_steps(records)(1. / runs.step_tolerance(key),
                                              1.));
  }



  CostModel
  cost_of(const Records &records)
  {
    std::vector<CostSample> samples;
    for (const RunRecord *record : records)
      samples.push_back({record->solver_demand,
                         record->number("steps"),
                         record->number("set_ups"),
                         record->number("seconds_set_up"),
                         record->number("seconds_total"),
                         record->number("peak_memory_MB")});
    return fit_cost(samples);
  }



  WorkPrecisionModel
  fit_work_precision(const StudyRuns   &runs,
                     const Records     &records,
                     const Records     &timed,
                     const std::string &measure,
                     const RunRecord   *reference)
  {
    WorkPrecisionModel model;
    model.error  = fit_measure(records, measure, reference);
    model.dim    = runs.scene.dimension;
    model.cost   = cost_of(timed);
    model.h      = runs.h;
    model.phases = runs.phases;
    model.k      = TimeSchedule(runs.scene.time.phases).largest_step().k;
    if (runs.scene.step_control.is_on())
      {
        model.k            = runs.scene.step_control.tolerance;
        model.order        = records.front()->key.variant.order();
        model.chosen_steps = fit_chosen_steps(timed);
      }
    model.smallest_h = model.smallest_k =
      std::numeric_limits<double>::infinity();
    model.coarsest_level = std::numeric_limits<int>::min();
    double largest_k     = 0.;
    for (const RunRecord *record : records)
      {
        const double h = record->number("h"), k = record->step_measure(),
                     limit = record->number("step_limit");
        // Nothing coarser than what was measured: there errors obey no law.
        model.coarsest_level =
          std::max(model.coarsest_level, -record->key.mesh_level);
        largest_k        = std::max(largest_k, k);
        model.smallest_k = std::min(model.smallest_k, k);
        // From the finest mesh, whose boundary counts least.
        if (h < model.smallest_h)
          {
            model.smallest_h = h;
            model.dofs       = record->number("dofs") *
                         std::pow(h / model.h, static_cast<double>(model.dim));
          }
        // Stresses may lower it still; implicit schemes go beyond, and step
        // control looks after it.
        if (!model.chosen_steps && std::isfinite(limit) && limit >= k)
          model.largest_k = std::min(model.largest_k, 0.95 * limit);
      }
    model.largest_k = std::min(model.largest_k, largest_k);
    model.n_set_ups = [&runs, strategy = records[0]->key.variant.strategy](
                        const double steps, const unsigned int n_planned) {
      return runs.n_set_ups(strategy, steps, n_planned);
    };
    return model;
  }



  ToleranceModel
  fit_tolerance_runs(const StudyRuns   &runs,
                     const Records     &records,
                     const std::string &measure,
                     const RunRecord   *reference)
  {
    // Where the first mesh is better than a tolerance asks for, the error does
    // not depend on it. Otherwise a run keeps the estimate near three quarters
    // of the tolerance.
    const bool of_quantity    = !runs.scene.error_control.quantity.empty();
    const auto has_first_mesh = [&](const RunRecord *record) {
      return record->number(of_quantity ? "estimate_quantity" :
                                          "estimate_total") <
               0.6 * record->number("tolerance") ||
             std::abs(record->number("cells") / runs.n_cells - 1.) < 1e-3;
    };
    const bool have_others =
      !std::all_of(records.begin(), records.end(), has_first_mesh);
    std::vector<ToleranceSample> samples;
    bool                         are_differences = !is_norm(measure);
    for (const RunRecord *record : records)
      {
        samples.push_back({record->number("tolerance"),
                           have_others && has_first_mesh(record) ?
                             not_a_number :
                             error_of(*record, measure, reference),
                           record->number("seconds_total"),
                           record->number("cells"),
                           record->number("dofs"),
                           record->number("steps"),
                           record->number("peak_memory_MB")});
        are_differences |= record->numbers.count("is_difference") > 0;
      }
    const bool is_estimate =
      measure == (of_quantity ? "estimate_quantity" : "estimate_total");
    std::optional<double> finer;
    if (are_differences && !is_estimate && reference != nullptr &&
        reference->numbers.count("tolerance") > 0)
      finer = reference->number("tolerance");
    // Schemes may differ from run to run, but not in one method variant.
    const Parameters of_variant(runs.files,
                                runs.overrides_of(records.front()->key));
    ToleranceModel   model = fit_tolerance(samples,
                                         runs.scene.dimension,
                                         order_of(of_variant.time.scheme),
                                         finer,
                                         is_norm(measure) ? 2. : 1.);
    model.is_kept          = is_estimate;
    return model;
  }



  std::vector<Richardson>
  extrapolate(const std::array<const RunRecord *, 3> &runs)
  {
    std::vector<Richardson> result;
    for (const auto &entry : runs[2]->quantities)
      {
        Richardson r;
        r.quantity = entry.first;
        for (unsigned int i = 0; i < 3; ++i)
          r.values[i] = runs[i]->quantity(r.quantity);
        const double first = r.values[1] - r.values[0],
                     last  = r.values[2] - r.values[1],
                     size  = size_of(*runs[2], r.quantity);
        if (!(size > 0.))
          continue;
        const double ratio = first / last;
        if (!(std::abs(last) > 1e-12 * size)) // nothing left to converge
          r = {r.quantity, r.values, not_a_number, r.values[2], 0., true};
        else
          {
            r.order          = ratio > 0. ? std::log2(ratio) : not_a_number;
            r.is_trustworthy = r.order >= 0.5 && r.order <= 3.;
            r.extrapolated   = r.is_trustworthy ?
                                 r.values[2] + last / (ratio - 1.) :
                                 not_a_number;
            r.error =
              std::abs(r.is_trustworthy ? r.extrapolated - r.values[2] : last) /
              size;
          }
        result.push_back(r);
      }
    return result;
  }
} // namespace Viscoplastic
