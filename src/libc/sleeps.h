// The sleeps of libc, for a preloaded library. Its one source that includes this has `policy`, a
// namespace with
//   int sleepFor(const timespec& request, timespec* rest, const void* caller);
// which returns as nanosleep() does. No ROS.
#include <time.h>
#include <unistd.h>

#include "instants.h"
#include "looked_up.h"

#pragma GCC visibility push(default)
extern "C" {

int nanosleep(const timespec* request, timespec* rest) {
  return policy::sleepFor(*request, rest, MOVE_BASE_ABSTRACT_CALLER);
}

int usleep(useconds_t microseconds) {
  const auto duration = microseconds * move_base_abstract::shim::kMicrosecond;
  return policy::sleepFor(move_base_abstract::shim::toTimespec(duration), nullptr,
                          MOVE_BASE_ABSTRACT_CALLER);
}

unsigned sleep(unsigned seconds) {
  timespec rest{};
  const int result = policy::sleepFor({seconds, 0}, &rest, MOVE_BASE_ABSTRACT_CALLER);
  return result == 0 ? 0 : static_cast<unsigned>(rest.tv_sec);
}

}  // extern "C"
#pragma GCC visibility pop
