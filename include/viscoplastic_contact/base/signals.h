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

    /// What has been asked of any rank since the last call, the same on all of
    /// them; @p checkpoint and @p is_late, that there is no time for another
    /// step, add what this rank knows. Collective.
    Request
    agree(const MPI_Comm communicator,
          const bool     checkpoint,
          const bool     is_late) const;
  };



  /// A write beyond the limit on file sizes (`ulimit -f') shall fail like one
  /// on a full disk, not end the process.
  void
  ignore_file_size_signal();



  /// While an object of this class lives, a call of exit() and an exception
  /// that nobody can catch, both of which code from a shared library of laws
  /// may come with, end the process with a sentence and the exit code 1: a run
  /// that ends early must not look like one that has succeeded. Objects may be
  /// nested, the last one says what the program was doing.
  class UnexpectedEnd
  {
  public:
    /// @p doing completes "while", such as "loading 'laws.so'".
    explicit UnexpectedEnd(const std::string &doing);
    ~UnexpectedEnd();

    UnexpectedEnd(const UnexpectedEnd &) = delete;
    UnexpectedEnd &
    operator=(const UnexpectedEnd &) = delete;

  private:
    const std::string  doing;
    const std::string *before;
  };
} // namespace Viscoplastic
