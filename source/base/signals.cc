// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/signals.h>

#include <array>
#include <csignal>
#include <exception>
#include <iostream>

namespace Viscoplastic
{
  namespace
  {
    // The only types that a signal handler may write.
    volatile std::sig_atomic_t checkpoint_requested = 0;
    volatile std::sig_atomic_t stop_signal          = 0;

    extern "C" void
    request_checkpoint(int)
    {
      checkpoint_requested = 1;
    }

    extern "C" void
    request_stop(int signal)
    {
      stop_signal = signal;
    }

    using Actions = std::array<struct sigaction, 3>;
    const std::array<int, 3> handled{{SIGUSR1, SIGTERM, SIGINT}};
    Actions                  old_actions;
  } // namespace



  SignalRequests::SignalRequests()
  {
    checkpoint_requested = 0;
    stop_signal          = 0;
    for (unsigned int i = 0; i < handled.size(); ++i)
      {
        struct sigaction action
        {};
        action.sa_handler =
          handled[i] == SIGUSR1 ? request_checkpoint : request_stop;
        sigemptyset(&action.sa_mask);
        // SA_RESTART resumes interrupted reads and writes; SA_RESETHAND gives a
        // second stop signal its default action.
        action.sa_flags = SA_RESTART;
        if (handled[i] != SIGUSR1)
          action.sa_flags |= SA_RESETHAND;
        sigaction(handled[i], &action, &old_actions[i]);
      }
  }



  SignalRequests::~SignalRequests()
  {
    for (unsigned int i = 0; i < handled.size(); ++i)
      sigaction(handled[i], &old_actions[i], nullptr);
  }



  SignalRequests::Request
  SignalRequests::agree(const MPI_Comm communicator,
                        const bool     checkpoint,
                        const bool     is_late) const
  {
    // A signal between these lines is lost, but a checkpoint is made anyway.
    const bool requested = checkpoint_requested != 0;
    if (requested)
      checkpoint_requested = 0;
    const std::array<int, 3> mine{{checkpoint || requested ? 1 : 0,
                                   static_cast<int>(stop_signal),
                                   is_late ? 1 : 0}};
    std::array<int, 3>       all = mine;
    dealii::Utilities::MPI::max(dealii::ArrayView<const int>(mine.data(),
                                                             mine.size()),
                                communicator,
                                dealii::ArrayView<int>(all.data(), all.size()));
    Request request;
    request.checkpoint = all[0] != 0;
    if (all[1] != 0)
      request.stop = all[1] == SIGINT ? "SIGINT" : "SIGTERM";
    request.is_late = all[2] != 0;
    return request;
  }



  void
  ignore_file_size_signal()
  {
    std::signal(SIGXFSZ, SIG_IGN);
  }



  namespace
  {
    /// The activity that the innermost object names; null if there is none.
    const std::string *current = nullptr;



    void
    end(const std::string &event)
    {
      // Use a single write, since several ranks may end at the same time.
      std::cerr << "viscoplastic_contact: " + event + " while " + *current +
                     "; a law of a shared library may do so.\n";
      std::_Exit(1);
    }



    extern "C" void
    end_at_exit()
    {
      if (current != nullptr)
        end("exit() has been called");
    }



    [[noreturn]] void
    end_at_terminate()
    {
      if (current != nullptr && std::current_exception())
        end("an exception has been thrown where none can be caught ('" +
            reason_of_current_exception() + "')");
      std::abort();
    }
  } // namespace



  UnexpectedEnd::UnexpectedEnd(const std::string &doing)
    : doing(doing)
    , before(current)
  {
    static const bool is_registered = [] {
      std::set_terminate(end_at_terminate);
      return std::atexit(end_at_exit) == 0 &&
             std::at_quick_exit(end_at_exit) == 0;
    }();
    (void)is_registered;
    current = &this->doing;
  }



  UnexpectedEnd::~UnexpectedEnd()
  {
    current = before;
  }
} // namespace Viscoplastic
