// Sleeps of libraries. No ROS.
#include <poll.h>
#include <sys/select.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>

#include "clocks.h"
#include "real.h"

namespace move_base_abstract::native {
namespace {

Real<int(const timespec*, timespec*)> real_nanosleep("nanosleep");

/** @brief Sleep for @p duration [ns], in a thread that sees @p whose.
 * @return 0, or -1 if it was interrupted. */
int sleepFor(Nanoseconds duration, Sees whose, timespec* rest) {
  if (duration <= 0) {
    return 0;
  }
  if (whose == Sees::kRun && mayCall()) {
    if (sleepInPython(duration)) {
      return 0;
    }
    if (rest != nullptr) {
      *rest = shim::toTimespec(duration);
    }
    errno = EINTR;
    return -1;
  }
  const timespec request = shim::toTimespec(duration);
  timespec left{};
  const int result = real_nanosleep(&request, &left);
  goOn(duration - (result == 0 ? 0 : shim::toNs(left)), whose);
  if (result != 0 && rest != nullptr) {
    *rest = left;
  }
  return result;
}

int sleepFor(const timespec& request, timespec* rest, const void* caller) {
  const Sees whose = sees(caller);
  const bool is_valid = request.tv_sec >= 0 && request.tv_nsec >= 0 && request.tv_nsec < kSecond &&
                        request.tv_sec < kSecond;
  return whose == Sees::kMachine || !is_valid ? real_nanosleep(&request, rest)
                                              : sleepFor(shim::toNs(request), whose, rest);
}

}  // namespace
}  // namespace move_base_abstract::native

#include "libc/sleeps.h"
using move_base_abstract::Nanoseconds;

#pragma GCC visibility push(default)
extern "C" {

int clock_nanosleep(clockid_t clock, int flags, const timespec* request, timespec* rest) {
  static native::Real<int(clockid_t, int, const timespec*, timespec*)> function("clock_nanosleep");
  const native::Sees whose = native::sees(MOVE_BASE_ABSTRACT_CALLER);
  const bool is_valid = request->tv_sec >= 0 && request->tv_nsec >= 0 &&
                        request->tv_nsec < shim::kSecond && request->tv_sec < 4 * shim::kSecond;
  if (whose == native::Sees::kMachine || !is_valid) {
    return function(clock, flags, request, rest);
  }
  const bool is_absolute = (flags & TIMER_ABSTIME) != 0;
  const Nanoseconds lasts =
      shim::toNs(*request) - (is_absolute ? native::seenTime(clock, whose) : 0);
  return native::sleepFor(lasts, whose, is_absolute ? nullptr : rest) == 0 ? 0 : errno;
}

// Without a descriptor, these functions sleep.

int poll(pollfd* files, nfds_t count, int milliseconds) {
  static native::Real<int(pollfd*, nfds_t, int)> function("poll");
  const native::Sees whose = count == 0 && milliseconds > 0
                                 ? native::sees(MOVE_BASE_ABSTRACT_CALLER)
                                 : native::Sees::kMachine;
  return whose == native::Sees::kMachine
             ? function(files, count, milliseconds)
             : native::sleepFor(milliseconds * (shim::kSecond / 1000), whose, nullptr);
}

int select(int count, fd_set* read, fd_set* write, fd_set* except, timeval* timeout) {
  static native::Real<int(int, fd_set*, fd_set*, fd_set*, timeval*)> function("select");
  const bool is_sleep =
      count == 0 && timeout != nullptr && timeout->tv_sec >= 0 && timeout->tv_sec < shim::kSecond;
  const native::Sees whose =
      is_sleep ? native::sees(MOVE_BASE_ABSTRACT_CALLER) : native::Sees::kMachine;
  return whose == native::Sees::kMachine
             ? function(count, read, write, except, timeout)
             : native::sleepFor(
                   timeout->tv_sec * shim::kSecond + timeout->tv_usec * shim::kMicrosecond, whose,
                   nullptr);
}

}  // extern "C"
#pragma GCC visibility pop
