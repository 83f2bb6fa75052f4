// No ROS.
#include "clocks.h"

#include "callers.h"
#include "notices.h"
#include "real.h"

namespace move_base_abstract::native {
namespace {

using shim::kClockReads;
using shim::kClockReadsAgain;
using shim::kMicrosecond;
using shim::kPassage;

constexpr Nanoseconds kPause = 50'000'000;  // wall, between two looks at the processor's time

Real<int(clockid_t, timespec*)> real_gettime("clock_gettime");
/** Whether the clocks go on as libraries compute, because one of them has computed for too long. */
std::atomic<bool> go_on_computing{false};

/** @brief A thread's looks at clocks, and the time that it has computed meanwhile. */
struct Looking {
  Nanoseconds at;        // simulated time of the first of these looks
  unsigned looks;        // number of looks at that time, less than kClockReads
  Nanoseconds computed;  // the processor's time from which computing is counted
  Nanoseconds checked;   // wall time of the last look at the processor's time
  Nanoseconds slept;     // how far the clocks of a stray thread have gone on by themselves
};
thread_local Looking t_looking __attribute__((tls_model("initial-exec"))) = {-1, 0, 0, 0, 0};

/** A thread that computes for long between its waits may do so until a clock shows some time. So
 * from then on the clocks go on as it computes. That is noted, since it differs in each run. */
void countComputing(Looking* me, Sees whose, const void* caller) {
  const Nanoseconds wall = machineTime(CLOCK_MONOTONIC_COARSE);
  if (wall - me->checked < kPause) {
    return;
  }
  me->checked = wall;
  const Nanoseconds now = machineTime(CLOCK_THREAD_CPUTIME_ID);
  if (go_on_computing) {
    goOn(now - me->computed, whose);
    me->computed = now;
  } else if (now - me->computed >= cell(kPatience)) {
    notice(What::kComputes, caller);
    go_on_computing = true;
    me->computed = now;
  }
}

/** @brief Count a look at a clock. After many looks the clock goes on, for a loop that waits so. */
void countLook(Sees whose, const void* caller) {
  Looking* const me = &t_looking;
  if (me->at != cell(kNow)) {
    me->at = cell(kNow);
    me->looks = 0;
    me->computed = machineTime(CLOCK_THREAD_CPUTIME_ID);
    me->checked = machineTime(CLOCK_MONOTONIC_COARSE);
  }
  countComputing(me, whose, caller);
  if (++me->looks < kClockReads) {
    return;
  }
  me->looks = kClockReads - kClockReadsAgain;
  if (whose == Sees::kRun && mayCall()) {
    sleepInPython(-kPassage);
    me->at = cell(kNow);  // its own looks have let time go on; that is not a wait
  } else {
    goOn(kPassage, whose);
  }
}

/** @brief Read a clock for a library, in whole steps of @p step [ns].
 * @return false if the library sees the machine's clock. */
bool read(clockid_t clock, Nanoseconds step, const void* caller, Nanoseconds* time) {
  const Sees whose = sees(caller);
  if (whose == Sees::kMachine) {
    return false;
  }
  if (whose == Sees::kStray && !isWorkerPool(caller)) {
    notice(What::kStrayClock, caller);
  }
  countLook(whose, caller);
  const Nanoseconds now = seenTime(clock, whose);
  *time = now - now % step;
  return true;
}

}  // namespace

Nanoseconds machineTime(clockid_t clock) {
  timespec now{};
  real_gettime(clock, &now);
  return shim::toNs(now);
}

Nanoseconds seenTime(clockid_t clock, Sees whose) {
  const Nanoseconds start = cell(shim::isOfProcessor(clock)  ? kProcessor
                                 : shim::indexOf(clock) == 0 ? kDate
                                                             : kUptime);
  return start + cell(kNow) + cell(kSlept) + (whose == Sees::kStray ? t_looking.slept : 0);
}

void goOn(Nanoseconds duration, Sees whose) {
  if (duration > 0 && whose == Sees::kRun) {
    cells[kSlept].fetch_add(duration);
  } else if (duration > 0) {
    t_looking.slept += duration;
  }
}

}  // namespace move_base_abstract::native

#include "libc/clocks.h"
