// Waits for descriptors, and timers of the kernel: by the wall, which is told.
#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include <string>

#include "roscpp_shim/clocks.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/turn.h"
#include "roscpp_shim/waits.h"

namespace move_base_abstract::shim {
namespace {

constexpr Nanoseconds kMillisecond = 1'000'000;

/** @brief A wait for descriptors, or for none of them: then it is a sleep. */
class DescriptorWait {
 public:
  /** @param lasts ns; kNever: without end. */
  DescriptorWait(const char* name, bool has_descriptors, Nanoseconds lasts, const void* caller)
      // Whose code calls is looked up last: it takes longer than the system call.
      : whose_(Turn::isInside() || isRoscpps(caller) ? Sees::kMachine : sees()), lasts_(lasts) {
    if (whose_ == Sees::kMachine) {
      return;
    }
    if (has_descriptors) {
      tell(std::string(name) + " looks at a connection or a file, by the wall clock", caller);
    } else if (ordered() && lasts > 0 && lasts != kNever) {
      sleepWall(lasts);
      is_over_ = true;
    }
  }

  /** @return whether it was a sleep, which is over. */
  bool isOver() const { return is_over_; }

  /** @return @p result, after the machine's wait. */
  int waited(int result) const {
    if (result == 0 && lasts_ > 0 && lasts_ != kNever && whose_ == Sees::kRun) {
      addSleep(lasts_);
    }
    return result;
  }

 private:
  Sees whose_;
  Nanoseconds lasts_;
  bool is_over_ = false;
};

Nanoseconds ofMilliseconds(int timeout) { return timeout < 0 ? kNever : timeout * kMillisecond; }

Nanoseconds of(const timespec* timeout) { return timeout == nullptr ? kNever : toNs(*timeout); }

Nanoseconds of(const timeval* timeout) {
  return timeout == nullptr ? kNever : timeout->tv_sec * kSecond + timeout->tv_usec * 1000;
}

/** @brief The program has the kernel wake it by a clock of the wall. */
void tellTimer(const char* name, const void* caller) {
  if (!isRoscpps(caller) && sees() != Sees::kMachine) {
    tell(std::string(name) + " has the kernel wake the program by the wall clock", caller);
  }
}

}  // namespace
}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;
using shim::DescriptorWait;

#pragma GCC visibility push(default)
extern "C" {

int poll(pollfd* polled, nfds_t count, int timeout) {
  static auto* const function = shim::real<int(pollfd*, nfds_t, int)>("poll");
  const DescriptorWait wait("poll()", count > 0, shim::ofMilliseconds(timeout),
                            MOVE_BASE_ABSTRACT_CALLER);
  return wait.isOver() ? 0 : wait.waited(function(polled, count, timeout));
}

int __poll_chk(pollfd* polled, nfds_t count, int timeout, size_t size) {
  static auto* const function = shim::real<int(pollfd*, nfds_t, int, size_t)>("__poll_chk");
  const DescriptorWait wait("poll()", count > 0, shim::ofMilliseconds(timeout),
                            MOVE_BASE_ABSTRACT_CALLER);
  return wait.isOver() ? 0 : wait.waited(function(polled, count, timeout, size));
}

int ppoll(pollfd* polled, nfds_t count, const timespec* timeout, const sigset_t* mask) {
  static auto* const function =
      shim::real<int(pollfd*, nfds_t, const timespec*, const sigset_t*)>("ppoll");
  const DescriptorWait wait("ppoll()", count > 0, shim::of(timeout), MOVE_BASE_ABSTRACT_CALLER);
  return wait.isOver() ? 0 : wait.waited(function(polled, count, timeout, mask));
}

int select(int count, fd_set* readable, fd_set* writable, fd_set* other, timeval* timeout) {
  static auto* const function = shim::real<int(int, fd_set*, fd_set*, fd_set*, timeval*)>("select");
  const bool has_some = readable != nullptr || writable != nullptr || other != nullptr;
  const DescriptorWait wait("select()", count > 0 && has_some, shim::of(timeout),
                            MOVE_BASE_ABSTRACT_CALLER);
  return wait.isOver() ? 0 : wait.waited(function(count, readable, writable, other, timeout));
}

int pselect(int count, fd_set* readable, fd_set* writable, fd_set* other, const timespec* timeout,
            const sigset_t* mask) {
  static auto* const function =
      shim::real<int(int, fd_set*, fd_set*, fd_set*, const timespec*, const sigset_t*)>("pselect");
  const bool has_some = readable != nullptr || writable != nullptr || other != nullptr;
  const DescriptorWait wait("pselect()", count > 0 && has_some, shim::of(timeout),
                            MOVE_BASE_ABSTRACT_CALLER);
  return wait.isOver() ? 0 : wait.waited(function(count, readable, writable, other, timeout, mask));
}

int epoll_wait(int set, epoll_event* events, int count, int timeout) {
  static auto* const function = shim::real<int(int, epoll_event*, int, int)>("epoll_wait");
  const DescriptorWait wait("epoll_wait()", true, shim::ofMilliseconds(timeout),
                            MOVE_BASE_ABSTRACT_CALLER);
  return wait.waited(function(set, events, count, timeout));
}

int epoll_pwait(int set, epoll_event* events, int count, int timeout, const sigset_t* mask) {
  static auto* const function =
      shim::real<int(int, epoll_event*, int, int, const sigset_t*)>("epoll_pwait");
  const DescriptorWait wait("epoll_pwait()", true, shim::ofMilliseconds(timeout),
                            MOVE_BASE_ABSTRACT_CALLER);
  return wait.waited(function(set, events, count, timeout, mask));
}

int timerfd_create(int clock, int flags) {
  static auto* const function = shim::real<int(int, int)>("timerfd_create");
  shim::tellTimer("timerfd_create()", MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, flags);
}

int timer_create(clockid_t clock, sigevent* event, timer_t* timer) {
  static auto* const function = shim::real<int(clockid_t, sigevent*, timer_t*)>("timer_create");
  shim::tellTimer("timer_create()", MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, event, timer);
}

int setitimer(__itimer_which_t which, const itimerval* value, itimerval* before) {
  static auto* const function =
      shim::real<int(__itimer_which_t, const itimerval*, itimerval*)>("setitimer");
  shim::tellTimer("setitimer()", MOVE_BASE_ABSTRACT_CALLER);
  return function(which, value, before);
}

unsigned alarm(unsigned seconds) {
  static auto* const function = shim::real<unsigned(unsigned)>("alarm");
  shim::tellTimer("alarm()", MOVE_BASE_ABSTRACT_CALLER);
  return function(seconds);
}

useconds_t ualarm(useconds_t first, useconds_t period) {
  static auto* const function = shim::real<useconds_t(useconds_t, useconds_t)>("ualarm");
  shim::tellTimer("ualarm()", MOVE_BASE_ABSTRACT_CALLER);
  return function(first, period);
}

}  // extern "C"
#pragma GCC visibility pop
