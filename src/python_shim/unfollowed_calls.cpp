// Calls of libraries that cannot be followed, of which each is noted. No ROS.
#include <signal.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "notices.h"
#include "real.h"
#include "run.h"

namespace move_base_abstract::native {
namespace {

constexpr What kTimes = What::kTimes;
constexpr What kUsage = What::kUsage;
constexpr What kLoad = What::kLoad;
constexpr What kSystem = What::kSystem;

void tellUse(What what, const void* caller) {
  if (sees(caller) != Sees::kMachine) {
    notice(what, caller);
  }
}

/** @brief The start of a process. */
class Start {
 public:
  Start(const char* /*name*/, const void* caller) { tellUse(What::kProcess, caller); }
  void goOnIn(pid_t /*process*/) const {}
};

}  // namespace
}  // namespace move_base_abstract::native

namespace native = move_base_abstract::native;
namespace policy = native;
#include "libc/unfollowed_calls.h"

#pragma GCC visibility push(default)
extern "C" {

pid_t getpid() {
  static native::Real<pid_t()> function("getpid");
  native::tellUse(native::What::kNumber, MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

// ---- timers of the kernel --------------------------------------------------------------------

int timerfd_create(int clock, int flags) {
  static native::Real<int(int, int)> function("timerfd_create");
  native::tellUse(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, flags);
}

int timer_create(clockid_t clock, sigevent* event, timer_t* timer) {
  static native::Real<int(clockid_t, sigevent*, timer_t*)> function("timer_create");
  native::tellUse(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, event, timer);
}

int setitimer(__itimer_which_t which, const itimerval* value, itimerval* old) {
  static native::Real<int(__itimer_which_t, const itimerval*, itimerval*)> function("setitimer");
  native::tellUse(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(which, value, old);
}

unsigned alarm(unsigned seconds) {
  static native::Real<unsigned(unsigned)> function("alarm");
  native::tellUse(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(seconds);
}

useconds_t ualarm(useconds_t value, useconds_t interval) {
  static native::Real<useconds_t(useconds_t, useconds_t)> function("ualarm");
  native::tellUse(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(value, interval);
}

}  // extern "C"
#pragma GCC visibility pop
