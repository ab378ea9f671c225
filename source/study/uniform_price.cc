// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/conditional_ostream.h>

#include <viscoplastic_contact/study/pilot_runs.h>
#include <viscoplastic_contact/study/timing_runs.h>
#include <viscoplastic_contact/study/uniform_price.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// Meshes with this many cells are small enough to be pilots themselves.
    constexpr double small_mesh = 1500.;



    /// The time level of the finest pilots: coarser than the scene where it has
    /// so many steps, or so small a tolerance of them, that pilots twice as
    /// coarse still tell something. Where each is as fine as the scene in
    /// space, @p must_save steps.
    int
    finest_time_level(const StudyRuns &runs, const bool must_save)
    {
      const double n_phases = static_cast<double>(runs.phases.size());
      const auto   may_be   = [&](const int level) {
        RunKey coarsest     = runs.scene_key();
        coarsest.time_level = level - 1;
        return runs.scene.step_control.is_on() ?
                     runs.step_tolerance(coarsest) <= StudyRuns::largest_tolerance :
                     n_steps(runs.phases) >=
                   std::pow(2., 1 - coarsest.time_level) * n_phases;
      };
      for (int level = must_save ? -2 : -1; level < 1; ++level)
        if (may_be(level))
          return level;
      return 1;
    }



    /// Pilots on two mesh levels, the finer one of which is that of @p finest,
    /// or on that alone; with steps as long as there, and twice as long.
    PilotRuns
    make_pilots(const StudyRuns &runs,
                const RunKey    &finest,
                const bool       has_coarser,
                Console         &console)
    {
      PilotRuns pilots;
      for (int m = has_coarser ? -1 : 0; m <= 0; ++m)
        for (int t = -1; t <= 0; ++t)
          if (!add_pilot_run(
                runs,
                {finest.variant, finest.mesh_level + m, finest.time_level + t},
                console,
                pilots))
            return pilots;
      return pilots;
    }



    /// Pilots on one mesh do not tell what the mesh does to the error: one more
    /// on a finer mesh, with the longest steps of these, if it takes no more
    /// than @p seconds. Without it, or where it fails, the law is a
    /// theoretical one.
    void
    add_finer_pilot(const StudyRuns &runs,
                    const double     seconds,
                    Console         &console,
                    PilotRuns       &pilots)
    {
      const Records   known = pilots.all();
      const CostModel cost  = cost_of(known);
      RunKey          key   = known.front()->key;
      ++key.mesh_level;
      const double steps     = expected_steps(runs, known, key),
                   n_set_ups = runs.n_set_ups(key.variant.strategy,
                                              steps,
                                              n_steps(runs.phases_of(key))),
                   dofs      = std::pow(2., runs.scene.dimension) *
                          known.front()->number("dofs");
      if (!runs.find(key) &&
          (cost.seconds(dofs, steps, n_set_ups) > seconds ||
           cost.memory(dofs, steps, n_set_ups) > affordable_memory()))
        return;
      add_pilot_run(runs, key, console, pilots);
      pilots.failure.clear();
    }
  } // namespace



  UniformPrice
  price_with_given_meshes(StudyRuns   &runs,
                          const double eps,
                          const double seconds,
                          Console     &console)
  {
    ConditionalOStream out(console.stream(),
                           Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) ==
                             0);
    UniformPrice       result;
    const bool         is_small  = runs.n_cells <= small_mesh;
    const int          n_coarser = runs.n_coarser_meshes();
    // The mesh of a file that is not refined has nothing coarser.
    const bool has_two_meshes = is_small || n_coarser >= 1;
    RunKey     finest         = runs.scene_key();
    finest.mesh_level         = is_small ? 1 : n_coarser >= 2 ? -1 : 0;
    finest.time_level         = finest_time_level(runs, !has_two_meshes);

    runs.lock_directory();
    PilotRuns pilots = make_pilots(runs, finest, has_two_meshes, console);
    // Long steps may be unstable or fail otherwise: then shorter ones follow.
    while (!pilots.failure.empty() && ++finest.time_level <= 1)
      pilots = make_pilots(runs, finest, has_two_meshes, console);
    const auto has_failed = [&] {
      result.interruption = pilots.interruption;
      if (!pilots.failure.empty())
        result.failure = "The pilot runs for --price fail: " + pilots.failure;
      return !result.interruption.empty() || !result.failure.empty();
    };
    if (has_failed())
      return result;
    result.measure = best_measure(pilots.all(), nullptr, 2);
    if (result.measure.empty())
      {
        result.failure = no_error_to_go_by;
        return result;
      }
    const double budget = runs.scene.study.budget;
    const auto   fit    = [&](const Records &timed) {
      result.model =
        fit_work_precision(runs, pilots.all(), timed, result.measure, nullptr);
    };
    const auto seconds_left = [&](const double spent, const double price) {
      return seconds_for_timing(spent, std::min({price, budget, seconds}));
    };
    fit(pilots.all());
    if (!has_two_meshes)
      {
        if (const auto wanted = cheapest(result.model, eps))
          add_finer_pilot(runs,
                          seconds_left(pilots.seconds(), wanted->seconds),
                          console,
                          pilots);
        if (has_failed())
          return result;
        fit(pilots.all());
      }
    out << "Pilot runs:\n" << in_words(pilots.records, result.measure);
    if (!has_two_meshes && pilots.records.size() == 2)
      out << "A finer mesh would take too long for a pilot, and there is none "
             "coarser: the error of the mesh is taken to be of first order in "
             "h.\n";
    double  pilot_seconds = pilots.seconds();
    Records timed         = pilots.all();
    // A run on a mesh that is much finer than those of the pilots may have
    // another solver.
    TimingRuns timings;
    if (const auto wanted = cheapest(result.model, eps))
      timings = make_timing_runs(runs,
                                 pilots.all(),
                                 wanted->mesh_level,
                                 seconds_left(pilot_seconds, wanted->seconds),
                                 console);
    result.interruption = timings.interruption;
    if (!result.interruption.empty())
      return result;
    out << in_words(timings.records, "");
    for (const RunRecord &record : timings.records)
      {
        pilot_seconds += record.number("seconds_total");
        timed.push_back(&record);
      }
    fit(timed);
    out << "Prices by the " << measure_in_words(result.measure)
        << ", from pilots of " << seconds_in_words(pilot_seconds) << ":\n";
    const auto prices =
      list_prices(result.model, {2. * eps, eps, 0.5 * eps}, budget);
    for (const Price &line : prices)
      out << "  " << in_words(result.model, line, budget) << '\n';
    result.price = prices[1];
    return result;
  }
} // namespace Viscoplastic
