// SPDX-License-Identifier: LGPL-2.1-or-later

// Ranks of tests sleep while they wait long for others. Open MPI asks again and
// again whether a message has come, and after each question it offers the
// processor to others, of which the scheduler makes little: where there are
// more ranks than processors, those that wait spend their shares of time on
// questions and have to queue when it is their turn to compute. Most messages
// come within microseconds, though, and who sleeps takes longer to wake up: a
// wait begins with 30 us of real offers.

#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <ctime>

namespace
{
  long
  nanoseconds()
  {
    timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000000000L + now.tv_nsec;
  }
} // namespace



/// Takes the place of the C library's. Other threads, of libraries that may be
/// unloaded at the end, do not stay here.
extern "C" int
sched_yield() noexcept
{
  if (syscall(SYS_gettid) != getpid())
    return syscall(SYS_sched_yield);
  [[maybe_unused]] static const int wakes_up_on_time =
    prctl(PR_SET_TIMERSLACK, 1);
  static long begin = 0, end_of_last = 0;
  const long  now = nanoseconds();
  if (now - end_of_last > 3000) // longer than a question: it has computed
    begin = now;
  const timespec pause{0, 20000};
  const int      code = now - begin < 30000 ?
                          static_cast<int>(syscall(SYS_sched_yield)) :
                          nanosleep(&pause, nullptr);
  end_of_last         = nanoseconds();
  return code;
}
