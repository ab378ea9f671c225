// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/study.h>

#include <algorithm>
#include <cmath>

// Which runs a study has.

namespace Viscoplastic
{
  namespace
  {
    std::vector<std::string>
    items(const std::string &text, const std::string &otherwise)
    {
      const auto found = Utilities::split_string_list(text, ',');
      return found.empty() ? std::vector<std::string>{otherwise} : found;
    }



    bool
    contains(const std::vector<std::string> &list, const std::string &item)
    {
      return std::find(list.begin(), list.end(), item) != list.end();
    }
  } // namespace



  std::string
  to_string(const Ladder ladder)
  {
    return ladder == Ladder::space ? "space" :
           ladder == Ladder::time  ? "time" :
                                     "both";
  }



  Study::Study(const std::vector<std::string> &files,
               const std::vector<std::string> &overrides,
               Console                        &console)
    : runs(files, overrides, MPI_COMM_WORLD)
    , parameters(runs.scene.study)
    , has_exact_solution(!runs.scene.exact_solution.displacement.empty() ||
                         !runs.scene.exact_solution.reference_directory.empty())
    , strategies(items(parameters.strategies,
                       runs.scene.error_control.has_tolerance() ? "tolerance" :
                                                                  "uniform"))
    , reference_strategy(runs.scene.error_control.has_tolerance() ?
                           MeshStrategy::tolerance :
                           MeshStrategy::uniform)
    , n_levels(parameters.levels)
    , console(console)
    , out(console.stream(),
          Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
  {
    AssertThrow(runs.scene.error_control.has_tolerance() ||
                  !contains(strategies, "tolerance"),
                ExcMessage(
                  "'Study/Strategies' has tolerance, but the scene has "
                  "none to begin with; set 'Error control/Tolerance', "
                  "or take uniform or adaptive."));
    AssertThrow(has_exact_solution ||
                  reference_strategy == MeshStrategy::tolerance ||
                  n_levels >= fewest_levels,
                ExcMessage(
                  "'Study/Levels' = " + std::to_string(n_levels) +
                  " is too few for a scene without an exact solution: whether "
                  "its finest run can serve as a reference shows only in three "
                  "levels; take at least 3, or give 'Exact solution' or "
                  "'Error control/Tolerance'."));
    make_plan();
  }



  std::vector<std::pair<int, int>>
  Study::levels_of(const MeshStrategy strategy, const Ladder ladder) const
  {
    const int                        finest = static_cast<int>(n_levels) - 1;
    std::vector<std::pair<int, int>> result;
    if (strategy == MeshStrategy::tolerance)
      {
        if (ladder == Ladder::both)
          for (int level = -finest; level <= 0; ++level)
            if (level == 0 || level >= runs.coarsest_tolerance_level())
              result.emplace_back(level, level);
      }
    else if (contains(items(parameters.ladders, "both"), to_string(ladder)))
      for (int level = 0; level <= finest; ++level)
        result.emplace_back(ladder == Ladder::time ? finest : level,
                            ladder == Ladder::space ? finest : level);
    return result;
  }



  void
  Study::make_plan()
  {
    plan.clear();
    const int  finest    = static_cast<int>(n_levels) - 1;
    const auto schemes   = items(parameters.time_schemes,
                               name_of(runs.scene.time.scheme)),
               histories = items(parameters.stress_histories,
                                 name_of(runs.scene.stress.stress_history));

    const auto add = [&](const MethodVariant &variant,
                         const int            mesh_level,
                         const int            time_level,
                         const Ladder         ladder) -> PlannedRun & {
      PlannedRun run;
      run.key = {variant, mesh_level, time_level};
      auto known =
        std::find_if(plan.begin(), plan.end(), [&](const auto &other) {
          return other.key == run.key;
        });
      if (known == plan.end())
        known = plan.insert(plan.end(), run);
      known->ladders.insert(ladder);
      return *known;
    };

    for (const std::string &strategy : strategies)
      for (const std::string &scheme : schemes)
        for (const std::string &history : histories)
          {
            const MethodVariant variant{to_mesh_strategy(strategy),
                                        scheme,
                                        history};
            // Names of schemes and histories are checked here, once.
            Parameters(runs.files, runs.overrides_of({variant}));
            for (const Ladder ladder : all_ladders)
              for (const auto &[mesh_level, time_level] :
                   levels_of(variant.strategy, ladder))
                add(variant, mesh_level, time_level, ladder);
          }
    if (!has_exact_solution)
      {
        // A scene with a tolerance has the scheme that is the best for it.
        const bool is_uniform   = reference_strategy == MeshStrategy::uniform;
        const std::string   own = name_of(runs.scene.time.scheme);
        const MethodVariant first{reference_strategy,
                                  is_uniform || !contains(schemes, own) ?
                                    schemes[0] :
                                    own,
                                  histories[0]};
        const int           last = is_uniform ? finest : 0;
        if (is_uniform)
          for (int level = last - 1; level <= last; ++level)
            add(first, level, level, Ladder::both);
        else if (!contains(strategies, "tolerance"))
          // Two that tell how long it will take.
          for (int level = last - 3; level <= last - 2; ++level)
            if (level >= runs.coarsest_tolerance_level())
              add(first, level, level, Ladder::both);
        add(first, last + 1, last + 1, Ladder::both).is_reference = true;
      }

    // The cheapest first: what is known early predicts the rest.
    // Levels of tolerances end where those of meshes begin.
    const auto work = [&](const PlannedRun &run) {
      const MeshStrategy strategy = run.key.variant.strategy;
      const int shift = strategy == MeshStrategy::tolerance ? finest : 0;
      return (strategy == MeshStrategy::uniform ? 1. : 1.5) *
             std::pow(2.,
                      static_cast<double>(runs.scene.dimension) *
                          (run.key.mesh_level + shift) +
                        run.key.time_level + shift);
    };
    std::stable_sort(plan.begin(),
                     plan.end(),
                     [&](const PlannedRun &a, const PlannedRun &b) {
                       return work(a) < work(b);
                     });
  }
} // namespace Viscoplastic
