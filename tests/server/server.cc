// SPDX-License-Identifier: LGPL-2.1-or-later

// The program for tests with many runs: its libraries are linked once, which
// takes a third of a second. It listens at a socket where the program `client'
// asks for processes in the place of real ones, also those of an MPI job.
//
// Such a process, or one that is started with the limits of a run, may itself
// serve (arguments of main): a line `directory argument ...' on standard input
// asks for a run there, with its output in the files stdout and stderr. The
// answer is a line with its exit code, or minus the number of the signal that
// ended it. A single process forks for each run. Several ranks cannot: they run
// one scene after the other, and a rank that fails alone ends them all, as it
// ends the program.

#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/mpi_singleton.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <iostream>
#include <optional>
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
      /// MPI may have been started before the fork.
      struct StartUnlessStarted
      {
        StartUnlessStarted(int               &argc,
                           char            **&argv,
                           const unsigned int n_threads)
        {
          int is_started;
          MPI_Initialized(&is_started);
          if (is_started == 0)
            mpi.emplace(argc, argv, n_threads);
        }

        std::optional<MPI_InitFinalize> mpi;
      };
    } // namespace MPI
  }   // namespace Utilities
} // namespace dealii

// The real one, but for the start of MPI and its name.
#define MPI_InitFinalize StartUnlessStarted
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



  /// The exit code of a run with these arguments in the present directory.
  int
  run(std::vector<std::string> arguments)
  {
    arguments.insert(arguments.begin(), "viscoplastic_contact");
    std::vector<char *> pointers;
    for (std::string &argument : arguments)
      pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    const int code =
      main_of_program(static_cast<int>(arguments.size()), pointers.data());
    std::cout << std::flush;
    return code;
  }



  /// The exit code of the run that a line asks for. All its ranks write to the
  /// same files.
  int
  run_request(const std::string &request)
  {
    std::istringstream       words(request);
    std::string              directory, word;
    std::vector<std::string> arguments;
    words >> directory;
    while (words >> word)
      arguments.push_back(word);
    if (chdir(directory.c_str()) != 0)
      return 127;
    redirect("/dev/null", STDIN_FILENO, O_RDONLY);
    redirect("stdout", STDOUT_FILENO, O_WRONLY | O_CREAT | O_APPEND);
    redirect("stderr", STDERR_FILENO, O_WRONLY | O_CREAT | O_APPEND);
    return run(arguments);
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
    for (int pause = 1;; pause = std::min(2 * pause, 16))
      {
        MPI_Test(&broadcast, &is_known, MPI_STATUS_IGNORE);
        if (is_known != 0)
          break;
        std::this_thread::sleep_for(std::chrono::milliseconds(pause));
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



  /// MPI, unless it has been started.
  struct StartedMPI
  {
    int                                        n_arguments = 0;
    char                                      *none        = nullptr;
    char                                     **arguments   = &none;
    dealii::Utilities::MPI::StartUnlessStarted mpi{n_arguments, arguments, 1};
  };



  /// What a line asks for, again and again, on as many ranks as there are.
  /// Arguments: the limits of a run in a fork, in the order of Limits.
  int
  serve(const std::vector<std::string> &arguments)
  {
    if (arguments.size() != 3)
      return 2;
    const Limits     limits{std::stoul(arguments[0]),
                        static_cast<unsigned int>(std::stoul(arguments[1])),
                        std::stoul(arguments[2])};
    const bool       is_single = Viscoplastic::run_without_mpi_job();
    const StartedMPI mpi;
    if (is_single)
      serve_by_forks(limits);
    else
      serve_by_ranks();
    return 0;
  }



  /// The process that a client asks for: a message with its directory, the
  /// number of its arguments, these and its environment, each ended by a zero,
  /// and its standard streams. Answers are its number, to which the client
  /// sends its signals on, and its status in the end. It ends with the client.
  void
  serve_client(const int client)
  {
    int                      streams[3];
    std::vector<char>        text(1 << 18);
    alignas(cmsghdr) char    control[CMSG_SPACE(sizeof(streams))];
    iovec                    part{text.data(), text.size()};
    msghdr                   message{};
    std::vector<std::string> words;
    message.msg_iov        = &part;
    message.msg_iovlen     = 1;
    message.msg_control    = control;
    message.msg_controllen = sizeof(control);
    const ssize_t length   = recvmsg(client, &message, MSG_CMSG_CLOEXEC);
    if (length <= 0 || message.msg_controllen < sizeof(control))
      return;
    std::memcpy(streams, CMSG_DATA(CMSG_FIRSTHDR(&message)), sizeof(streams));
    for (const char *word = text.data(); word < text.data() + length;
         word += words.back().size() + 1)
      words.emplace_back(word);

    int alive[2]; // a pipe that the end of the process closes
    if (pipe2(alive, O_CLOEXEC) != 0)
      return;
    const pid_t child = fork();
    if (child == 0)
      {
        for (int i = 0; i < 3; ++i)
          dup2(streams[i], i);
        const auto variables = words.begin() + 2 + std::stoi(words[1]);
        clearenv();
        for (auto variable = variables; variable != words.end(); ++variable)
          putenv(variable->data());
        if (chdir(words.front().c_str()) != 0)
          _exit(127);
        const std::vector<std::string> arguments(words.begin() + 2, variables);
        if (!arguments.empty() && arguments.front() == "--serve")
          _exit(serve({arguments.begin() + 1, arguments.end()}));
        _exit(run(arguments));
      }
    close(alive[1]);
    for (int i = 0; i < 3; ++i)
      {
        close(streams[i]);
        close(i);
      }
    send(client, &child, sizeof(child), MSG_NOSIGNAL);
    pollfd ends[] = {{client, POLLIN, 0}, {alive[0], 0, 0}};
    poll(ends, 2, -1);
    if (ends[0].revents != 0)
      kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    send(client, &status, sizeof(status), MSG_NOSIGNAL);
  }



  /// Until nobody has asked for a minute.
  void
  serve_at_socket(const std::string &path)
  {
    const int   listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    unlink(path.c_str());
    if (bind(listener,
             reinterpret_cast<const sockaddr *>(&address),
             sizeof(address)) != 0 ||
        listen(listener, 16) != 0)
      return;
    std::cout << "ready" << std::endl;
    std::signal(SIGCHLD, SIG_IGN); // nobody waits for them
    pollfd input{listener, POLLIN, 0};
    while (poll(&input, 1, 60000) > 0)
      {
        const int client = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
        if (fork() == 0)
          {
            close(listener);
            std::signal(SIGCHLD, SIG_DFL);
            serve_client(client);
            _exit(0);
          }
        close(client);
      }
    unlink(path.c_str());
  }
} // namespace



/// Arguments: the path of a socket, or those of serve(). There are two
/// processes for clients: ranks of a job start MPI themselves, single ones find
/// it started.
int
main(int argc, char *argv[])
{
  if (argc != 2)
    return serve({argv + 1, argv + argc});
  const std::string path = argv[1];
  if (fork() == 0)
    {
      Viscoplastic::run_without_mpi_job();
      const StartedMPI mpi;
      serve_at_socket(path + ".single");
      _exit(0);
    }
  serve_at_socket(path);
}
