// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

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
    /// @p verbose asks for repetitive output in full.
    explicit Console(const MPI_Comm     communicator = MPI_COMM_WORLD,
                     const bool         quiet        = false,
                     const std::string &log_file     = "",
                     const bool         verbose      = false);

    ~Console()
    {
      everywhere.flush();
    }

    Console(const Console &) = delete;

    /// Return the stream for output: on rank 0, flushing it writes to standard
    /// output and log; on other ranks the text is discarded.
    std::ostream &
    stream()
    {
      return everywhere;
    }

    /// Return the stream of the log alone.
    std::ostream &
    log()
    {
      return everywhere.flush(), log_file;
    }

    bool
    is_verbose() const
    {
      return verbose;
    }

    /// Print a sentence that the user should see, unless it has been printed
    /// before, and keep it in remarks().
    void
    remark(const std::string &sentence);

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

    const bool               speaks, verbose;
    const std::string        log_name;
    std::ofstream            log_file;
    Buffer                   buffer;
    std::ostream             everywhere;
    std::vector<std::string> all_remarks;
  };
} // namespace Viscoplastic
