// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/run_record.h>
#include <viscoplastic_contact/study/effects.h>
#include <viscoplastic_contact/study/effects_report.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// Runs shorter than this are timed twice.
    constexpr double short_run = 1.; // s



    /// The overrides with what `automatic' stands for in the scene: a variant
    /// without a law or with other moduli is to differ by these alone.
    std::vector<std::string>
    with_choices(const std::vector<std::string> &files,
                 std::vector<std::string>        overrides)
    {
      const Parameters scene(files, overrides);
      overrides.push_back(
        "Material/Volumetric integration=" +
        name_of(
          SceneData::of(scene, MPI_COMM_WORLD)->volumetric_integration()));
      return overrides;
    }



    std::unique_ptr<StudyRuns>
    make_runs(const std::vector<std::string> &files,
              std::vector<std::string>        overrides,
              const std::string              &directory)
    {
      overrides.push_back("Output/Directory=" + directory);
      auto runs = std::make_unique<StudyRuns>(files, overrides, MPI_COMM_WORLD);
      runs->may_subdivide = true;
      return runs;
    }



    RunKey
    key_of(const StudyRuns &runs, const int level)
    {
      RunKey key = runs.scene_key();
      if (runs.scene.error_control.has_tolerance())
        key.variant.strategy = MeshStrategy::tolerance;
      key.mesh_level = key.time_level = level;
      return key;
    }



    /// The largest value of a column, where it has values; 0 without any.
    double
    largest_of(const Table &table, const std::string &column)
    {
      double result = 0.;
      if (table.has(column))
        for (const double value : table.columns.at(column))
          result = std::max(result, std::isfinite(value) ? value : 0.);
      return result;
    }



    /// The size of the force of unilateral contact as an expression of t,
    /// linear between the steps; empty without such contact.
    std::string
    contact_force_of(const Table &table)
    {
      if (!table.has("contact_force_x"))
        return "";
      const std::vector<double> &times = table.columns.at("t");
      std::vector<double>        sizes(times.size(), 0.);
      for (const std::string name :
           {"contact_force_x", "contact_force_y", "contact_force_z"})
        if (table.has(name))
          for (std::size_t i = 0; i < sizes.size(); ++i)
            sizes[i] = std::hypot(sizes[i], table.columns.at(name)[i]);
      return piecewise_linear(times, sizes);
    }



    /// Beyond what the process had before.
    double
    own_memory(const RunRecord &record)
    {
      return record.number("peak_memory_MB") - record.number("first_memory_MB");
    }
  } // namespace



  EffectsStudy::EffectsStudy(const std::vector<std::string> &files,
                             const std::vector<std::string> &overrides,
                             Console                        &console)
    : files(files)
    , overrides(with_choices(files, overrides))
    , scene(files, this->overrides)
    , directory(results_directory(scene) + "effects/")
    , console(console)
    , out(console.stream(),
          Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    , data(SceneData::of(scene, MPI_COMM_WORLD))
    , base(make_runs(files, this->overrides, directory + "scene"))
  {}



  std::unique_ptr<StudyRuns>
  EffectsStudy::runs_of(const EffectVariant &variant, const int level) const
  {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), variant.overrides.begin(), variant.overrides.end());
    // Differences from the scene stand in the place of errors, where these are
    // not from the solution that makes the data.
    if (scene.exact_solution.data == DataSource::scene)
      {
        all.emplace_back("Exact solution/Displacement=");
        all.emplace_back("Exact solution/Stress=");
        all.emplace_back("Exact solution/Reference directory=" +
                         base->directory + base->name(key_of(*base, level)));
      }
    auto runs         = make_runs(files, all, directory + variant.name());
    runs->has_outputs = variant.has_outputs;
    return runs;
  }



  bool
  EffectsStudy::is_affordable(const double seconds) const
  {
    return Utilities::MPI::broadcast(MPI_COMM_WORLD, timer.wall_time()) +
             seconds <=
           scene.study.budget;
  }



  EffectsStudy::Attempt
  EffectsStudy::compute(const StudyRuns &runs,
                        const int        level,
                        const double     expected_seconds)
  {
    Attempt    attempt;
    const auto find_or_make = [&](const RunKey &key, const double expected) {
      auto record = runs.find(key);
      if (record)
        return record;
      attempt.is_too_long = !is_affordable(expected);
      if (attempt.is_too_long)
        return record;
      StudyRuns::Outcome outcome = runs.make(key);
      attempt.interruption       = outcome.interruption;
      attempt.failure            = outcome.failure;
      return outcome.record;
    };
    RunKey     key    = key_of(runs, level);
    const auto record = find_or_make(key, expected_seconds);
    if (!record)
      return attempt;
    const double seconds = record->number("seconds_total"),
                 memory  = own_memory(*record);
    attempt.computed =
      Computed{*record,
               read_table(runs.directory + runs.name(key) + "/statistics.csv"),
               {seconds, 0., memory, 0.}};
    // Once more, to know what is chance. Of long runs only the scene, whose
    // chance then stands for that of others, too.
    RunCost &cost = attempt.computed->cost;
    if (seconds > short_run && of_scene.count(level) > 0)
      {
        const RunCost &other = of_scene.at(level).cost;
        cost.seconds_chance  = other.seconds_chance / other.seconds * seconds;
        cost.memory_chance   = other.memory_chance;
        return attempt;
      }
    key.is_timing = true;
    if (const auto again = find_or_make(key, seconds))
      {
        const double seconds_again = again->number("seconds_total"),
                     memory_again  = own_memory(*again);
        cost                       = {std::min(seconds, seconds_again),
                                      std::abs(seconds - seconds_again),
                                      std::min(memory, memory_again),
                                      std::abs(memory - memory_again)};
      }
    // Without time for that, the first run is enough.
    attempt.is_too_long = false;
    return attempt;
  }



  bool
  EffectsStudy::compute_scene(const int level)
  {
    base->reference = key_of(*base, level);
    // The first run is made in any case, another one has twice the resolution
    // in space and time.
    double       expected = -std::numeric_limits<double>::infinity();
    const auto   coarser  = of_scene.find(level - 1);
    const double factor   = std::pow(2., scene.dimension + 1);
    if (coarser != of_scene.end())
      expected = factor * coarser->second.record.number("seconds_total");
    else if (!of_scene.empty())
      expected = 0.;
    Attempt attempt = compute(*base, level, expected);
    interruption    = attempt.interruption;
    if (attempt.failure.empty() && !attempt.computed && interruption.empty())
      failure = "its run would not end within 'Study/Budget'.";
    else
      failure = attempt.failure;
    if (attempt.computed)
      {
        of_scene.emplace(level, std::move(*attempt.computed));
        if (coarser != of_scene.end() && !scene.error_control.has_tolerance())
          compute_with_longer_steps(level);
      }
    return interruption.empty() && of_scene.count(level) > 0;
  }



  void
  EffectsStudy::compute_with_longer_steps(const int level)
  {
    RunKey key     = key_of(*base, level);
    key.time_level = level - 1;
    auto record    = base->find(key);
    if (!record &&
        is_affordable(0.5 * of_scene.at(level).record.number("seconds_total")))
      {
        StudyRuns::Outcome outcome = base->make(key);
        interruption               = outcome.interruption;
        record                     = outcome.record;
      }
    if (record)
      with_longer_steps.emplace(level,
                                read_table(base->directory + base->name(key) +
                                           "/statistics.csv"));
  }



  void
  EffectsStudy::add_errors(std::vector<QuantityChange> &changes,
                           const int                    level) const
  {
    const Computed &with    = of_scene.at(level);
    const auto      coarser = of_scene.find(level - 1);
    const auto      longer  = with_longer_steps.find(level);
    // What halving the mesh and halving the steps have changed, at times of
    // both runs: in a single difference they may cancel. Or the error bar in
    // energy.
    std::vector<QuantityChange> errors;
    if (longer != with_longer_steps.end() && coarser != of_scene.end())
      {
        errors = changes_between(longer->second, with.table);
        const std::vector<QuantityChange> of_mesh =
          changes_between(coarser->second.table, longer->second);
        for (std::size_t q = 0; q < errors.size() && q < of_mesh.size(); ++q)
          errors[q].change += of_mesh[q].change;
      }
    else if (coarser != of_scene.end())
      errors = changes_between(coarser->second.table, with.table);
    for (std::size_t q = 0; q < changes.size(); ++q)
      changes[q].error = q < errors.size() ?
                           errors[q].change :
                           with.record.number("estimate_total");
  }



  std::optional<EffectResult>
  EffectsStudy::compare(const EffectVariant &variant,
                        const int            level,
                        Table               *table)
  {
    console.show_status(variant.effect + ": " + variant.instead);
    const Computed &with = of_scene.at(level);
    base->reference      = key_of(*base, level);
    EffectResult result;
    result.variant = variant;
    result.level   = level;
    result.cells   = with.record.number("cells");
    result.with    = with.cost;
    Attempt                    attempt;
    std::unique_ptr<StudyRuns> runs;
    try
      {
        // What is wrong with its entries is so on all ranks. What is thrown
        // later, one rank alone may have met.
        runs = runs_of(variant, level);
        runs->find(key_of(*runs, level));
      }
    catch (const std::exception &exception)
      {
        attempt.failure = reason(exception);
      }
    if (attempt.failure.empty())
      attempt = compute(*runs, level, with.record.number("seconds_total"));
    interruption = attempt.interruption;
    if (!interruption.empty() || attempt.is_too_long)
      return {};
    if (!attempt.computed)
      {
        result.failure = attempt.failure;
        return result;
      }

    const RunRecord &record = attempt.computed->record;
    result.without          = attempt.computed->cost;
    if (variant.has_outputs)
      {
        // Of what the runs of studies go without.
        result.without.seconds += record.number("seconds_output");
        std::swap(result.with, result.without);
      }
    result.changes    = changes_between(with.table, attempt.computed->table);
    const double size = largest_of(with.table, "energy_norm"),
                 distance = largest_of(attempt.computed->table, "error_energy");
    if (scene.exact_solution.data == DataSource::scene && size > 0.)
      result.changes.push_back({"energy_norm", distance / size, 0.});
    add_errors(result.changes, level);
    judge(result, error_of_iterations(with.table, attempt.computed->table));
    if (table != nullptr)
      *table = std::move(attempt.computed->table);
    return result;
  }



  std::vector<int>
  EffectsStudy::levels() const
  {
    const int        coarsest = scene.error_control.has_tolerance() ?
                                  std::max(-3, base->coarsest_tolerance_level()) :
                                  -std::min(2, base->n_coarser_meshes());
    std::vector<int> result;
    for (int level = std::min(0, coarsest); level <= 0; ++level)
      result.push_back(level);
    return result;
  }



  void
  EffectsStudy::keep(const EffectResult &result)
  {
    const auto known =
      std::find_if(results.begin(),
                   results.end(),
                   [&result](const EffectResult &other) {
                     return other.variant.name() == result.variant.name();
                   });
    if (known == results.end())
      results.push_back(result);
    else
      *known = result;
    const auto size = [](const EffectResult &of) {
      return of.failure.empty() ? of.decisive.change : 1e300;
    };
    std::stable_sort(results.begin(),
                     results.end(),
                     [&](const EffectResult &a, const EffectResult &b) {
                       if (a.variant.kind != b.variant.kind)
                         return a.variant.kind < b.variant.kind;
                       return size(a) > size(b);
                     });
  }



  void
  EffectsStudy::judge_on(const int level, std::vector<EffectVariant> &open)
  {
    std::vector<EffectVariant> undecided;
    for (const EffectVariant &variant : open)
      {
        const auto result = compare(variant, level);
        if (!interruption.empty())
          return;
        if (result)
          keep(*result);
        // What cannot be computed here may be so with smaller steps.
        if (!result || result->is_open() ||
            (!result->failure.empty() && level < 0))
          undecided.push_back(variant);
        write(false);
      }
    open = std::move(undecided);
  }



  void
  EffectsStudy::judge_all(std::vector<EffectVariant> open)
  {
    const std::vector<int> all_levels = levels();
    for (const int level : all_levels)
      {
        const bool has_coarser = of_scene.count(level - 1) > 0;
        if (!compute_scene(level))
          {
            if (!interruption.empty())
              return;
            if (!has_coarser)
              continue; // too coarse
            // With the error bar in the place of a coarser run.
            if (results.empty())
              judge_on(level - 1, open);
            break;
          }
        if (open.empty())
          {
            open = effect_variants(scene,
                                   *data,
                                   largest_of(of_scene.at(level).table,
                                              "mean_von_mises"),
                                   contact_force_of(of_scene.at(level).table));
            out << "Effects of " << scene.file << ": " << open.size()
                << " simplifications" << std::endl;
          }
        // The first one is what the next is compared with.
        if (has_coarser || level == all_levels.back())
          judge_on(level, open);
        if (open.empty() || !interruption.empty())
          return;
      }
    AssertThrow(!of_scene.empty(),
                ExcMessage("The scene itself could not be computed: " +
                           failure));
    // Those that are open on the mesh of the scene are settled.
    unsigned int n_open = 0;
    std::string  missing;
    for (const EffectVariant &variant : open)
      {
        const auto known =
          std::find_if(results.begin(),
                       results.end(),
                       [&variant](const EffectResult &result) {
                         return result.variant.name() == variant.name();
                       });
        if (known == results.end())
          missing += (missing.empty() ? "" : "; ") + variant.effect + ": " +
                     variant.instead;
        else if (known->level < 0)
          ++n_open;
      }
    if (!missing.empty())
      left_out = "No time within 'Study/Budget' for " + missing + ". ";
    if (n_open > 0)
      left_out +=
        "Finer meshes might tell " + std::to_string(n_open) +
        " of them from the error" +
        (failure.empty() ?
           ", but not within 'Study/Budget'." :
           ", but on these the scene could not be computed: " + failure);
  }



  void
  EffectsStudy::find_interaction()
  {
    // Everything depends on the loads.
    const EffectResult *first = nullptr, *second = nullptr;
    for (const EffectResult &result : results)
      if (result.variant.kind == EffectKind::problem &&
          !result.variant.is_load &&
          result.verdict == EffectVerdict::called_for)
        {
          if (first == nullptr)
            first = &result;
          else if (second == nullptr &&
                   !first->variant.excludes(result.variant))
            second = &result;
        }
    if (second == nullptr)
      return;
    const int  level = std::max(first->level, second->level);
    Table      of_first, of_second, of_both;
    const auto one = compare(first->variant, level, &of_first);
    const auto two = one ? compare(second->variant, level, &of_second) : one;
    const auto joint =
      two ? compare(both(first->variant, second->variant), level, &of_both) :
            two;
    if (!joint || !one->failure.empty() || !two->failure.empty() ||
        !joint->failure.empty())
      return;

    EffectResult sum;
    sum.changes =
      interactions(of_scene.at(level).table, of_first, of_second, of_both);
    add_errors(sum.changes, level);
    judge(sum, error_of_iterations(of_first, of_both));
    interaction = EffectInteraction{*one, *two, *joint, sum.decisive};
  }



  std::string
  EffectsStudy::run()
  {
    base->lock_directory();
    judge_all({});
    if (interruption.empty())
      find_interaction();
    if (!interruption.empty())
      return interruption.substr(0, interruption.find(" has ended")) +
             " has ended the study of effects; the same command goes on.";
    write(true);
    out << in_words(*this) << "Results in " << directory << std::endl;
    return "";
  }



  void
  EffectsStudy::write(const bool is_finished) const
  {
    if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      write_effects(*this, is_finished);
  }
} // namespace Viscoplastic
