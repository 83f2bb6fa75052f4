// ros::Timer: due exactly when the simulated clock says so, without a thread that polls it.
#include <ros/init.h>
#include <ros/steady_timer.h>
#include <ros/timer.h>
#include <ros/timer_manager.h>
#include <ros/wall_timer.h>

#include <algorithm>

#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/node.h"
#include "roscpp_shim/turn.h"

namespace shim = move_base_abstract::shim;

namespace ros {

// As roscpp's own, but for the thread: it only says where the timers are, and ends. The rest of the
// manager (periods, what a late callback means, pending callbacks) is used as it is.
template <>
__attribute__((visibility("default"))) void TimerManager<Time, Duration, TimerEvent>::threadFunc() {
  if (!shim::takesPart()) {
    using ThreadFunction = void(TimerManager*);
    static ThreadFunction* const function = shim::real<ThreadFunction>(
        "_ZN3ros12TimerManagerINS_4TimeENS_8DurationENS_10TimerEventEE10threadFuncEv");
    function(this);
    return;
  }
  shim::SimulatedTimers timers;
  timers.next = [this] {
    const boost::mutex::scoped_lock lock(timers_mutex_);
    const boost::mutex::scoped_lock waiting_lock(waiting_mutex_);
    const TimerInfoPtr info = waiting_.empty() ? nullptr : findTimer(waiting_.front());
    const Time never(INT_MAX, 999999999);  // what the manager writes for a timer that is over
    return info && info->next_expected < never
               ? static_cast<std::int64_t>(info->next_expected.toNSec())
               : move_base_abstract::kNever;
  };
  timers.fire = [this] {
    const boost::mutex::scoped_lock lock(timers_mutex_);
    const boost::mutex::scoped_lock waiting_lock(waiting_mutex_);
    const Time now = Time::now();
    while (!waiting_.empty()) {
      const TimerInfoPtr info = findTimer(waiting_.front());
      if (!info || info->next_expected > now) {
        break;
      }
      const CallbackInterfacePtr callback(
          boost::make_shared<TimerQueueCallback>(this, info, info->last_expected, info->last_real,
                                                 info->next_expected, info->last_expired, now));
      info->callback_queue->addCallback(callback, reinterpret_cast<std::uint64_t>(info.get()));
      waiting_.pop_front();
    }
  };
  shim::node().setTimers(std::move(timers));
}

void Timer::Impl::start() {
  using Start = void(Timer::Impl*);
  static Start* const function = shim::real<Start>("_ZN3ros5Timer4Impl5startEv");
  const bool is_app = shim::turn().enter();
  const shim::Inside inside;
  function(this);
  while (is_app && shim::takesPart() && !shim::node().hasTimers()) {
    WallDuration(0.0001).sleep();  // once: the manager's thread is about to say where they are
  }
}

// The threads of these are roscpp's own.

void WallTimer::Impl::start() {
  using Start = void(WallTimer::Impl*);
  static Start* const function = shim::real<Start>("_ZN3ros9WallTimer4Impl5startEv");
  const shim::Inside inside;
  function(this);
}

void SteadyTimer::Impl::start() {
  using Start = void(SteadyTimer::Impl*);
  static Start* const function = shim::real<Start>("_ZN3ros11SteadyTimer4Impl5startEv");
  const shim::Inside inside;
  function(this);
}

}  // namespace ros
