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
    if (!log_file)
      refuse("The log file '" + log_name +
             "' cannot be written; give --log another name.");
  }



  void
  Console::remark(const std::string &sentence)
  {
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
    if (log_file.is_open() && !log_file.flush())
      refuse("The log file '" + log_name +
             "' is not complete: writing failed; is the disk full?");
    if (speaks && !std::cout.flush())
      refuse("Writing to the standard output failed; is the disk full?");
  }



  int
  Console::Buffer::sync()
  {
    const std::string text = str();
    str("");
    if (console.speaks && !text.empty())
      std::cout << text << std::flush;
    if (console.log_file.is_open())
      console.log_file << text << std::flush;
    return 0;
  }
} // namespace Viscoplastic
