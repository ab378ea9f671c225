// SPDX-License-Identifier: LGPL-2.1-or-later

// The program for tests with many runs: started once. A line `directory
// argument ...' on standard input asks for a run there, with its output in the
// files stdout and stderr. The answer is a line with its exit code, or minus
// the number of the signal that ended it.
//
// A single process forks for each run. Several ranks that mpirun has started
// cannot: they run one scene after the other, and a rank that fails alone ends
// them all, as it ends the program.

#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/mpi_singleton.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace dealii
{
  namespace Utilities
  {
    namespace MPI
    {
      /// MPI has been started before the fork.
      struct IsStarted
      {
        IsStarted(int &, char **&, unsigned int)
        {}
      };
    } // namespace MPI
  }   // namespace Utilities
} // namespace dealii

// The real one, but for the start of MPI and its name.
#define MPI_InitFinalize IsStarted
#define main main_of_program
#include "../../source/main.cc"
#undef main
#undef MPI_InitFinalize

namespace
{
  /// Limits of a run: processor time and clock in seconds, memory in bytes (0:
  /// none).
  struct Limits
  {
    rlim_t       processor_time;
    unsigned int clock;
    rlim_t       memory;

    void
    apply() const
    {
      const auto limit = [](const __rlimit_resource resource,
                            const rlim_t            value) {
        const rlimit both{value, value};
        setrlimit(resource, &both);
      };
      limit(RLIMIT_CORE, 0);
      limit(RLIMIT_CPU, processor_time);
      limit(RLIMIT_FSIZE, rlim_t(256) << 20);
      if (memory > 0)
        limit(RLIMIT_AS, memory);
      alarm(clock);
    }
  };



  void
  redirect(const char *name, const int descriptor, const int flags)
  {
    const int file = open(name, flags, 0666);
    dup2(file, descriptor);
    close(file);
  }



  /// The exit code of the run that a line asks for. All its ranks write to the
  /// same files.
  int
  run_request(const std::string &request)
  {
    std::istringstream       words(request);
    std::string              directory, word;
    std::vector<std::string> arguments{"viscoplastic_contact"};
    words >> directory;
    while (words >> word)
      arguments.push_back(word);
    std::vector<char *> pointers;
    for (std::string &argument : arguments)
      pointers.push_back(argument.data());
    pointers.push_back(nullptr);

    if (chdir(directory.c_str()) != 0)
      return 127;
    redirect("/dev/null", STDIN_FILENO, O_RDONLY);
    redirect("stdout", STDOUT_FILENO, O_WRONLY | O_CREAT | O_APPEND);
    redirect("stderr", STDERR_FILENO, O_WRONLY | O_CREAT | O_APPEND);
    const int code =
      main_of_program(static_cast<int>(arguments.size()), pointers.data());
    std::cout << std::flush;
    return code;
  }



  void
  serve_by_forks(const Limits &limits)
  {
    std::string request;
    while (std::getline(std::cin, request))
      {
        const pid_t child = fork();
        if (child == 0)
          {
            limits.apply();
            _exit(
              run_request(request)); // what the parent has is not ours to end
          }
        int status = 0;
        waitpid(child, &status, 0);
        std::cout << (WIFSIGNALED(status) ? -WTERMSIG(status) :
                                            WEXITSTATUS(status))
                  << std::endl;
      }
  }



  /// The next line of the standard input of rank 0, on all ranks; empty at its
  /// end. Ranks that wait leave the processors to others.
  std::string
  next_request()
  {
    const bool reads =
      dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    std::string request;
    if (reads)
      std::getline(std::cin, request);
    int         length = static_cast<int>(request.size()), is_known = 0;
    MPI_Request broadcast;
    MPI_Ibcast(&length, 1, MPI_INT, 0, MPI_COMM_WORLD, &broadcast);
    while (is_known == 0)
      {
        MPI_Test(&broadcast, &is_known, MPI_STATUS_IGNORE);
        if (is_known == 0)
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    request.resize(length);
    MPI_Bcast(request.data(), length, MPI_CHAR, 0, MPI_COMM_WORLD);
    return request;
  }



  void
  serve_by_ranks()
  {
    const int input = dup(STDIN_FILENO), output = dup(STDOUT_FILENO),
              errors = dup(STDERR_FILENO);
    while (true)
      {
        const std::string request = next_request();
        if (request.empty())
          return;
        const int code = run_request(request);
        MPI_Barrier(MPI_COMM_WORLD);
        dup2(input, STDIN_FILENO);
        dup2(output, STDOUT_FILENO);
        dup2(errors, STDERR_FILENO);
        if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
          std::cout << code << std::endl;
      }
  }
} // namespace



/// Arguments: the limits of a run in a fork, in the order of Limits.
int
main(int argc, char *argv[])
{
  if (argc != 4)
    return 2;
  const Limits limits{std::stoul(argv[1]),
                      static_cast<unsigned int>(std::stoul(argv[2])),
                      std::stoul(argv[3])};
  int          n_hidden_arguments = 1;
  const bool   is_single          = Viscoplastic::run_without_mpi_job();
  dealii::Utilities::MPI::MPI_InitFinalize mpi(n_hidden_arguments, argv, 1);
  if (is_single)
    serve_by_forks(limits);
  else
    serve_by_ranks();
}
