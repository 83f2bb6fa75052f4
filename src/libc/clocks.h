// The clocks of libc, for a preloaded library. Its one source that includes this has `policy`, a
// namespace with Real<Function> and
//   bool read(clockid_t, Nanoseconds step, const void* caller, Nanoseconds* time);
// which returns false if the caller sees the machine's clock. No ROS.
#include <sys/time.h>
#include <sys/timeb.h>
#include <time.h>

#include "instants.h"
#include "looked_up.h"

#pragma GCC visibility push(default)
extern "C" {

int clock_gettime(clockid_t clock, timespec* time) {
  move_base_abstract::Nanoseconds now = 0;
  if (!policy::read(clock, 1, MOVE_BASE_ABSTRACT_CALLER, &now)) {
    return policy::real_gettime(clock, time);
  }
  *time = move_base_abstract::shim::toTimespec(now);
  return 0;
}

int timespec_get(timespec* time, int base) {
  static policy::Real<int(timespec*, int)> function("timespec_get");
  move_base_abstract::Nanoseconds now = 0;
  if (base != TIME_UTC || !policy::read(CLOCK_REALTIME, 1, MOVE_BASE_ABSTRACT_CALLER, &now)) {
    return function(time, base);
  }
  *time = move_base_abstract::shim::toTimespec(now);
  return base;
}

int gettimeofday(timeval* time, void* zone) {
  static policy::Real<int(timeval*, void*)> function("gettimeofday");
  constexpr auto kMicrosecond = move_base_abstract::shim::kMicrosecond;
  move_base_abstract::Nanoseconds now = 0;
  if (!policy::read(CLOCK_REALTIME, kMicrosecond, MOVE_BASE_ABSTRACT_CALLER, &now)) {
    return function(time, zone);
  }
  const timespec whole = move_base_abstract::shim::toTimespec(now);
  *time = {whole.tv_sec, whole.tv_nsec / kMicrosecond};
  return 0;
}

time_t time(time_t* result) {
  static policy::Real<time_t(time_t*)> function("time");
  move_base_abstract::Nanoseconds now = 0;
  if (!policy::read(CLOCK_REALTIME, 1, MOVE_BASE_ABSTRACT_CALLER, &now)) {
    return function(result);
  }
  const time_t seconds = now / move_base_abstract::shim::kSecond;
  if (result != nullptr) {
    *result = seconds;
  }
  return seconds;
}

int ftime(timeb* result) {
  static policy::Real<int(timeb*)> function("ftime");
  move_base_abstract::Nanoseconds now = 0;
  if (!policy::read(CLOCK_REALTIME, 1, MOVE_BASE_ABSTRACT_CALLER, &now)) {
    return function(result);
  }
  const timespec whole = move_base_abstract::shim::toTimespec(now);
  constexpr long kMillisecond = 1'000'000;
  *result = {whole.tv_sec, static_cast<unsigned short>(whole.tv_nsec / kMillisecond), 0, 0};
  return 0;
}

clock_t clock() {
  static policy::Real<clock_t()> function("clock");
  move_base_abstract::Nanoseconds now = 0;
  if (!policy::read(CLOCK_PROCESS_CPUTIME_ID, 1, MOVE_BASE_ABSTRACT_CALLER, &now)) {
    return function();
  }
  return now / (move_base_abstract::shim::kSecond / CLOCKS_PER_SEC);
}

}  // extern "C"
#pragma GCC visibility pop
