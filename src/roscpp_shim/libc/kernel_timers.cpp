// The kernel's timers that are descriptors (timerfd), as event loops use them.

#include <poll.h>
#include <sys/timerfd.h>
#include <time.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "roscpp_shim/clocks.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

constexpr int kLongestMs = 1000;  // wall: longest wait until the kernel notices a due timer

/** @brief A timer that is set; instants by the clock that the program sees. */
struct KernelTimer {
  clockid_t clock = CLOCK_MONOTONIC;
  Nanoseconds due = kNever;
  Nanoseconds period = 0;  // 0: it fires once
};

/**
 * @brief All timers that are descriptors, in the order of their numbers.
 *
 * While simulated time decides, the kernel's own timers are not set. When a timer is due, the
 * kernel's timer is set to an instant of the past, so that it is readable for any function.
 */
class KernelTimers {
 public:
  void add(int descriptor, clockid_t clock) {
    const Lock lock(mutex_);
    timers_[descriptor] = KernelTimer{clock, kNever, 0};
  }

  /** @return whether @p descriptor is one of them. */
  bool has(int descriptor) {
    const Lock lock(mutex_);
    return timers_.count(descriptor) > 0;
  }

  /** @brief Note that a thread that takes no turns has set the kernel's own timer. */
  void forget(int descriptor) {
    const Lock lock(mutex_);
    timers_[descriptor].due = kNever;
  }

  void set(int descriptor, int flags, const itimerspec& value) {
    const Lock lock(mutex_);
    KernelTimer& timer = timers_[descriptor];
    const Nanoseconds first = toNs(value.it_value);
    const bool is_absolute = (flags & TFD_TIMER_ABSTIME) != 0;
    timer.period = toNs(value.it_interval);
    timer.due = first == 0 ? kNever : is_absolute ? first : seenTime(timer.clock) + first;
    serve();
  }

  itimerspec get(int descriptor) {
    const Lock lock(mutex_);
    const KernelTimer& timer = timers_[descriptor];
    const Nanoseconds left =
        timer.due == kNever ? 0 : std::max<Nanoseconds>(timer.due - seenTime(timer.clock), 1);
    return {toTimespec(timer.period), toTimespec(left)};
  }

  /** @return when the first timer is due, simulated [ns]; now, if it is late. */
  Nanoseconds next() {
    const Lock lock(mutex_);
    Nanoseconds first = kNever;
    for (const auto& [descriptor, timer] : timers_) {
      if (timer.due != kNever) {
        const Nanoseconds left = std::max<Nanoseconds>(timer.due - seenTime(timer.clock), 0);
        first = std::min(first, node().now() + left);
      }
    }
    return first;
  }

  void fire() {
    const Lock lock(mutex_);
    if (!is_followed_) {
      is_followed_ = true;  // the first grant: from now on the kernel's timers are not used
      for (const auto& [descriptor, timer] : timers_) {
        if (timer.due != kNever) {  // otherwise a thread that takes no turns may have set it
          setReal(descriptor, itimerspec{}, 0);
        }
      }
    }
    for (auto& [descriptor, timer] : timers_) {
      if (timer.due <= seenTime(timer.clock)) {
        timer.due = timer.period > 0 ? timer.due + timer.period : kNever;
        if (!setReal(descriptor, {{0, 0}, {0, 1}}, TFD_TIMER_ABSTIME)) {
          timer.due = kNever;  // it was closed, and its number may belong to something else
          continue;
        }
        pollfd readable{descriptor, POLLIN, 0};
        ::poll(&readable, 1, kLongestMs);
      }
    }
  }

  void release() {
    const Lock lock(mutex_);
    for (auto& [descriptor, timer] : timers_) {
      if (timer.due != kNever) {
        const Nanoseconds left = std::max<Nanoseconds>(timer.due - seenTime(timer.clock), 1);
        setReal(descriptor, {toTimespec(timer.period), toTimespec(left)}, 0);
      }
    }
    timers_.clear();
  }

 private:
  /** @return whether it is still a timer. */
  static bool setReal(int descriptor, const itimerspec& value, int flags) {
    static auto* const function = real(&::timerfd_settime, "timerfd_settime");
    return function(descriptor, flags, &value, nullptr) == 0;
  }

  void serve() {
    if (!is_served_) {
      is_served_ = true;
      node().setTimers(kKernelTimers,
                       {[this] { return next(); }, [this] { fire(); }, [this] { release(); }});
    }
  }

  PlainMutex mutex_;
  std::map<int, KernelTimer> timers_;
  bool is_served_ = false;
  bool is_followed_ = false;
};

KernelTimers& kernelTimers() {
  static KernelTimers* const instance = new KernelTimers;
  return *instance;
}

bool isFollowed(int descriptor) { return ordered() && kernelTimers().has(descriptor); }

/** @return whether the program is to take part, and already sets its timers in a known order. */
bool isAboutToFollow() { return sees() == Sees::kRun && !turn().isActive() && !takesPart(); }

}  // namespace
}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

int timerfd_create(int clock, int flags) {
  static auto* const function = shim::real(&::timerfd_create, "timerfd_create");
  const int descriptor = function(clock, flags);
  const shim::Sees whose = shim::sees();
  if (descriptor >= 0 && whose != shim::Sees::kMachine) {
    if (whose == shim::Sees::kStray) {
      shim::tell("timerfd_create() has the kernel wake a thread that lockstep does not order",
                 MOVE_BASE_ABSTRACT_CALLER);
    }
    const shim::Inside inside;
    shim::kernelTimers().add(descriptor, clock);
  }
  return descriptor;
}

int timerfd_settime(int descriptor, int flags, const itimerspec* value, itimerspec* before) {
  static auto* const function = shim::real(&::timerfd_settime, "timerfd_settime");
  if (!shim::isFollowed(descriptor)) {
    const bool is_about = shim::isAboutToFollow();
    const int result = function(descriptor, flags, value, before);
    const shim::Inside inside;
    if (result == 0 && shim::kernelTimers().has(descriptor)) {
      is_about ? shim::kernelTimers().set(descriptor, flags, *value)
               : shim::kernelTimers().forget(descriptor);
    }
    return result;
  }
  const shim::Inside inside;
  const itimerspec old = shim::kernelTimers().get(descriptor);
  const itimerspec unset{};
  const int result = function(descriptor, flags, &unset, nullptr);  // also: is it one?
  if (result == 0) {
    shim::kernelTimers().set(descriptor, flags, *value);
    if (before != nullptr) {
      *before = old;
    }
  }
  return result;
}

int timerfd_gettime(int descriptor, itimerspec* value) {
  static auto* const function = shim::real(&::timerfd_gettime, "timerfd_gettime");
  if (!shim::isFollowed(descriptor)) {
    return function(descriptor, value);
  }
  const shim::Inside inside;
  *value = shim::kernelTimers().get(descriptor);
  return 0;
}

}  // extern "C"
#pragma GCC visibility pop
