// SPDX-License-Identifier: LGPL-2.1-or-later

// The program for tests with many runs: started once, forked for each of them.
// A line `directory argument ...' on standard input asks for a run there, with
// its output in the files stdout and stderr. The answer is a line with its exit
// code, or minus the number of the signal that ended it.

#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/mpi_singleton.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
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
  void
  limit(const __rlimit_resource resource, const rlim_t value)
  {
    const rlimit both{value, value};
    setrlimit(resource, &both);
  }



  void
  redirect(const char *name, const int descriptor)
  {
    const int file = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dup2(file, descriptor);
    close(file);
  }
} // namespace



/// Arguments: limits of processor time and of the clock in seconds, of memory
/// in bytes (0: none).
int
main(int argc, char *argv[])
{
  if (argc != 4)
    return 2;
  const rlim_t seconds = std::stoul(argv[1]), memory = std::stoul(argv[3]);
  const auto   alarm_after = static_cast<unsigned int>(std::stoul(argv[2]));
  int          n_hidden_arguments = 1;
  Viscoplastic::run_without_mpi_job();
  dealii::Utilities::MPI::MPI_InitFinalize mpi(n_hidden_arguments, argv, 1);

  std::string line;
  while (std::getline(std::cin, line))
    {
      const pid_t child = fork();
      if (child == 0)
        {
          std::istringstream       words(line);
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
            _exit(127);
          redirect("/dev/null", STDIN_FILENO);
          redirect("stdout", STDOUT_FILENO);
          redirect("stderr", STDERR_FILENO);
          limit(RLIMIT_CORE, 0);
          limit(RLIMIT_CPU, seconds);
          limit(RLIMIT_FSIZE, rlim_t(256) << 20);
          if (memory > 0)
            limit(RLIMIT_AS, memory);
          alarm(alarm_after);
          const int code = main_of_program(static_cast<int>(arguments.size()),
                                           pointers.data());
          std::cout << std::flush;
          _exit(code); // what belongs to the parent is not ours to end
        }
      int status = 0;
      waitpid(child, &status, 0);
      std::cout << (WIFSIGNALED(status) ? -WTERMSIG(status) :
                                          WEXITSTATUS(status))
                << std::endl;
    }
}
