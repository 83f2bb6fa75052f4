#include "clocks.h"

#include <ros/time.h>

#include <atomic>
#include <cerrno>

#include "followed.h"
#include "node.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"
#include "waits.h"

namespace move_base_abstract::shim {
namespace {

constexpr Nanoseconds kEpoch =
    1'577'836'800 * kSecond;                 // 2020-01-01 UTC; each seed adds one second
constexpr Nanoseconds kSeeds = 315'360'000;  // about ten years
constexpr Nanoseconds kUptime = 3600 * kSecond;

Real<int(clockid_t, timespec*)> real_gettime("clock_gettime");

/** @brief The times that a thread has read last, perhaps cut to microseconds. Deadlines start
 * there. */
struct Readings {
  Nanoseconds last[2] = {0, 0};
};
thread_local Readings t_readings __attribute__((tls_model("initial-exec")));

std::atomic<Nanoseconds> slept{0};
std::atomic<unsigned> reads{0};  // of threads that take no turns

/** @brief Count a read. In a loop that only looks at a clock, the clock goes on after many reads.
 */
void countRead() {
  if (turn().isActive() && Turn::self() != nullptr) {
    countClockRead();
  } else if (++reads % kClockReads == 0) {
    tellPassage("a clock");
    slept += kPassage;
  }
}

/** @brief Read a clock for the program, with a resolution of @p step [ns]. @return whether the
 * program sees the run's clock; then @p time is set. */
bool read(clockid_t clock, Nanoseconds step, const void* caller, Nanoseconds* time) {
  const Sees whose = sees();
  if (whose == Sees::kMachine) {
    return false;
  }
  if (whose == Sees::kStray && !isWorkerPool(caller)) {
    tell("a clock is read in a thread that lockstep does not order", caller);
  }
  countRead();
  const Nanoseconds now = seenTime(clock);
  *time = now - now % step;
  if (!isOfProcessor(clock)) {
    t_readings.last[indexOf(clock)] = *time;
  }
  return true;
}

}  // namespace

Nanoseconds machineTime(clockid_t clock) {
  timespec now{};
  real_gettime(clock, &now);
  return toNs(now);
}

Nanoseconds remaining(clockid_t clock, const timespec& deadline) {
  const Nanoseconds now = seenTime(clock);
  const Nanoseconds last = t_readings.last[indexOf(clock)];
  return toNs(deadline) - (now - last < kMicrosecond ? last : now);
}

Nanoseconds seenTime(clockid_t clock) {
  const Nanoseconds gone = node().now() + slept;
  if (isOfProcessor(clock)) {
    return gone;
  }
  if (node().sleepsSimulated()) {
    return gone;
  }
  const Nanoseconds date = kEpoch + (seed() % kSeeds + kSeeds) % kSeeds * kSecond;
  return gone + (indexOf(clock) == 0 ? date : kUptime);
}

void addSleep(Nanoseconds duration) { slept += duration; }

MachineWait::MachineWait(clockid_t clock, const timespec* deadline) : deadline_(deadline) {
  if (deadline == nullptr || sees() == Sees::kMachine) {
    return;
  }
  lasts_ = std::max<Nanoseconds>(remaining(clock, *deadline), 0);
  translated_ = toTimespec(machineTime(clock) + lasts_);
  deadline_ = &translated_;
}

void MachineWait::timedOut() const {
  if (deadline_ == &translated_ && sees() == Sees::kRun) {
    addSleep(lasts_);
  }
}

}  // namespace move_base_abstract::shim

#include "libc/clocks.h"

namespace {

/** @return the time of a wall clock, for roscpp's own use, such as the stamps of its log, by the
 * machine. */
template <class Time>
Time readFor(const void* caller, Time (*now)()) {
  if (shim::isTimers(caller) || !shim::isRoscpps(caller)) {
    return now();
  }
  const shim::Inside inside;
  return now();
}

}  // namespace

namespace ros {

WallTime WallTime::now() {
  static auto* const function = shim::real(&WallTime::now, "ros::WallTime::now");
  return readFor(MOVE_BASE_ABSTRACT_CALLER, function);
}

SteadyTime SteadyTime::now() {
  static auto* const function = shim::real(&SteadyTime::now, "ros::SteadyTime::now");
  return readFor(MOVE_BASE_ABSTRACT_CALLER, function);
}

}  // namespace ros
