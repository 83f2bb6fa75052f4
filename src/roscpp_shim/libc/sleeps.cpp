// Sleeps by the wall clock, and sched_yield().
#include <sched.h>
#include <sys/select.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

#include "roscpp_shim/clocks.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"
#include "roscpp_shim/waits.h"

namespace move_base_abstract::shim {
namespace {

constexpr Nanoseconds kPatience = 5 * kSecond;  // wall
constexpr unsigned kNaps = 10000;               // sleeps at one instant, of any length
constexpr unsigned kYields = 100;               // in a row, after which simulated time goes on

Real<int(const timespec*, timespec*)> real_nanosleep("nanosleep");

}  // namespace

/** A thread that gives way again and again waits for something that may need time to go on. */
void giveWay(const char* call) {
  Task& me = *Turn::self();
  const unsigned yields = me.yields + 1;
  if (yields < kYields) {
    tellPassage(call);
    Wait wait;
    wait.next_round = true;
    turn().wait(std::move(wait));
  } else {
    passTime(call);
  }
  me.yields = yields;  // any other wait begins the count anew
}

int tried(int result, bool is_vain) {
  constexpr unsigned kTries = 100;
  if (is_vain && turn().holds() && ++Turn::self()->tries >= kTries) {
    const int error = errno;
    giveWay("a try to take a lock");
    errno = error;
  }
  return result;
}

void sleepWall(Nanoseconds duration) {
  Task& me = *Turn::self();
  me.has_acted = true;
  if (duration <= 0) {
    giveWay("a sleep of no length");
    return;
  }
  if (node().sleepsSimulated() || me.sleeps_simulated) {
    sleepUntil(node().now() + duration);
    return;
  }
  const bool is_same = me.slept_at == node().now();
  me.slept = is_same ? me.slept + duration : duration;
  me.naps = is_same ? me.naps + 1 : 1;
  me.slept_at = node().now();
  tellPassage("a sleep by the wall clock");
  {
    const Blocking blocking;
    const timespec request = toTimespec(duration);
    real_nanosleep(&request, nullptr);
  }
  if (me.slept < kPatience && me.naps < kNaps) {
    addSleep(duration);
    Wait wait;
    wait.next_round = true;  // after the sleep it sees all that has happened at this instant
    turn().wait(std::move(wait));
  } else {
    tell(
        "a thread sleeps by the wall clock until something happens; from here on its sleeps take "
        "simulated time (see --sleep simulated)",
        nullptr);
    me.sleeps_simulated = true;
    sleepUntil(node().now() + duration);
  }
}

namespace {

int sleepFor(const timespec& request, timespec* rest, const void* /*caller*/) {
  if (ordered()) {
    sleepWall(toNs(request));
    return 0;
  }
  const int result = real_nanosleep(&request, rest);
  if (sees() == Sees::kRun) {
    addSleep(toNs(request));
  }
  return result;
}

}  // namespace
}  // namespace move_base_abstract::shim

#include "libc/sleeps.h"

#pragma GCC visibility push(default)
extern "C" {

int clock_nanosleep(clockid_t clock, int flags, const timespec* request, timespec* rest) {
  static auto* const function = shim::real(&::clock_nanosleep, "clock_nanosleep");
  if (shim::sees() == shim::Sees::kMachine) {
    return function(clock, flags, request, rest);
  }
  const bool is_absolute = (flags & TIMER_ABSTIME) != 0;
  const std::int64_t duration =
      is_absolute ? shim::remaining(clock, *request) : shim::toNs(*request);
  if (duration <= 0) {
    return 0;
  }
  const timespec lasts = shim::toTimespec(duration);
  return nanosleep(&lasts, rest) == 0 ? 0 : errno;
}

int sched_yield() {
  static auto* const function = shim::real(&::sched_yield, "sched_yield");
  if (!shim::ordered()) {
    return function();
  }
  shim::giveWay("sched_yield()");
  return 0;
}

}  // extern "C"
#pragma GCC visibility pop
