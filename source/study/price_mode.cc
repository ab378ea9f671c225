// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/conditional_ostream.h>

#include <viscoplastic_contact/results/output.h>
#include <viscoplastic_contact/study/price_mode.h>
#include <viscoplastic_contact/study/study_analysis.h>

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



    /// The pilot runs of a scene, finished.
    struct Pilots
    {
      std::vector<RunRecord> records;
      std::string            interruption;

      Records
      all() const
      {
        Records result;
        for (const RunRecord &record : records)
          result.push_back(&record);
        return result;
      }
    };



    /**
     * Four runs around the levels below @p mesh_level and @p time_level.
     * Coarse steps may be unstable or fail otherwise: then finer ones follow.
     */
    Pilots
    make_pilots(const StudyRuns &runs,
                const int        mesh_level,
                const int        finest_time_level,
                Console         &console)
    {
      std::string failure;
      for (int time_level = finest_time_level; time_level <= 1; ++time_level)
        {
          Pilots pilots;
          failure.clear();
          for (const auto &[m, t] : {std::make_pair(-1, -1),
                                     std::make_pair(-1, 0),
                                     std::make_pair(0, -1),
                                     std::make_pair(0, 0)})
            {
              RunKey key     = runs.scene_key();
              key.mesh_level = mesh_level + m;
              key.time_level = time_level + t;
              auto record    = runs.find(key);
              if (!record)
                {
                  console.show_status("Pilot run " + runs.name(key));
                  StudyRuns::Outcome outcome = runs.make(key);
                  if (!outcome.interruption.empty())
                    {
                      pilots.interruption = outcome.interruption;
                      return pilots;
                    }
                  if (!outcome.record)
                    {
                      failure = outcome.failure;
                      break;
                    }
                  record = std::move(outcome.record);
                }
              pilots.records.push_back(*record);
            }
          if (failure.empty())
            return pilots;
        }
      AssertThrow(false,
                  ExcMessage("The pilot runs for --price fail: " + failure));
      return Pilots();
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
    AssertThrow(has_exact || scene.error_control.error_bar,
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
    // Where the finer pilots are.
    const int          mesh_level = is_small ? 1 : n_coarser >= 2 ? -1 : 0;
    const unsigned int n          = n_steps(runs.phases);
    const int          time_level = n >= 8 * runs.phases.size() ? -1 :
                                    n >= 4 * runs.phases.size() ? 0 :
                                                                  1;

    runs.lock_directory();
    const Pilots pilots = make_pilots(runs, mesh_level, time_level, console);
    if (!pilots.interruption.empty())
      return pilots.interruption;
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

    const WorkPrecisionModel model =
      fit_work_precision(runs, pilots.all(), measure, nullptr);
    const double eps    = command_line.price;
    const double budget = scene.study.budget;
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
      run_scene(parameters, console, command_line.restart, &measurements);
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
