// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/base/messages.h>

#include <algorithm>
#include <iostream>

namespace Viscoplastic
{
  Console::Console(const MPI_Comm     communicator,
                   const bool         quiet,
                   const std::string &log_name,
                   const bool         verbose)
    : speaks(!quiet && Utilities::MPI::this_mpi_process(communicator) == 0)
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



  void
  Console::check()
  {
    everywhere.flush();
    AssertThrow(!log_file.is_open() || log_file.flush(),
                ExcMessage(
                  "The log file '" + log_name +
                  "' is not complete: writing failed; is the disk full?"));
    AssertThrow(!speaks || std::cout.flush(),
                ExcMessage(
                  "Writing to the standard output failed; is the disk full?"));
  }



  int
  Console::Buffer::sync()
  {
    const std::string text = str();
    str("");
    if (!text.empty())
      console.last_text = Clock::now();
    if (console.speaks && !text.empty())
      std::cout << text << std::flush;
    if (console.log_file.is_open())
      console.log_file << text << std::flush;
    return 0;
  }
} // namespace Viscoplastic
