// SPDX-License-Identifier: LGPL-2.1-or-later

// Ranks of tests sleep while they wait for others. Open MPI asks again and
// again whether a message has come, and after each question it offers the
// processor to others, of which the scheduler makes little: where there are
// more ranks than processors, those that wait spend their shares of time on
// questions and have to queue when it is their turn to compute.

#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <ctime>

/// Takes the place of the C library's. Other threads, of libraries that may be
/// unloaded at the end, do not stay here.
extern "C" int
sched_yield() noexcept
{
  if (syscall(SYS_gettid) != getpid())
    return syscall(SYS_sched_yield);
  [[maybe_unused]] static const int wakes_up_on_time =
    prctl(PR_SET_TIMERSLACK, 1);
  const timespec pause{0, 20000};
  return nanosleep(&pause, nullptr);
}
