// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/timer.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/study/study.h>
#include <viscoplastic_contact/study/study_report.h>
#include <viscoplastic_contact/study/timing_runs.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  Records
  Study::records() const
  {
    Records result;
    for (const PlannedRun &run : plan)
      if (run.record)
        result.push_back(&*run.record);
    return result;
  }



  Records
  Study::timed(const MethodVariant &variant) const
  {
    Records    result = of_variant(records(), variant);
    const auto more   = timings.find(variant.name());
    if (more != timings.end())
      for (const RunRecord &record : more->second)
        result.push_back(&record);
    return result;
  }



  const RunRecord *
  Study::reference() const
  {
    const RunRecord *finest = nullptr;
    for (const PlannedRun &run : plan) // from cheap to expensive
      {
        if (run.is_reference && run.record)
          return &*run.record;
        if (run.record && run.key.variant.strategy == reference_strategy &&
            run.ladders.count(Ladder::both) > 0)
          finest = &*run.record;
      }
    return finest;
  }



  std::vector<MethodVariant>
  Study::variants() const
  {
    std::vector<MethodVariant> result;
    for (const PlannedRun &run : plan)
      if (run.record && !run.is_reference &&
          std::find(result.begin(), result.end(), run.key.variant) ==
            result.end())
        result.push_back(run.key.variant);
    return result;
  }



  double
  Study::expected_seconds(const RunKey &key) const
  {
    // Those of the same variant, or else as similar as there are.
    Records known = of_variant(records(), key.variant);
    if (known.empty())
      for (const RunRecord *record : records())
        if (record->key.variant.strategy == key.variant.strategy)
          known.push_back(record);
    const bool to_tolerance = key.variant.strategy == MeshStrategy::tolerance;
    if (known.empty() && !to_tolerance)
      for (const RunRecord *record : records())
        if (record->key.variant.strategy != MeshStrategy::tolerance)
          known.push_back(record);
    if (known.empty())
      return std::numeric_limits<double>::quiet_NaN();
    if (to_tolerance)
      return fit_tolerance_runs(runs, known, "estimate_total", nullptr)
        .predict(runs.tolerance(key))
        .seconds;
    const double      dim  = runs.scene.dimension;
    const std::string name = key.variant.name();
    if (costs.count(name) == 0)
      costs.emplace(name, cost_of(known));
    const RunRecord *finest =
      *std::max_element(known.begin(),
                        known.end(),
                        [](const auto *a, const auto *b) {
                          return a->key.mesh_level < b->key.mesh_level;
                        });
    const double dofs =
      finest->number("dofs") *
      std::pow(2., dim * (key.mesh_level - finest->key.mesh_level));
    const double steps = expected_steps(runs, known, key);
    return costs.at(name).seconds(dofs,
                                  steps,
                                  runs.n_set_ups(key.variant.strategy,
                                                 steps,
                                                 n_steps(runs.phases_of(key))));
  }



  double
  Study::seconds_left() const
  {
    double seconds = 0.;
    for (const PlannedRun &run : plan)
      if (!run.record && run.skipped.empty())
        seconds += expected_seconds(run.key);
    return seconds;
  }



  double
  Study::elapsed() const
  {
    return Utilities::MPI::broadcast(MPI_COMM_WORLD, timer.wall_time());
  }



  void
  Study::announce(const RunRecord &record) const
  {
    std::ostringstream text;
    text << std::setprecision(3) << record.name << ": "
         << std::lround(record.number("cells")) << " cells, "
         << record.number("steps") << " steps";
    for (const auto &[column, word] :
         {std::make_pair("error_energy", "error "),
          std::make_pair("error_stress", "of the stress "),
          std::make_pair("estimate_total", "estimate "),
          std::make_pair("estimate_quantity", "of the quantity ")})
      if (std::isfinite(record.number(column)))
        text << ", " << word << record.number(column);
    text << ", " << seconds_in_words(record.number("seconds_total"));

    const auto n_left =
      std::count_if(plan.begin(), plan.end(), [](const PlannedRun &run) {
        return !run.record && run.skipped.empty();
      });
    if (n_left > 0)
      {
        const double seconds   = seconds_left();
        const double in_budget = std::max(0., parameters.budget - elapsed());
        text << "; " << n_left << " left";
        if (std::isfinite(seconds)) // otherwise some are of an unknown kind
          text << ", about " << seconds_in_words(seconds);
        if (seconds > in_budget)
          text << " of which " << seconds_in_words(in_budget)
               << " are in the budget";
      }
    out << text.str() << std::endl;
  }



  void
  Study::find_finished()
  {
    for (PlannedRun &run : plan)
      run.record = runs.find(run.key);
    costs.clear();
  }



  std::string
  Study::make(PlannedRun &run)
  {
    const std::string name      = runs.name(run.key);
    const double      seconds   = expected_seconds(run.key);
    const bool        is_known  = std::isfinite(seconds);
    const double      in_budget = parameters.budget - elapsed();
    if ((is_known ? seconds : 0.) > in_budget)
      {
        run.skipped =
          (is_known ?
             "would take about " + seconds_in_words(seconds) + ", and " :
             "") +
          seconds_in_words(std::max(0., in_budget)) +
          " of 'Study/Budget' = " + seconds_in_words(parameters.budget) +
          " were left";
        out << name << ": left out" << (is_known ? ", it " : ", ")
            << run.skipped << std::endl;
        return "";
      }
    console.show_status(
      name + (is_known ? ": running, about " + seconds_in_words(seconds) :
                         ": running"));
    StudyRuns::Outcome outcome = runs.make(run.key);
    if (!outcome.interruption.empty())
      {
        report(false);
        return interruption_in(name, outcome.interruption);
      }
    if (!outcome.record)
      {
        run.skipped = "failed: " + outcome.failure;
        console.remark(name + ' ' + run.skipped);
        return "";
      }
    run.record = std::move(outcome.record);
    costs.clear();
    announce(*run.record);
    // The fits of a large study take as long as a small run.
    if (elapsed() - last_report > 10.)
      {
        report(false);
        last_report = elapsed();
      }
    return "";
  }



  std::string
  Study::interruption_in(const std::string &run,
                         const std::string &sentence) const
  {
    return sentence.substr(0, sentence.find(" has ended")) +
           " has ended the study in the run " + run +
           "; the same command goes on.";
  }



  std::string
  Study::make_timings()
  {
    for (const VariantResult &result : analyze(*this))
      {
        if (result.variant.strategy == MeshStrategy::tolerance)
          continue;
        const std::string name       = result.variant.name();
        int               mesh_level = 0;
        double            spent = 0., largest = 0.;
        for (const Price &price : result.prices)
          {
            if (price.run)
              mesh_level = std::max(mesh_level, price.run->mesh_level);
            if (price.is_in_budget)
              largest = std::max(largest, price.run->seconds);
          }
        for (const RunRecord *record : result.records)
          spent += record->number("seconds_total");
        TimingRuns found =
          make_timing_runs(runs,
                           result.records,
                           mesh_level,
                           std::min(seconds_for_timing(spent, largest),
                                    parameters.budget - elapsed()),
                           console);
        for (const RunRecord &record : found.records)
          announce(record);
        timings[name] = std::move(found.records);
        if (!found.interruption.empty())
          {
            report(false);
            return interruption_in("for timing of " + name, found.interruption);
          }
      }
    return "";
  }



  std::string
  Study::make_first_runs()
  {
    const RunKey last = plan.back().key;
    find_finished();
    for (PlannedRun &run : plan)
      if (!run.record && run.key.variant == last.variant &&
          run.key.mesh_level == run.key.time_level &&
          run.key.mesh_level + 2 < last.mesh_level)
        {
          const std::string interruption = make(run);
          if (!interruption.empty())
            return interruption;
          // Two tell that there will have to be fewer levels.
          if (records().size() >= 2 && can_take_fewer_levels() &&
              seconds_left() > parameters.budget - elapsed())
            return "";
        }
    return "";
  }



  bool
  Study::can_take_fewer_levels() const
  {
    return reference_strategy != MeshStrategy::tolerance &&
           n_levels > fewest_levels;
  }



  std::string
  Study::levels_in_words() const
  {
    return n_levels == parameters.levels ?
             "" :
             "'Study/Budget' does not reach the reference run of " +
               std::to_string(parameters.levels) +
               " levels: the ladders have " + std::to_string(n_levels) + ".";
  }



  bool
  Study::find_reference()
  {
    for (; n_levels >= fewest_levels; --n_levels)
      {
        make_plan();
        runs.reference    = plan.back().key;
        const auto record = runs.find(plan.back().key);
        // Of fewer levels, as those of an earlier call may be, unless the
        // budget reaches further now: the next one has twice the steps on 2^dim
        // times the cells, and all other runs take about as long as it.
        if (record && (n_levels == parameters.levels ||
                       std::pow(2., runs.scene.dimension + 2) *
                           record->number("seconds_total") >
                         parameters.budget))
          {
            if (n_levels < parameters.levels)
              out << levels_in_words() << std::endl;
            return true;
          }
        if (reference_strategy == MeshStrategy::tolerance)
          break;
      }
    n_levels = parameters.levels;
    make_plan();
    runs.reference.reset();
    return false;
  }



  std::string
  Study::make_reference()
  {
    if (find_reference())
      return "";
    while (true)
      {
        const RunKey key = plan.back().key; // nothing costs more
        Assert(plan.back().is_reference, ExcInternalError());
        runs.reference = key;
        if (runs.find(key))
          return "";
        runs.reference.reset();
        const std::string interruption = make_first_runs();
        if (!interruption.empty())
          return interruption;
        const double left = parameters.budget - elapsed();
        if (!can_take_fewer_levels() || !(seconds_left() > left))
          break;
        --n_levels;
        make_plan();
      }
    if (n_levels < parameters.levels)
      out << levels_in_words() << std::endl;
    PlannedRun &last               = plan.back();
    runs.reference                 = last.key;
    const std::string interruption = make(last);
    if (!last.record)
      {
        runs.reference.reset();
        out << "The study goes on without a reference run." << std::endl;
      }
    return interruption;
  }



  std::string
  Study::run()
  {
    runs.lock_directory();
    out << "Study of " << runs.scene.file << ": " << plan.size() << " runs"
        << std::endl;
    if (!has_exact_solution)
      {
        const std::string interruption = make_reference();
        if (!interruption.empty())
          return interruption;
      }
    find_finished();
    if (!records().empty())
      out << "Finished already: " << records().size() << std::endl;
    for (PlannedRun &run : plan)
      if (!run.record && run.skipped.empty())
        {
          const std::string interruption = make(run);
          if (!interruption.empty())
            return interruption;
        }

    std::string failure = "'Study/Budget' leaves no time.";
    for (const PlannedRun &run : plan)
      if (!run.skipped.empty())
        failure = "the run " + runs.name(run.key) + ' ' + run.skipped;
    AssertThrow(!records().empty(),
                ExcMessage("No run of the study could be computed: " +
                           failure));
    const std::string interruption = make_timings();
    if (!interruption.empty())
      return interruption;
    report(true);
    out << prices_in_words(*this) << "Results in " << runs.directory
        << "\nPictures: contrib/plot " << runs.directory << std::endl;
    return "";
  }



  void
  Study::report(const bool is_finished) const
  {
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0 &&
        !records().empty())
      write_report(*this, is_finished);
  }
} // namespace Viscoplastic
