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
    /// Open @p log_file for writing unless the name is empty; throws ExcMessage
    /// if that fails. @p quiet suppresses the standard output, but not the log.
    /// @p verbose turns off all abbreviations of the output.
    explicit Console(const MPI_Comm     communicator = MPI_COMM_WORLD,
                     const bool         quiet        = false,
                     const std::string &log_file     = "",
                     const bool         verbose      = false);

    ~Console();

    Console(const Console &) = delete;
    Console &
    operator=(const Console &) = delete;

    /// Return the stream for output: on rank 0, flushing it writes to standard
    /// output and log; on other ranks the text is discarded.
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

    /// Return whether also repetitive output is wanted in full.
    bool
    is_verbose() const
    {
      return verbose;
    }

    /// Return whether the output of this rank goes anywhere.
    bool
    is_heard() const
    {
      return speaks || log_file.is_open();
    }

    /// Return the seconds since the construction of this object.
    double
    age() const
    {
      return std::chrono::duration<double>(Clock::now() - beginning).count();
    }

    /// Return whether there has been no output for @p seconds, or for a
    /// hundredth of the age() if that is longer, to limit output.
    bool
    is_silent_for(const double seconds) const;

    /// Print a sentence that the user should see, and keep it in remarks().
    void
    remark(const std::string &sentence)
    {
      // Repeated passes over the input may give the same remark.
      if (std::find(all_remarks.begin(), all_remarks.end(), sentence) !=
          all_remarks.end())
        return;
      all_remarks.push_back(sentence);
      everywhere << sentence << std::endl;
    }

    /// Return the different sentences given to remark(), in order.
    const std::vector<std::string> &
    remarks() const
    {
      return all_remarks;
    }

    /// Throw ExcMessage if a write to the standard output or to the log has
    /// failed, for example because the disk is full. Only rank 0 writes.
    void
    check();

  private:
    /// Collects text and passes it on when it is flushed.
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
