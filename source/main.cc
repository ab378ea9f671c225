// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/mpi_singleton.h>
#include <viscoplastic_contact/base/signals.h>
#include <viscoplastic_contact/parameters/parameter_description.h>
#include <viscoplastic_contact/run/command_line.h>
#include <viscoplastic_contact/run/two_level.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>
#include <viscoplastic_contact/study/effects.h>
#include <viscoplastic_contact/study/price_mode.h>
#include <viscoplastic_contact/study/study.h>

#include <chrono>
#include <iostream>
#include <optional>
#include <thread>

namespace
{
  using namespace Viscoplastic;

  /// The sentence of a run that a signal has ended; empty for others.
  template <int dim>
  std::string
  run(const Parameters  &parameters,
      const CommandLine &command_line,
      Console           &console)
  {
    ViscoplasticContact<dim> problem(parameters, console);
    const bool compares = parameters.error_control.two_level_comparison;
    if (compares)
      coarser_scene(parameters); // throws
    if (command_line.task == CommandLine::Task::check)
      {
        problem.check();
        return "";
      }
    if (!compares)
      return problem.run(command_line.restart);
    console.stream() << "First with twice the mesh width and twice the time "
                        "steps, to compare."
                     << std::endl;
    const RunSummary<dim> coarser =
      run_coarser_scene<dim>(parameters, command_line);
    return problem.run(command_line.restart, &coarser);
  }



  std::string
  run(const CommandLine &command_line, Console &console)
  {
    if (command_line.task == CommandLine::Task::study)
      return Study(command_line.files, command_line.overrides, console).run();
    if (command_line.task == CommandLine::Task::effects)
      return EffectsStudy(command_line.files, command_line.overrides, console)
        .run();
    if (command_line.price > 0.)
      return run_at_price(command_line, console);
    const Parameters parameters(command_line.files, command_line.overrides);
    return parameters.dimension == 2 ?
             run<2>(parameters, command_line, console) :
             run<3>(parameters, command_line, console);
  }



  std::string
  run(const CommandLine &command_line, const bool has_terminal)
  {
    Console console(MPI_COMM_WORLD,
                    command_line.quiet,
                    command_line.log,
                    has_terminal);
    try
      {
        const std::string interruption = run(command_line, console);
        // Results come first: a log that fails does not end a run.
        if (interruption.empty())
          console.check();
        return interruption;
      }
    catch (const std::exception &exception)
      {
        console.log() << reason(exception) << std::endl;
        throw;
      }
  }



  void
  complain(const std::string &sentence)
  {
    std::cerr << "viscoplastic_contact: " << sentence << std::endl;
  }



  /// What a task prints that computes nothing.
  std::string
  text_of(const CommandLine &command_line)
  {
    switch (command_line.task)
      {
        case CommandLine::Task::guide:
          return guide_text();
        case CommandLine::Task::help:
          return help_text();
        case CommandLine::Task::version:
          return version_text();
        case CommandLine::Task::describe:
          return describe_parameters(command_line.files,
                                     command_line.overrides);
        case CommandLine::Task::describe_as_markdown:
          return describe_parameters_as_markdown(command_line.files,
                                                 command_line.overrides);
        default:
          return "";
      }
  }
} // namespace



int
main(int argc, char *argv[])
{
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool                     has_terminal = stdout_is_terminal();
  const bool                     is_single    = run_without_mpi_job();

  CommandLine command_line;
  std::string text, complaint;
  try
    {
      command_line = read_command_line(arguments);
      text         = text_of(command_line);
    }
  catch (const std::exception &exception)
    {
      complaint = reason(exception);
    }

  // A text needs no MPI, whose start takes longer, unless one of several
  // processes is to print it. The libraries that MPI_InitFinalize starts must
  // not see our arguments: PETSc has a --help of its own.
  int n_hidden_arguments = 1;
  std::optional<dealii::Utilities::MPI::MPI_InitFinalize> mpi;
  if (!is_single || (text.empty() && complaint.empty()))
    mpi.emplace(n_hidden_arguments, argv, 1);
  unsigned int rank        = 0;
  bool         is_parallel = false;
  if (mpi)
    {
      rank        = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      is_parallel = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;
    }

  ignore_file_size_signal();

  if (!complaint.empty())
    {
      if (rank == 0)
        complain(complaint);
      return 2;
    }

  try
    {
      if (text.empty())
        {
          const std::string interruption = run(command_line, has_terminal);
          if (interruption.empty())
            return 0;
          if (rank == 0)
            complain(interruption);
          return 3;
        }
      // A batch script that forgets the scene must not go on.
      const bool is_guide = command_line.task == CommandLine::Task::guide;
      if (rank == 0)
        AssertThrow((is_guide ? std::cerr : std::cout) << text << std::flush,
                    dealii::ExcMessage("Writing to the standard output failed; "
                                       "is the disk full?"));
      return is_guide ? 2 : 0;
    }
  catch (const std::exception &exception)
    {
      // Most errors occur on all ranks; the first one speaks. A rank that fails
      // alone must speak, too, and end the others.
      if (rank > 0)
        std::this_thread::sleep_for(std::chrono::seconds(2));
      complain(reason(exception));
      if (is_parallel)
        MPI_Abort(MPI_COMM_WORLD, 1);
      return 1;
    }
}
