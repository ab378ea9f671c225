// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <string>

namespace Viscoplastic
{
  /// While an object of this class lives, SIGUSR1 asks for a checkpoint, and
  /// SIGTERM and SIGINT ask the run to end after one. A second SIGTERM or
  /// SIGINT ends the process at once. There must not be two objects at a time.
  class SignalRequests
  {
  public:
    SignalRequests();
    ~SignalRequests();

    SignalRequests(const SignalRequests &) = delete;
    SignalRequests &
    operator=(const SignalRequests &) = delete;

    struct Request
    {
      bool checkpoint = false;
      /// The signal that ends the run, if there is one: "SIGTERM" or "SIGINT".
      std::string stop;
      /// Whether there is no time for another step.
      bool is_late = false;
    };

    /// Return what has been requested on any rank since the last call, the same
    /// on all ranks. @p checkpoint and @p is_late (no time is left for another
    /// step) are the requests of this rank beside signals. Collective.
    Request
    agree(const MPI_Comm communicator,
          const bool     checkpoint,
          const bool     is_late) const;
  };



  /// Ignore SIGXFSZ: a write beyond the limit on file sizes (`ulimit -f') fails
  /// like one on a full disk and does not end the process.
  void
  ignore_file_size_signal();



  /// While an object of this class lives, a call of exit() or an uncaught
  /// exception, as code from a shared library of laws may cause, ends the
  /// process with a message and exit code 1: a run that ends early must not
  /// look successful. Objects may be nested; the innermost one says what the
  /// program was doing.
  class UnexpectedEnd
  {
  public:
    /// @p doing completes "while", such as "loading 'laws.so'".
    explicit UnexpectedEnd(const std::string &doing);
    ~UnexpectedEnd();

    UnexpectedEnd(const UnexpectedEnd &) = delete;

  private:
    const std::string  doing;
    const std::string *before;
  };
} // namespace Viscoplastic
