// Calls of libraries that cannot be followed, of which each is noted. No ROS.
#include <pthread.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "callers.h"
#include "libc/affinity.h"
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

void tellTimer(const char* /*name*/, const void* caller) { tellUse(What::kWakes, caller); }

/** @brief The start of a process. */
class Start {
 public:
  Start(const char* /*name*/, const void* caller) { tellUse(What::kProcess, caller); }
  void goOnIn(pid_t /*process*/) const {}
};

}  // namespace
}  // namespace move_base_abstract::native

#include "libc/unfollowed_calls.h"

#pragma GCC visibility push(default)
extern "C" {

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*main)(void*),
                   void* argument) {
  static native::Real<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)> function(
      "pthread_create");
  if (native::isWorkerPool(MOVE_BASE_ABSTRACT_CALLER)) {
    native::tellUse(native::What::kWorkers, MOVE_BASE_ABSTRACT_CALLER);
  }
  return function(thread, attributes, main, argument);
}

int sched_getaffinity(pid_t thread, size_t size, cpu_set_t* cores) {
  static native::Real<int(pid_t, size_t, cpu_set_t*)> function("sched_getaffinity");
  const int result = function(thread, size, cores);
  const void* const caller = MOVE_BASE_ABSTRACT_CALLER;
  if (result == 0 && shim::isTbb(caller) && native::sees(caller) != native::Sees::kMachine) {
    shim::keepFirst(size, cores);
  }
  return result;
}

pid_t getpid() {
  static native::Real<pid_t()> function("getpid");
  native::tellUse(native::What::kNumber, MOVE_BASE_ABSTRACT_CALLER);
  return function();
}

int timerfd_create(int clock, int flags) {
  static native::Real<int(int, int)> function("timerfd_create");
  native::tellUse(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, flags);
}

}  // extern "C"
#pragma GCC visibility pop
