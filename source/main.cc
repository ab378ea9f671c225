// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/mpi_singleton.h>
#include <viscoplastic_contact/base/signals.h>
#include <viscoplastic_contact/parameters/parameter_description.h>
#include <viscoplastic_contact/run/command_line.h>
#include <viscoplastic_contact/run/passes.h>
#include <viscoplastic_contact/run/scene_as_json.h>
#include <viscoplastic_contact/run/scene_check.h>

#include <malloc.h>

#include <cctype>
#include <chrono>
#include <iostream>
#include <optional>
#include <set>
#include <thread>

namespace
{
  using namespace Viscoplastic;

  /// Return what @p work returns. In errors, quote entries as the files have
  /// them; for expressions that cannot be parsed, add their place in the file.
  template <typename Work>
  std::string
  with_places(const Parameters &parameters, const Work &work)
  {
    try
      {
        return work();
      }
    catch (const ExpressionError &error)
      {
        const std::string origin = parameters.origin_of(error.entry);
        if (origin.empty())
          throw;
        std::string sentence = parameters.quote_as_written(reason(error));
        sentence[0]          = static_cast<char>(std::tolower(sentence[0]));
        refuse(origin + ": " + sentence);
        return "";
      }
    catch (const dealii::StandardExceptions::ExcMessage &error)
      {
        const std::string sentence = reason(error);
        const std::string quoted   = parameters.quote_as_written(sentence);
        if (quoted == sentence)
          throw;
        refuse(quoted);
        return "";
      }
  }

  /// Print the scene as JSON. Returns nothing, as runs do.
  std::string
  print_scene(const Parameters &parameters, const bool with_means)
  {
    const std::string text =
      scene_as_json(parameters, with_means, MPI_COMM_WORLD);
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      if (!(std::cout << text << std::flush))
        refuse("Writing to the standard output failed; is the disk full?");
    return "";
  }

  /// Return the sentence of a run ended by a signal; empty for others.
  template <int dim>
  std::string
  run(const Parameters  &parameters,
      const CommandLine &command_line,
      Console           &console)
  {
    if (command_line.task != CommandLine::Task::check)
      return run_in_passes<dim>(parameters, console, command_line.restart);
    check_scene<dim>(parameters, console);
    return "";
  }

  std::string
  run(const CommandLine &command_line, Console &console)
  {
    const Parameters parameters(command_line.files, command_line.overrides);
    return with_places(parameters, [&] {
      if (command_line.task == CommandLine::Task::print_scene)
        return print_scene(parameters, command_line.with_means);
      return parameters.dimension == 2 ?
               run<2>(parameters, command_line, console) :
               run<3>(parameters, command_line, console);
    });
  }

  std::string
  run(const CommandLine &command_line)
  {
    Console console(MPI_COMM_WORLD,
                    command_line.quiet,
                    command_line.log,
                    command_line.verbose);
    try
      {
        const std::string interruption = run(command_line, console);
        // Results are complete, so that a failing log does not end a run.
        if (interruption.empty())
          console.check();
        return interruption;
      }
    catch (...)
      {
        console.log() << reason_of_current_exception() << std::endl;
        throw;
      }
  }

  void
  complain(const std::string &sentence)
  {
    // Use one write, since ranks that fail apart may write at the same time.
    std::cerr << "viscoplastic_contact: " + sentence + "\n";
  }

  /// Whether all ranks get here within 3 seconds: they have failed together,
  /// and none waits for another one in a collective call. @p communicator must
  /// not be used for anything else.
  bool
  all_have_failed(const MPI_Comm communicator)
  {
    using Clock       = std::chrono::steady_clock;
    const auto  until = Clock::now() + std::chrono::seconds(3);
    MPI_Request barrier;
    MPI_Ibarrier(communicator, &barrier);
    int are_here = 0;
    while (true)
      {
        MPI_Test(&barrier, &are_here, MPI_STATUS_IGNORE);
        if (are_here != 0 || Clock::now() > until)
          return are_here != 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
  }

  /// Print the failure of this rank in a parallel run. Does not return if other
  /// ranks go on.
  void
  complain_in_parallel(const std::string &sentence, const MPI_Comm communicator)
  {
    if (!all_have_failed(communicator))
      {
        // Others may wait in a collective call that this rank has left.
        complain(sentence);
        MPI_Abort(MPI_COMM_WORLD, 1);
      }
    const std::vector<std::string> sentences =
      dealii::Utilities::MPI::gather(communicator, sentence);
    for (const std::string &each :
         std::set<std::string>(sentences.begin(), sentences.end()))
      complain(each);
  }

  /// Return what a task prints that computes nothing; empty for others.
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
        case CommandLine::Task::describe_as_json:
          return describe_parameters_as_json(command_line.files,
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
  const bool                     is_single = run_without_mpi_job();
#ifdef M_ARENA_MAX
  // With one arena, time steps reuse the memory of the output thread.
  mallopt(M_ARENA_MAX, 1);
#endif

  CommandLine command_line;
  std::string text, complaint;
  try
    {
      const UnexpectedEnd unexpected_end("reading the parameters");
      command_line = read_command_line(arguments);
      text         = text_of(command_line);
    }
  catch (...)
    {
      complaint = reason_of_current_exception();
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
  // Used in complain_in_parallel() only.
  MPI_Comm of_failures = MPI_COMM_NULL;
  if (mpi)
    {
      rank        = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      is_parallel = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;
      if (is_parallel)
        MPI_Comm_dup(MPI_COMM_WORLD, &of_failures);
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
          const UnexpectedEnd unexpected_end("running the scene");
          const std::string   interruption = run(command_line);
          if (interruption.empty())
            return 0;
          if (rank == 0)
            complain(interruption);
          return 3;
        }
      // A batch script without a scene must fail.
      const bool is_guide = command_line.task == CommandLine::Task::guide;
      if (rank == 0)
        if (!((is_guide ? std::cerr : std::cout) << text << std::flush))
          refuse("Writing to the standard output failed; is the disk full?");
      return is_guide ? 2 : 0;
    }
  catch (...)
    {
      if (is_parallel)
        complain_in_parallel(reason_of_current_exception(), of_failures);
      else
        complain(reason_of_current_exception());
      return 1;
    }
}
