// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/conditional_ostream.h>

#include <viscoplastic_contact/results/run_record.h>
#include <viscoplastic_contact/study/price_mode.h>
#include <viscoplastic_contact/study/tolerance_price.h>
#include <viscoplastic_contact/study/uniform_price.h>

#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
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



    /// What the finished run has given; without numbers on ranks but the
    /// first, which speaks.
    RunRecord
    result_of(const RunKey          &key,
              const Parameters      &parameters,
              const RunMeasurements &measurements)
    {
      if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
        return {};
      return make_record(key,
                         read_table(results_directory(parameters) +
                                    "statistics.csv"),
                         measurements,
                         false,
                         parameters.error_control.quantity);
    }



    /// The run that has been chosen, and what it is expected to give.
    struct ChosenRun
    {
      RunKey key;
      /// What is set for it.
      std::vector<std::string> assignments;
      std::string              measure;
      double                   error = 0., seconds = 0., memory = 0.;
      /// Of runs that choose them.
      double cells = 0., steps = 0.;
      /// The sentence of a signal that has come before.
      std::string interruption;
    };



    ChosenRun
    choose_mesh_and_steps(StudyRuns &runs, const double eps, Console &console)
    {
      ConditionalOStream out(console.stream(),
                             Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) ==
                               0);
      const double       budget = runs.scene.study.budget;
      const UniformPrice found =
        price_with_given_meshes(runs, eps, budget, console);
      ChosenRun result;
      result.interruption = found.interruption;
      AssertThrow(found.failure.empty(), ExcMessage(found.failure));
      if (!result.interruption.empty())
        return result;
      out << next_refinement(found.model) << std::endl;
      AssertThrow(found.price.is_in_budget,
                  ExcMessage(in_words(found.model, found.price, budget) +
                             " Raise 'Study/Budget' or take a larger error."));
      const PredictedRun &run = *found.price.run;
      result.key              = runs.scene_key();
      result.key.mesh_level   = run.mesh_level;
      result.assignments = runs.discretization(result.key, run.phases, run.k);
      result.measure     = found.measure;
      result.error       = run.error;
      result.seconds     = run.seconds;
      result.memory      = run.memory;
      result.steps       = run.steps;
      return result;
    }



    /// Beside its price, that of runs with given meshes and steps is said.
    ChosenRun
    choose_tolerance(StudyRuns &runs, const double eps, Console &console)
    {
      ConditionalOStream   out(console.stream(),
                             Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) ==
                               0);
      const ToleranceQuote quote = price_to_tolerance(runs, eps, console);
      ChosenRun            result;
      result.interruption = quote.interruption;
      if (!result.interruption.empty())
        return result;
      const PredictedToleranceRun &run = quote.price.run;
      result.key                       = runs.scene_key();
      result.key.variant.strategy      = MeshStrategy::tolerance;
      result.assignments               = {"Error control/Tolerance=" +
                                          digits(run.tolerance, 4)};
      result.measure                   = quote.measure;
      result.error                     = run.error;
      result.seconds                   = run.seconds;
      result.memory                    = run.memory;
      result.cells                     = run.cells;
      result.steps                     = run.steps;

      out << "\nFor comparison, runs with one uniform mesh and equal steps.\n";
      const UniformPrice other =
        price_with_given_meshes(runs, eps, run.seconds, console);
      result.interruption = other.interruption;
      if (!other.failure.empty())
        out << "Not priced: " << other.failure << '\n';
      else if (result.interruption.empty())
        {
          out << "With one uniform mesh and equal steps, the error "
              << digits(eps);
          if (other.price.run)
            out << " would take about "
                << seconds_in_words(other.price.run->seconds) << ", "
                << digits(other.price.run->seconds / run.seconds, 2)
                << " times as long";
          else
            out << " is out of reach";
          out << ".\n";
        }
      out << std::endl;
      return result;
    }
  } // namespace



  std::string
  run_at_price(const CommandLine &command_line, Console &console)
  {
    StudyRuns runs(command_line.files, command_line.overrides, MPI_COMM_WORLD);
    ConditionalOStream out(console.stream(),
                           Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) ==
                             0);
    const Parameters  &scene = runs.scene;
    AssertThrow(!scene.exact_solution.displacement.empty() ||
                  scene.error_control.error_estimator,
                ExcMessage("--price needs an error to go by: set 'Error "
                           "control/Error bar = true', or give an 'Exact "
                           "solution'."));
    const bool      has_tolerance = scene.error_control.has_tolerance();
    const ChosenRun chosen =
      has_tolerance ? choose_tolerance(runs, command_line.price, console) :
                      choose_mesh_and_steps(runs, command_line.price, console);
    if (!chosen.interruption.empty() ||
        command_line.task == CommandLine::Task::check)
      return chosen.interruption;

    // The run that was chosen, with all output of the scene.
    std::vector<std::string> overrides = command_line.overrides;
    out << "Now the run with\n";
    for (const std::string &assignment : chosen.assignments)
      {
        overrides.push_back(assignment);
        out << "  --set '" << assignment << "'\n";
      }
    out << std::endl;
    const Parameters  parameters(command_line.files, overrides);
    RunMeasurements   measurements;
    const std::string interruption =
      run_scene(parameters, console, command_line.restart, measurements);
    if (!interruption.empty())
      return interruption;

    const RunRecord result = result_of(chosen.key, parameters, measurements);
    out << "\nThe prediction:\n  error    "
        << compare(chosen.error, error_of(result, chosen.measure, nullptr))
        << "\n  seconds  "
        << compare(chosen.seconds, result.number("seconds_total"))
        << ", without field output\n  memory   "
        << compare(chosen.memory, result.number("peak_memory_MB")) << " MB";
    if (has_tolerance)
      out << "\n  cells    " << compare(chosen.cells, result.number("cells"));
    if (has_tolerance || scene.step_control.is_on())
      out << "\n  steps    " << compare(chosen.steps, result.number("steps"));
    out << std::endl;
    return "";
  }
} // namespace Viscoplastic
