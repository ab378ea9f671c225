// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// The output stream of a run: standard output of rank 0 and, if asked for, a
  /// log file.
  class Console
  {
  public:
    /// @p quiet leaves the standard output alone, not the log. @p verbose:
    /// nothing is left out for brevity. Throws ExcMessage if @p log_file,
    /// unless empty, cannot be written.
    explicit Console(const MPI_Comm     communicator = MPI_COMM_WORLD,
                     const bool         quiet        = false,
                     const std::string &log_file     = "",
                     const bool         verbose      = false);

    ~Console();

    Console(const Console &) = delete;
    Console &
    operator=(const Console &) = delete;

    /// Text goes to the standard output and the log whenever this is flushed;
    /// on other ranks nowhere.
    std::ostream &
    stream()
    {
      return everywhere;
    }

    std::ostream &
    log()
    {
      return everywhere.flush(), log_file;
    }

    /// Whether all is to be told, also what repeats itself.
    bool
    is_verbose() const
    {
      return verbose;
    }

    /// Whether anybody gets to see what is said on this rank.
    bool
    is_heard() const
    {
      return speaks || log_file.is_open();
    }

    /// Seconds since the beginning.
    double
    age() const
    {
      return std::chrono::duration<double>(Clock::now() - beginning).count();
    }

    /// Whether nothing has been said for @p seconds, or for a hundredth of the
    /// time since the beginning if that is longer, so that long runs do not
    /// flood.
    bool
    is_silent_for(const double seconds) const;

    /// Print a sentence that the user should not overlook; it is repeated at
    /// the end.
    void
    remark(const std::string &sentence)
    {
      // Two passes may say the same.
      if (std::find(all_remarks.begin(), all_remarks.end(), sentence) !=
          all_remarks.end())
        return;
      all_remarks.push_back(sentence);
      everywhere << sentence << std::endl;
    }

    /// The sentences given to remark(), in the order in which they came.
    const std::vector<std::string> &
    remarks() const
    {
      return all_remarks;
    }

    /// Throws ExcMessage if not all has been written that was to be, on the
    /// standard output or in the log: the disk may be full. On rank 0.
    void
    check();

  private:
    /// Keeps text until it is flushed.
    struct Buffer : public std::stringbuf
    {
      explicit Buffer(Console &console)
        : console(console)
      {}

      int
      sync() override;

      Console &console;
    };

    using Clock = std::chrono::steady_clock;

    const bool               speaks;
    const bool               verbose;
    const std::string        log_name;
    std::ofstream            log_file;
    Buffer                   buffer;
    std::ostream             everywhere;
    const Clock::time_point  beginning = Clock::now();
    Clock::time_point        last_text = beginning;
    std::vector<std::string> all_remarks;
  };
} // namespace Viscoplastic
