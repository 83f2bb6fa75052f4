// Timers of roscpp. They fire exactly when they are due by the clocks of the run; no thread polls.
#include <ros/init.h>
#include <ros/internal_timer_manager.h>
#include <ros/steady_timer.h>
#include <ros/timer.h>
#include <ros/timer_manager.h>
#include <ros/wall_timer.h>

#include <algorithm>
#include <list>

#include "roscpp_shim/clocks.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

/** @brief The clock of each kind of timers, as the program sees it. */
template <class Instant>
struct TimerClock;

template <>
struct TimerClock<ros::Time> {
  static constexpr TimerKind kKind = kRosTimers;
  static Nanoseconds now() { return node().now(); }
};

template <>
struct TimerClock<ros::SteadyTime> {
  static constexpr TimerKind kKind = kSteadyTimers;
  static Nanoseconds now() { return seenTime(CLOCK_MONOTONIC); }
};

template <>
struct TimerClock<ros::WallTime> {
  static constexpr TimerKind kKind = kWallTimers;
  static Nanoseconds now() { return seenTime(CLOCK_REALTIME); }
};

/** @brief The private members of a timer manager. */
template <class Instant, class Find, class MakeCallback>
struct Opened {
  boost::mutex& timers_mutex;
  boost::mutex& waiting_mutex;
  std::list<std::int32_t>& waiting;  // handles; the first one is due first
  Find find;
  MakeCallback make_callback;

  using Clock = TimerClock<Instant>;

  /** @return when the first timer is due, simulated [ns]; now, if it is late. */
  Nanoseconds next() const {
    const boost::mutex::scoped_lock lock(timers_mutex);
    const boost::mutex::scoped_lock waiting_lock(waiting_mutex);
    const auto info = waiting.empty() ? nullptr : find(waiting.front());
    const Instant never(INT_MAX, 999999999);  // what the manager writes for a timer that is over
    if (!info || info->next_expected >= never) {
      return kNever;
    }
    const auto due = static_cast<Nanoseconds>(info->next_expected.toNSec());
    return node().now() + std::max<Nanoseconds>(due - Clock::now(), 0);
  }

  /** @brief Put the callbacks of due timers into their queues. */
  void fire() const {
    const boost::mutex::scoped_lock lock(timers_mutex);
    const boost::mutex::scoped_lock waiting_lock(waiting_mutex);
    Instant now;
    now.fromNSec(static_cast<std::uint64_t>(Clock::now()));
    while (!waiting.empty()) {
      const auto info = find(waiting.front());
      if (!info || info->next_expected > now) {
        break;
      }
      info->callback_queue->addCallback(make_callback(info, now),
                                        reinterpret_cast<std::uint64_t>(info.get()));
      waiting.pop_front();
    }
  }
};

/**
 * @brief Replaces the function of a manager's thread: gives the node access to its timers.
 *
 * The rest of the manager (periods, late callbacks, pending callbacks) is used as it is.
 */
template <class Instant, class Find, class MakeCallback>
void serve(boost::mutex& timers_mutex, boost::mutex& waiting_mutex,
           std::list<std::int32_t>& waiting, Find find, MakeCallback make_callback) {
  const Opened<Instant, Find, MakeCallback> opened{timers_mutex, waiting_mutex, waiting, find,
                                                   make_callback};
  SimulatedTimers timers;
  timers.next = [opened] { return opened.next(); };
  timers.fire = [opened] { opened.fire(); };
  node().setTimers(TimerClock<Instant>::kKind, std::move(timers));
}

/**
 * @brief Start a timer, by roscpp's own @p start.
 *
 * The first timer of its kind starts the manager's thread, which counts as roscpp's own. This waits
 * until that thread has called serve().
 */
template <class Impl>
void startTimer(void (*start)(Impl*), Impl* timer, TimerKind kind) {
  const bool is_app = turn().enter();
  {
    const StartsInternal starts;
    const Beside beside;
    start(timer);
  }
  while (is_app && takesPart() && !node().hasTimers(kind)) {
    const Inside inside;
    ros::WallDuration(0.0001).sleep();
  }
}

}  // namespace
}  // namespace move_base_abstract::shim

// Members of a class template can be replaced only one by one.
#define MOVE_BASE_ABSTRACT_SERVE(Instant)                                          \
  shim::serve<Instant>(                                                            \
      timers_mutex_, waiting_mutex_, waiting_,                                     \
      [this](std::int32_t handle) { return findTimer(handle); },                   \
      [this](const TimerInfoPtr& info, const Instant& now) {                       \
        return CallbackInterfacePtr(boost::make_shared<TimerQueueCallback>(        \
            this, info, info->last_expected, info->last_real, info->next_expected, \
            info->last_expired, now));                                             \
      })

namespace ros {

template <>
__attribute__((visibility("default"))) void TimerManager<Time, Duration, TimerEvent>::threadFunc() {
  static auto* const function = shim::real<void(TimerManager*)>(
      "ros::TimerManager<ros::Time, ros::Duration, ros::TimerEvent>::threadFunc");
  if (!shim::takesPart()) {
    function(this);
    return;
  }
  MOVE_BASE_ABSTRACT_SERVE(Time);
}

template <>
__attribute__((visibility("default"))) void
TimerManager<SteadyTime, WallDuration, SteadyTimerEvent>::threadFunc() {
  static auto* const function = shim::real(
      &TimerManager::threadFunc,
      "ros::TimerManager<ros::SteadyTime, ros::WallDuration, ros::SteadyTimerEvent>::threadFunc");
  if (!shim::takesPart() || this == getInternalTimerManager().get()) {
    function(this);
    return;
  }
  MOVE_BASE_ABSTRACT_SERVE(SteadyTime);
}

template <>
__attribute__((visibility("default"))) void
TimerManager<WallTime, WallDuration, WallTimerEvent>::threadFunc() {
  static auto* const function = shim::real(
      &TimerManager::threadFunc,
      "ros::TimerManager<ros::WallTime, ros::WallDuration, ros::WallTimerEvent>::threadFunc");
  if (!shim::takesPart()) {
    function(this);
    return;
  }
  MOVE_BASE_ABSTRACT_SERVE(WallTime);
}

void Timer::Impl::start() {
  static auto* const function = shim::real(&Timer::Impl::start, "ros::Timer::Impl::start");
  shim::startTimer(function, this, shim::kRosTimers);
}

void WallTimer::Impl::start() {
  static auto* const function = shim::real(&WallTimer::Impl::start, "ros::WallTimer::Impl::start");
  shim::startTimer(function, this, shim::kWallTimers);
}

void SteadyTimer::Impl::start() {
  static auto* const function =
      shim::real(&SteadyTimer::Impl::start, "ros::SteadyTimer::Impl::start");
  shim::startTimer(function, this, shim::kSteadyTimers);
}

}  // namespace ros
