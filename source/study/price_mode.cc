// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/conditional_ostream.h>

#include <viscoplastic_contact/results/output.h>
#include <viscoplastic_contact/study/price_mode.h>
#include <viscoplastic_contact/study/timing_runs.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// Meshes with this many cells are small enough to be pilots themselves.
    constexpr double small_mesh = 1500.;

    std::string
    number(const double value)
    {
      return std::isfinite(value) ? digits(value) : "unknown";
    }



    /// "predicted / actual", and the factor between.
    std::string
    compare(const double predicted, const double actual)
    {
      std::ostringstream text;
      text << number(predicted) << " predicted, " << number(actual) << " found";
      if (actual > 0. && std::isfinite(actual))
        text << " (factor " << digits(predicted / actual, 2) << ")";
      return text.str();
    }



    /// The pilot runs of a scene, or why there are not all of them.
    struct Pilots
    {
      std::vector<RunRecord> records;
      std::string            failure, interruption;

      Records
      all() const
      {
        Records result;
        for (const RunRecord &record : records)
          result.push_back(&record);
        return result;
      }
    };



    /// Four runs: @p finest, and with h and k each doubled alone and both.
    Pilots
    make_pilots(const StudyRuns &runs, const RunKey &finest, Console &console)
    {
      Pilots pilots;
      for (const auto &[m, t] : {std::make_pair(-1, -1),
                                 std::make_pair(-1, 0),
                                 std::make_pair(0, -1),
                                 std::make_pair(0, 0)})
        {
          const RunKey       key{finest.variant,
                           finest.mesh_level + m,
                           finest.time_level + t};
          StudyRuns::Outcome outcome;
          outcome.record = runs.find(key);
          if (!outcome.record)
            {
              console.show_status("Pilot run " + runs.name(key));
              outcome = runs.make(key);
            }
          if (!outcome.record)
            return {{}, outcome.failure, outcome.interruption};
          pilots.records.push_back(*outcome.record);
        }
      return pilots;
    }



    /// What the finished run has given; without numbers on ranks but the
    /// first, which speaks.
    RunRecord
    result_of(const RunKey          &key,
              const std::string     &directory,
              const RunMeasurements &measurements)
    {
      if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
        return {};
      return make_record(key,
                         read_table(directory + "statistics.csv"),
                         measurements);
    }
  } // namespace



  std::string
  run_at_price(const CommandLine &command_line, Console &console)
  {
    StudyRuns runs(command_line.files, command_line.overrides, MPI_COMM_WORLD);
    ConditionalOStream out(console.stream(),
                           Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) ==
                             0);

    const Parameters &scene     = runs.scene;
    const bool        has_exact = !scene.exact_solution.displacement.empty();
    AssertThrow(has_exact || scene.error_control.error_estimator,
                ExcMessage("--price needs an error to go by: set 'Error "
                           "control/Error bar = true', or give an 'Exact "
                           "solution'."));
    const bool is_small  = runs.n_cells <= small_mesh;
    const int  n_coarser = runs.n_coarser_meshes();
    AssertThrow(is_small || n_coarser >= 1,
                ExcMessage(
                  "--price needs pilot runs on coarser meshes, but the mesh "
                  "of " +
                  digits(runs.n_cells) +
                  " cells cannot be halved: 'Geometry/Global refinements' = " +
                  std::to_string(scene.geometry.global_refinements) +
                  "; give a mesh twice or four times as coarse and refine it "
                  "once or twice globally."));
    RunKey             finest   = runs.scene_key();
    const unsigned int n        = n_steps(runs.phases);
    const std::size_t  n_phases = runs.phases.size();
    finest.mesh_level           = is_small ? 1 : n_coarser >= 2 ? -1 : 0;
    finest.time_level = n >= 8 * n_phases ? -1 : n >= 4 * n_phases ? 0 : 1;

    runs.lock_directory();
    Pilots pilots = make_pilots(runs, finest, console);
    // Long steps may be unstable or fail otherwise: then shorter ones follow.
    while (!pilots.failure.empty() && ++finest.time_level <= 1)
      pilots = make_pilots(runs, finest, console);
    if (!pilots.interruption.empty())
      return pilots.interruption;
    AssertThrow(pilots.failure.empty(),
                ExcMessage("The pilot runs for --price fail: " +
                           pilots.failure));
    double pilot_seconds = 0.;
    out << "Pilot runs:\n";
    const std::string measure = best_measure(pilots.all(), nullptr);
    for (const RunRecord &record : pilots.records)
      {
        out << "  " << record.name << ": "
            << std::lround(record.number("cells")) << " cells, "
            << record.number("steps") << " steps, error "
            << number(measure.empty() ? 0. : error_of(record, measure, nullptr))
            << ", " << seconds_in_words(record.number("seconds_total")) << '\n';
        pilot_seconds += record.number("seconds_total");
      }
    AssertThrow(!measure.empty(),
                ExcMessage("--price needs an error to go by, but the pilot "
                           "runs know none: neither an error bar nor an exact "
                           "solution has given one."));

    const double eps    = command_line.price;
    const double budget = scene.study.budget;
    Records      timed  = pilots.all();
    const auto   fit    = [&] {
      return fit_work_precision(runs, pilots.all(), timed, measure, nullptr);
    };
    WorkPrecisionModel model = fit();
    // A run on a mesh that is much finer than those of the pilots may have
    // another solver.
    TimingRuns timings;
    if (const auto wanted = cheapest(model, eps))
      timings =
        make_timing_runs(runs,
                         pilots.all(),
                         wanted->mesh_level,
                         seconds_for_timing(pilot_seconds,
                                            std::min(wanted->seconds, budget)),
                         console);
    if (!timings.interruption.empty())
      return timings.interruption;
    for (const RunRecord &record : timings.records)
      {
        out << "  " << record.name << ": "
            << std::lround(record.number("cells")) << " cells, "
            << record.number("steps") << " steps, "
            << seconds_in_words(record.number("seconds_total"))
            << ", for its cost alone\n";
        pilot_seconds += record.number("seconds_total");
        timed.push_back(&record);
      }
    model = fit();
    out << "Prices by the " << measure_in_words(measure) << ", from pilots of "
        << seconds_in_words(pilot_seconds) << ":\n";
    const auto prices = list_prices(model, {2. * eps, eps, 0.5 * eps}, budget);
    for (const Price &line : prices)
      out << "  " << in_words(model, line, budget) << '\n';
    const Price &price = prices[1];
    out << next_refinement(model) << std::endl;
    AssertThrow(price.is_in_budget,
                ExcMessage(in_words(model, price, budget) +
                           " Raise 'Study/Budget' or take a larger error."));
    if (command_line.task == CommandLine::Task::check)
      return "";

    // The run that was chosen, with all output of the scene.
    RunKey key                         = runs.scene_key();
    key.mesh_level                     = price.run->mesh_level;
    std::vector<std::string> overrides = command_line.overrides;
    for (const std::string &text : runs.discretization(key, price.run->phases))
      overrides.push_back(text);
    out << "Now the run with\n";
    for (std::size_t i = command_line.overrides.size(); i < overrides.size();
         ++i)
      out << "  --set '" << overrides[i] << "'\n";
    out << std::endl;
    const Parameters  parameters(command_line.files, overrides);
    RunMeasurements   measurements;
    const std::string interruption =
      run_scene(parameters, console, command_line.restart, measurements);
    if (!interruption.empty())
      return interruption;

    const RunRecord result =
      result_of(key, results_directory(parameters), measurements);
    out << "\nThe prediction:\n  error    "
        << compare(price.run->error, error_of(result, measure, nullptr))
        << "\n  seconds  "
        << compare(price.run->seconds, result.number("seconds_total"))
        << ", without field output\n  memory   "
        << compare(price.run->memory, result.number("peak_memory_MB")) << " MB"
        << std::endl;
    return "";
  }
} // namespace Viscoplastic
