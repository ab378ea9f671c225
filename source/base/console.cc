// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>

#include <viscoplastic_contact/base/console.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

namespace Viscoplastic
{
  bool
  stdout_is_terminal()
  {
    if (isatty(STDOUT_FILENO) == 0)
      return false;
    const char *type = std::getenv("TERM");
    if (type == nullptr || std::string(type) == "dumb")
      return false;
    // Variables of Open MPI, MPICH and others.
    for (const char *variable :
         {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"})
      if (std::getenv(variable) != nullptr)
        return false;
    return true;
  }



  Console::Console(const MPI_Comm     communicator,
                   const bool         quiet,
                   const std::string &log_name,
                   const bool         has_terminal)
    : speaks(!quiet && Utilities::MPI::this_mpi_process(communicator) == 0)
    , is_terminal(speaks && has_terminal)
    , log_name(log_name)
    , tee(*this)
    , everywhere(&tee)
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
    if (status_is_shown)
      std::cout << std::endl;
  }



  unsigned int
  Console::width() const
  {
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
      return size.ws_col;
    return 80;
  }



  void
  Console::show_status(const std::string &line)
  {
    if (!is_terminal)
      return;
    // The last column stays free: a character there would begin a new line.
    // The escape sequence erases what is left of a longer line before.
    std::cout << '\r' << line.substr(0, width() - 1) << "\033[K" << std::flush;
    status_is_shown = true;
  }



  void
  Console::remark(const std::string &sentence)
  {
    all_remarks.push_back(sentence);
    everywhere << sentence << std::endl;
  }



  void
  Console::check()
  {
    AssertThrow(!log_file.is_open() || log_file.flush(),
                ExcMessage("The log file '" + log_name +
                           "' is not complete: writing failed; is the disk "
                           "full?"));
    AssertThrow(!speaks || std::cout.flush(),
                ExcMessage("Writing to the standard output failed; is the disk "
                           "full?"));
  }



  int
  Console::Tee::overflow(int c)
  {
    if (traits_type::eq_int_type(c, traits_type::eof()))
      return traits_type::not_eof(c);
    const char character = traits_type::to_char_type(c);
    xsputn(&character, 1);
    return c;
  }



  std::streamsize
  Console::Tee::xsputn(const char *text, std::streamsize n)
  {
    if (console.speaks)
      {
        if (console.status_is_shown)
          {
            std::cout << "\r\033[K";
            console.status_is_shown = false;
          }
        std::cout.write(text, n);
      }
    if (console.log_file.is_open())
      console.log_file.write(text, n);
    return n;
  }



  int
  Console::Tee::sync()
  {
    if (console.speaks)
      std::cout.flush();
    if (console.log_file.is_open())
      console.log_file.flush();
    return 0;
  }
} // namespace Viscoplastic
