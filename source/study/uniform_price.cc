// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/conditional_ostream.h>

#include <viscoplastic_contact/study/pilot_runs.h>
#include <viscoplastic_contact/study/timing_runs.h>
#include <viscoplastic_contact/study/uniform_price.h>

#include <algorithm>

namespace Viscoplastic
{
  namespace
  {
    /// Meshes with this many cells are small enough to be pilots themselves.
    constexpr double small_mesh = 1500.;



    /// Four runs: @p finest, and with h and k each doubled alone and both.
    PilotRuns
    make_pilots(const StudyRuns &runs, const RunKey &finest, Console &console)
    {
      PilotRuns pilots;
      for (const auto &[m, t] : {std::make_pair(-1, -1),
                                 std::make_pair(-1, 0),
                                 std::make_pair(0, -1),
                                 std::make_pair(0, 0)})
        if (!add_pilot_run(
              runs,
              {finest.variant, finest.mesh_level + m, finest.time_level + t},
              console,
              pilots))
          break;
      return pilots;
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
    if (!is_small && n_coarser < 1)
      {
        result.failure =
          "--price needs pilot runs on coarser meshes, but the mesh of " +
          digits(runs.n_cells) +
          " cells cannot be halved: 'Geometry/Global refinements' = " +
          std::to_string(runs.scene.geometry.global_refinements) +
          "; give a mesh twice or four times as coarse and refine it once or "
          "twice globally.";
        return result;
      }
    RunKey             finest   = runs.scene_key();
    const unsigned int n        = n_steps(runs.phases);
    const std::size_t  n_phases = runs.phases.size();
    finest.mesh_level           = is_small ? 1 : n_coarser >= 2 ? -1 : 0;
    finest.time_level = n >= 8 * n_phases ? -1 : n >= 4 * n_phases ? 0 : 1;

    runs.lock_directory();
    PilotRuns pilots = make_pilots(runs, finest, console);
    // Long steps may be unstable or fail otherwise: then shorter ones follow.
    while (!pilots.failure.empty() && ++finest.time_level <= 1)
      pilots = make_pilots(runs, finest, console);
    result.interruption = pilots.interruption;
    if (!pilots.failure.empty())
      result.failure = "The pilot runs for --price fail: " + pilots.failure;
    if (!result.interruption.empty() || !result.failure.empty())
      return result;
    result.measure = best_measure(pilots.all(), nullptr);
    if (result.measure.empty())
      {
        result.failure = no_error_to_go_by;
        return result;
      }
    out << "Pilot runs:\n" << in_words(pilots.records, result.measure);

    const double budget        = runs.scene.study.budget;
    double       pilot_seconds = pilots.seconds();
    Records      timed         = pilots.all();
    const auto   fit           = [&] {
      result.model =
        fit_work_precision(runs, pilots.all(), timed, result.measure, nullptr);
    };
    fit();
    // A run on a mesh that is much finer than those of the pilots may have
    // another solver.
    TimingRuns timings;
    if (const auto wanted = cheapest(result.model, eps))
      timings = make_timing_runs(
        runs,
        pilots.all(),
        wanted->mesh_level,
        seconds_for_timing(pilot_seconds,
                           std::min({wanted->seconds, budget, seconds})),
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
    fit();
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
