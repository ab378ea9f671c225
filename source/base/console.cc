// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>

#include <viscoplastic_contact/base/console.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

namespace Viscoplastic
{
  bool
  stdout_is_terminal()
  {
    const char *type = std::getenv("TERM");
    bool        sees = isatty(STDOUT_FILENO) != 0 && type != nullptr &&
                std::string(type) != "dumb";
    // Variables of Open MPI, MPICH and others.
    for (const char *variable :
         {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"})
      sees = sees && std::getenv(variable) == nullptr;
    return sees;
  }



  Console::Console(const MPI_Comm     communicator,
                   const bool         quiet,
                   const std::string &log_name,
                   const bool         has_terminal,
                   const bool         verbose)
    : speaks(!quiet && Utilities::MPI::this_mpi_process(communicator) == 0)
    , is_terminal(speaks && has_terminal)
    , verbose(verbose)
    , log_name(log_name)
    , buffer(*this)
    , everywhere(&buffer)
  {
    if (log_name.empty() || Utilities::MPI::this_mpi_process(communicator) != 0)
      return;
    log_file.open(log_name);
    AssertThrow(log_file,
                ExcMessage("The log file '" + log_name +
                           "' cannot be written; give --log another name."));
  }



  Console::~Console()
  {
    everywhere.flush();
    if (status_is_shown)
      std::cout << std::endl;
  }



  double
  Console::age() const
  {
    return std::chrono::duration<double>(Clock::now() - beginning).count();
  }



  bool
  Console::is_silent_for(const double seconds) const
  {
    const Clock::time_point now = Clock::now();
    return now - last_text > std::max<Clock::duration>(
                               std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(seconds)),
                               (now - beginning) / 100);
  }



  unsigned int
  Console::width() const
  {
    winsize size{};
    ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
    return size.ws_col > 0 ? size.ws_col : 80;
  }



  void
  Console::show_status(const std::string &line)
  {
    if (!is_terminal)
      return;
    everywhere.flush();
    last_text = Clock::now();
    // The last column stays free: a character there would begin a new line.
    // The escape sequence erases what is left of a longer line before.
    std::cout << '\r' << line.substr(0, width() - 1) << "\033[K" << std::flush;
    status_is_shown = true;
  }



  void
  Console::remark(const std::string &sentence)
  {
    // Two passes may say the same.
    if (std::find(all_remarks.begin(), all_remarks.end(), sentence) !=
        all_remarks.end())
      return;
    all_remarks.push_back(sentence);
    everywhere << sentence << std::endl;
  }



  void
  Console::check()
  {
    everywhere.flush();
    AssertThrow(!log_file.is_open() || log_file.flush(),
                ExcMessage("The log file '" + log_name +
                           "' is not complete: writing failed; is the disk "
                           "full?"));
    AssertThrow(!speaks || std::cout.flush(),
                ExcMessage("Writing to the standard output failed; is the disk "
                           "full?"));
  }



  int
  Console::Buffer::sync()
  {
    const std::string text = str();
    str("");
    if (!text.empty())
      console.last_text = Clock::now();
    if (console.speaks && !text.empty())
      {
        std::cout << (console.status_is_shown ? "\r\033[K" : "") << text
                  << std::flush;
        console.status_is_shown = false;
      }
    if (console.log_file.is_open())
      console.log_file << text << std::flush;
    return 0;
  }
} // namespace Viscoplastic
