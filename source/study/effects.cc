// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/output.h>
#include <viscoplastic_contact/study/effects.h>
#include <viscoplastic_contact/study/effects_report.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// Changes by so many errors are changes.
    constexpr double clear = 2.;

    /// The largest bound on the error of the iterations, of both runs.
    double
    error_of_iterations(const Table &run, const Table &other)
    {
      double result = 1e-10;
      for (const Table *table : {&run, &other})
        if (table->has("algebraic_error"))
          for (const double value : table->columns.at("algebraic_error"))
            result = std::max(result, std::isfinite(value) ? value : 0.);
      return result;
    }



    EffectVerdict
    judge(const std::vector<QuantityChange> &changes, const double smallest)
    {
      bool acts = false, is_above = false, is_clear = false;
      for (const QuantityChange &quantity : changes)
        {
          acts |= quantity.change > smallest;
          is_above |= quantity.change > std::max(quantity.error, smallest);
          is_clear |= quantity.change > clear * quantity.error + smallest;
        }
      return !acts    ? EffectVerdict::never_acted :
             is_clear ? EffectVerdict::called_for :
             is_above ? EffectVerdict::as_large_as_the_error :
                        EffectVerdict::below_the_error;
    }



    /// Whether both set the same entry.
    bool
    overlap(const EffectVariant &first, const EffectVariant &second)
    {
      const auto entry = [](const std::string &assignment) {
        return assignment.substr(0, assignment.find('='));
      };
      for (const std::string &a : first.overrides)
        for (const std::string &b : second.overrides)
          if (entry(a) == entry(b))
            return true;
      return first.effect == second.effect;
    }
  } // namespace



  std::string
  to_string(const EffectVerdict verdict)
  {
    switch (verdict)
      {
        case EffectVerdict::called_for:
          return "called for";
        case EffectVerdict::below_the_error:
          return "below the error of this discretization";
        case EffectVerdict::as_large_as_the_error:
          return "as large as the error of this discretization";
        case EffectVerdict::never_acted:
          return "never acted";
        default:
          return "cannot be left out";
      }
  }



  EffectsStudy::EffectsStudy(const std::vector<std::string> &files,
                             const std::vector<std::string> &overrides,
                             Console                        &console)
    : scene(files, overrides)
    , directory(results_directory(scene) + "effects/")
    , files(files)
    , overrides(overrides)
    , console(console)
    , out(console.stream(),
          Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    , base(runs_of({"scene", "", "", {}, true}))
  {}



  std::unique_ptr<StudyRuns>
  EffectsStudy::runs_of(const EffectVariant &variant) const
  {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), variant.overrides.begin(), variant.overrides.end());
    all.push_back("Output/Directory=" + directory + variant.name);
    if (base && scene.exact_solution.displacement.empty())
      all.push_back("Exact solution/Reference directory=" + base->directory +
                    base->name(*base->reference));
    return std::make_unique<StudyRuns>(files, all, MPI_COMM_WORLD);
  }



  RunKey
  EffectsStudy::key_of(const StudyRuns &runs, const int level) const
  {
    RunKey key = runs.scene_key();
    if (scene.error_control.has_tolerance())
      key.variant.strategy = MeshStrategy::tolerance;
    key.mesh_level = key.time_level = level;
    return key;
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



  std::optional<EffectsStudy::Computed>
  EffectsStudy::compute(const StudyRuns &runs,
                        const int        level,
                        std::string     &failure)
  {
    const RunKey key    = key_of(runs, level);
    auto         record = runs.find(key);
    if (!record)
      {
        StudyRuns::Outcome outcome = runs.make(key);
        interruption               = outcome.interruption;
        failure                    = outcome.failure;
        record                     = std::move(outcome.record);
      }
    if (!record)
      return {};
    return Computed{*record,
                    read_table(runs.directory + runs.name(key) +
                               "/statistics.csv")};
  }



  EffectResult
  EffectsStudy::compare(const EffectVariant &variant, const int level)
  {
    const Computed &with = of_scene.at(level);
    base->reference      = key_of(*base, level);
    EffectResult result;
    result.variant      = variant;
    result.level        = level;
    result.cells        = with.record.number("cells");
    result.seconds_with = with.record.number("seconds_total");
    result.memory_with  = with.record.number("peak_memory_MB");
    std::optional<Computed> without;
    try
      {
        const auto runs = runs_of(variant);
        without         = compute(*runs, level, result.failure);
      }
    catch (const std::exception &exception)
      {
        result.failure = reason(exception);
      }
    if (!without)
      return result;
    result.seconds_without = without->record.number("seconds_total");
    result.memory_without  = without->record.number("peak_memory_MB");
    result.energy_distance = without->record.number("error_energy");
    result.changes         = changes_between(with.table, without->table);

    // What halving mesh and steps has changed, or the bar in energy.
    const auto coarser = of_scene.find(level - 1);
    if (coarser != of_scene.end())
      {
        const auto errors = changes_between(with.table, coarser->second.table);
        for (std::size_t q = 0; q < errors.size(); ++q)
          result.changes[q].error = errors[q].change;
      }
    else
      for (QuantityChange &quantity : result.changes)
        quantity.error = with.record.number("estimate_total");
    const double smallest =
      10. * error_of_iterations(with.table, without->table);
    result.verdict = judge(result.changes, smallest);
    result.decisive =
      *std::max_element(result.changes.begin(),
                        result.changes.end(),
                        [smallest](const QuantityChange &a,
                                   const QuantityChange &b) {
                          return a.change / (a.error + smallest) <
                                 b.change / (b.error + smallest);
                        });
    return result;
  }



  void
  EffectsStudy::sort()
  {
    const auto size = [](const EffectResult &result) {
      return result.failure.empty() ? result.decisive.change : 1e300;
    };
    std::stable_sort(results.begin(),
                     results.end(),
                     [&](const EffectResult &a, const EffectResult &b) {
                       if (a.variant.is_physical != b.variant.is_physical)
                         return a.variant.is_physical;
                       return size(a) > size(b);
                     });
  }



  std::string
  EffectsStudy::run()
  {
    base->lock_directory();
    const std::vector<int> all_levels = levels();
    std::string            failure;
    const auto             interrupted = [this] {
      return interruption.substr(0, interruption.find(" has ended")) +
             " has ended the study of effects; the same command goes on.";
    };

    const auto make_scene = [&](const int level) {
      base->reference = key_of(*base, level);
      auto found      = compute(*base, level, failure);
      if (found)
        of_scene.emplace(level, std::move(*found));
      return interruption.empty();
    };
    if (!make_scene(all_levels.front()))
      return interrupted();
    AssertThrow(!of_scene.empty(),
                ExcMessage("The scene itself could not be computed: " +
                           failure));

    double typical_stress = 0.;
    for (const double stress :
         of_scene.begin()->second.table.columns.at("mean_von_mises"))
      typical_stress = std::max(typical_stress, stress);
    std::vector<EffectVariant> open = effect_variants(scene, typical_stress);
    out << "Effects of " << scene.file << ": " << open.size()
        << " simplifications" << std::endl;

    double last_seconds = 0.;
    for (const int level : all_levels)
      {
        if (all_levels.size() > 1 && level == all_levels.front())
          continue; // what the next one is compared with
        // Twice the resolution in space and time.
        const double begin = timer.wall_time();
        const double expected =
          last_seconds * std::pow(2., scene.dimension + 1);
        if (Utilities::MPI::broadcast(MPI_COMM_WORLD, begin + expected) >
            scene.study.budget)
          {
            left_out =
              std::to_string(open.size()) +
              " simplifications would separate from the error, if at all, on "
              "meshes that 'Study/Budget' leaves no time for.";
            break;
          }
        if (of_scene.count(level) == 0 && !make_scene(level))
          return interrupted();
        if (of_scene.count(level) == 0)
          {
            left_out = "The scene could not be computed there: " + failure;
            break;
          }
        std::vector<EffectVariant> undecided;
        for (const EffectVariant &variant : open)
          {
            console.show_status(variant.effect + ": " + variant.instead);
            EffectResult result = compare(variant, level);
            if (!interruption.empty())
              return interrupted();
            if (result.verdict == EffectVerdict::below_the_error ||
                result.verdict == EffectVerdict::as_large_as_the_error)
              undecided.push_back(variant);
            results.erase(std::remove_if(results.begin(),
                                         results.end(),
                                         [&](const EffectResult &earlier) {
                                           return earlier.variant.name ==
                                                  variant.name;
                                         }),
                          results.end());
            results.push_back(std::move(result));
          }
        open = std::move(undecided);
        last_seconds =
          Utilities::MPI::broadcast(MPI_COMM_WORLD, timer.wall_time() - begin);
        sort();
        write(false);
        if (open.empty())
          break;
      }

    // The two largest at once.
    const EffectResult *first = nullptr, *second = nullptr;
    for (const EffectResult &result : results)
      if (result.variant.is_physical &&
          result.verdict == EffectVerdict::called_for)
        {
          if (first == nullptr)
            first = &result;
          else if (second == nullptr &&
                   !overlap(first->variant, result.variant))
            second = &result;
        }
    if (second != nullptr)
      {
        together = compare(both(first->variant, second->variant),
                           std::max(first->level, second->level));
        if (!interruption.empty())
          return interrupted();
      }
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
