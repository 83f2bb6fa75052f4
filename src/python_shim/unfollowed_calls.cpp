// Calls of libraries that cannot be followed, of which each is noted. No ROS.
#include <sys/timerfd.h>
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

void tellTimer(const char* /*name*/, const void* caller) { tellUse(What::kWakes, caller); }

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

int timerfd_create(int clock, int flags) {
  static native::Real<int(int, int)> function("timerfd_create");
  native::tellUse(native::What::kWakes, MOVE_BASE_ABSTRACT_CALLER);
  return function(clock, flags);
}

}  // extern "C"
#pragma GCC visibility pop
