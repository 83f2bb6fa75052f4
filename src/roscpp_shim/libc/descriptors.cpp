// Waits for descriptors. If only the program makes the descriptors ready, a wait goes by simulated
// time. Otherwise it goes by the wall clock and labels the run.
#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "roscpp_shim/clocks.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/kernel.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"
#include "roscpp_shim/waits.h"

namespace move_base_abstract::shim {
namespace {

constexpr Nanoseconds kMillisecond = 1'000'000;
constexpr unsigned kEmptyLooks = 1000;   // looks in vain, after which simulated time goes on
constexpr int kStandardDescriptors = 3;  // their other ends belong to other processes

using Lock = std::lock_guard<PlainMutex>;

// ---- which descriptors only the program itself can make ready --------------------------------

/** @brief What is known about the descriptors of a wait. */
struct WaitedFor {
  bool is_own = true;      // only events, timers and pipes of the program
  bool has_timer = false;  // one of them is a timer

  void add(const WaitedFor& other) {
    is_own = is_own && other.is_own;
    has_timer = has_timer || other.has_timer;
  }
};

struct Sets {
  PlainMutex mutex;
  std::map<int, std::map<int, WaitedFor>> members;
};

Sets& sets() {
  static Sets* const instance = new Sets;
  return *instance;
}

/** @brief Forget the members of an older, closed set that had the same number. @return @p set. */
int emptySet(int set) {
  const Inside inside;
  const Lock lock(sets().mutex);
  sets().members.erase(set);
  return set;
}

/** @return what is known about the members of an epoll descriptor, as epoll_ctl() added them. */
WaitedFor membersOf(int set) {
  const Inside inside;
  const Lock lock(sets().mutex);
  WaitedFor all;
  for (const auto& [descriptor, what] : sets().members[set]) {
    all.add(what);
  }
  return all;
}

/** @return what is known about @p descriptor. */
WaitedFor lookAt(int descriptor) {
  if (descriptor < 0) {
    return {};  // poll() ignores it
  }
  const Inside inside;
  const std::string name = targetOf(descriptor);
  if (name == "anon_inode:[eventpoll]") {
    return membersOf(descriptor);
  }
  const bool is_timer = name == "anon_inode:[timerfd]";
  const bool is_pipe = descriptor >= kStandardDescriptors && name.rfind("pipe:", 0) == 0;
  return {is_timer || is_pipe || name == "anon_inode:[eventfd]", is_timer};
}

// ---- waits -----------------------------------------------------------------------------------

/** @brief Wait for descriptors in simulated time. @return false if the run has ended meanwhile. */
bool awaitDescriptors(Nanoseconds lasts, std::function<bool()> is_ready) {
  Task& me = *Turn::self();
  if (is_ready()) {
    me.empty_polls = 0;
    return true;
  }
  if (lasts <= 0) {
    countLook(&me.empty_polls, kEmptyLooks);
    return true;
  }
  me.has_acted = true;
  me.empty_polls = 0;
  Wait wait;
  wait.until = lasts == kNever ? kNever : node().now() + lasts;
  wait.is_over = std::move(is_ready);
  wait.is_on_descriptors = true;
  wait.for_thread = lasts == kNever;
  wait.what = "descriptors";
  return turn().wait(std::move(wait)) != Woken::kEnd;
}

/** @brief A wait for descriptors. Without descriptors it is a sleep. */
class DescriptorWait {
 public:
  /** @param look what is waited for; null: no descriptors. @param lasts ns; kNever: without end. */
  DescriptorWait(const char* name, const std::function<WaitedFor()>& look,
                 const std::function<bool()>& is_ready, Nanoseconds lasts, const void* caller)
      // The caller is looked up second: that takes longer than the system call.
      : whose_(Turn::isInside() || isRoscpps(caller) ? Sees::kMachine : sees()), lasts_(lasts) {
    if (whose_ == Sees::kMachine) {
      return;
    }
    if (!look) {
      is_over_ = ordered() && lasts > 0 && lasts != kNever;
      if (is_over_) {
        sleepWall(lasts);
      }
      return;
    }
    const WaitedFor what = look();
    if (!what.is_own) {
      tell(std::string(name) + " looks at a connection or a file, by the wall clock", caller);
    } else if (!ordered()) {
      tell(std::string(name) + " waits in a thread that lockstep does not order", caller);
    }
    // Data from others comes by the wall clock; the timers beside it go by simulated time.
    is_simulated_ =
        ordered() && (what.is_own || what.has_timer) && awaitDescriptors(lasts, is_ready);
    begin_ = is_simulated_ || ordered() ? 0 : machineTime(CLOCK_MONOTONIC);
  }

  /** @return whether it was a sleep, and is over. */
  bool isOver() const { return is_over_; }
  /** @return whether the wait is done in simulated time, so that only a look is left. */
  bool isSimulated() const { return is_simulated_; }

  /** @return @p result of the real function; advances the seen clocks by its wait. */
  int waited(int result) const {
    if (begin_ != 0 && whose_ == Sees::kRun) {
      addSleep(machineTime(CLOCK_MONOTONIC) - begin_);  // nothing else lets the clocks go on
    } else if (result == 0 && !is_simulated_ && lasts_ > 0 && lasts_ != kNever &&
               whose_ == Sees::kRun) {
      addSleep(lasts_);
    }
    return result;
  }

 private:
  Sees whose_;
  Nanoseconds lasts_;
  Nanoseconds begin_ = 0;
  bool is_over_ = false;
  bool is_simulated_ = false;
};

Nanoseconds ofMilliseconds(int timeout) { return timeout < 0 ? kNever : timeout * kMillisecond; }

Nanoseconds of(const timespec* timeout) { return timeout == nullptr ? kNever : toNs(*timeout); }

Nanoseconds of(const timeval* timeout) {
  return timeout == nullptr ? kNever : timeout->tv_sec * kSecond + timeout->tv_usec * 1000;
}

}  // namespace
}  // namespace move_base_abstract::shim

using shim::DescriptorWait;

namespace move_base_abstract::shim {
namespace {

int pollReally(pollfd* polled, nfds_t count, int timeout) {
  static auto* const function = real(&::poll, "poll");
  return function(polled, count, timeout);
}

DescriptorWait waitOnPoll(const char* name, pollfd* polled, nfds_t count, Nanoseconds lasts,
                          const void* caller) {
  std::function<WaitedFor()> look;
  if (count > 0) {
    look = [polled, count] {
      WaitedFor all;
      for (nfds_t k = 0; k < count; ++k) {
        all.add(lookAt(polled[k].fd));
      }
      return all;
    };
  }
  return {name, look, [polled, count] { return pollReally(polled, count, 0) != 0; }, lasts, caller};
}

/** @brief The sets of a select(), which writes its answer into them. */
struct SelectSets {
  int count;
  fd_set* sets[3];

  bool areEmpty() const {
    return count <= 0 || (sets[0] == nullptr && sets[1] == nullptr && sets[2] == nullptr);
  }

  WaitedFor look() const {
    WaitedFor all;
    for (int k = 0; k < count; ++k) {
      for (const fd_set* set : sets) {
        if (set != nullptr && FD_ISSET(k, set)) {
          all.add(lookAt(k));
        }
      }
    }
    return all;
  }

  bool isReady() const {
    static auto* const function = real(&::select, "select");
    fd_set copies[3];
    fd_set* pointers[3];
    for (int k = 0; k < 3; ++k) {
      pointers[k] = sets[k] == nullptr ? nullptr : &(copies[k] = *sets[k]);
    }
    timeval at_once{0, 0};
    return function(count, pointers[0], pointers[1], pointers[2], &at_once) != 0;
  }
};

DescriptorWait waitOnSelect(const char* name, const SelectSets& sets, Nanoseconds lasts,
                            const void* caller) {
  std::function<WaitedFor()> look;
  if (!sets.areEmpty()) {
    look = [sets] { return sets.look(); };
  }
  return {name, look, [sets] { return sets.isReady(); }, lasts, caller};
}

DescriptorWait waitOnSet(const char* name, int set, Nanoseconds lasts, const void* caller) {
  const auto is_ready = [set] {  // without taking the events, as epoll_wait() would
    pollfd polled{set, POLLIN, 0};
    return pollReally(&polled, 1, 0) != 0;
  };
  return {name, [set] { return membersOf(set); }, is_ready, lasts, caller};
}

}  // namespace
}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

int poll(pollfd* polled, nfds_t count, int timeout) {
  const DescriptorWait wait = shim::waitOnPoll(
      "poll()", polled, count, shim::ofMilliseconds(timeout), MOVE_BASE_ABSTRACT_CALLER);
  return wait.isOver()
             ? 0
             : wait.waited(shim::pollReally(polled, count, wait.isSimulated() ? 0 : timeout));
}

int __poll_chk(pollfd* polled, nfds_t count, int timeout, size_t size) {
  static auto* const function = shim::real(&::__poll_chk, "__poll_chk");
  const DescriptorWait wait = shim::waitOnPoll(
      "poll()", polled, count, shim::ofMilliseconds(timeout), MOVE_BASE_ABSTRACT_CALLER);
  return wait.isOver()
             ? 0
             : wait.waited(function(polled, count, wait.isSimulated() ? 0 : timeout, size));
}

int ppoll(pollfd* polled, nfds_t count, const timespec* timeout, const sigset_t* mask) {
  static auto* const function = shim::real(&::ppoll, "ppoll");
  const DescriptorWait wait =
      shim::waitOnPoll("ppoll()", polled, count, shim::of(timeout), MOVE_BASE_ABSTRACT_CALLER);
  const timespec at_once{0, 0};
  return wait.isOver()
             ? 0
             : wait.waited(function(polled, count, wait.isSimulated() ? &at_once : timeout, mask));
}

int select(int count, fd_set* readable, fd_set* writable, fd_set* other, timeval* timeout) {
  static auto* const function = shim::real(&::select, "select");
  const DescriptorWait wait = shim::waitOnSelect("select()", {count, {readable, writable, other}},
                                                 shim::of(timeout), MOVE_BASE_ABSTRACT_CALLER);
  timeval at_once{0, 0};
  return wait.isOver() ? 0
                       : wait.waited(function(count, readable, writable, other,
                                              wait.isSimulated() ? &at_once : timeout));
}

int pselect(int count, fd_set* readable, fd_set* writable, fd_set* other, const timespec* timeout,
            const sigset_t* mask) {
  static auto* const function = shim::real(&::pselect, "pselect");
  const DescriptorWait wait = shim::waitOnSelect("pselect()", {count, {readable, writable, other}},
                                                 shim::of(timeout), MOVE_BASE_ABSTRACT_CALLER);
  const timespec at_once{0, 0};
  return wait.isOver() ? 0
                       : wait.waited(function(count, readable, writable, other,
                                              wait.isSimulated() ? &at_once : timeout, mask));
}

int epoll_wait(int set, epoll_event* events, int count, int timeout) {
  static auto* const function = shim::real(&::epoll_wait, "epoll_wait");
  const DescriptorWait wait = shim::waitOnSet("epoll_wait()", set, shim::ofMilliseconds(timeout),
                                              MOVE_BASE_ABSTRACT_CALLER);
  return wait.waited(function(set, events, count, wait.isSimulated() ? 0 : timeout));
}

int epoll_pwait(int set, epoll_event* events, int count, int timeout, const sigset_t* mask) {
  static auto* const function = shim::real(&::epoll_pwait, "epoll_pwait");
  const DescriptorWait wait = shim::waitOnSet("epoll_pwait()", set, shim::ofMilliseconds(timeout),
                                              MOVE_BASE_ABSTRACT_CALLER);
  return wait.waited(function(set, events, count, wait.isSimulated() ? 0 : timeout, mask));
}

int epoll_ctl(int set, int operation, int descriptor, epoll_event* event) noexcept {
  static auto* const function = shim::real(&::epoll_ctl, "epoll_ctl");
  const int result = function(set, operation, descriptor, event);
  if (result != 0 || shim::Turn::startsInternal() || operation == EPOLL_CTL_MOD) {
    return result;
  }
  const shim::WaitedFor what = shim::lookAt(descriptor);
  const shim::Inside inside;
  const shim::Lock lock(shim::sets().mutex);
  if (operation == EPOLL_CTL_ADD) {
    shim::sets().members[set][descriptor] = what;
  } else {
    shim::sets().members[set].erase(descriptor);
  }
  return result;
}

int epoll_create(int size) noexcept {
  static auto* const function = shim::real(&::epoll_create, "epoll_create");
  return shim::emptySet(function(size));
}

int epoll_create1(int flags) noexcept {
  static auto* const function = shim::real(&::epoll_create1, "epoll_create1");
  return shim::emptySet(function(flags));
}

}  // extern "C"
#pragma GCC visibility pop
