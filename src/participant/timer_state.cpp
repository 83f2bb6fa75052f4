#include "timer_state.h"

#include <algorithm>
#include <utility>

#include "core.h"

namespace move_base_abstract::lockstep::internal {

TimerState::TimerState(const std::shared_ptr<Core>& core, Nanoseconds period, Callback callback,
                       bool oneshot)
    : core_(core),
      number_(core->nextTimerNumber()),
      period_(period),
      oneshot_(oneshot),
      callback_(std::move(callback)) {}

TimerState::~TimerState() { stop(); }

void TimerState::start() {
  const auto core = core_.lock();
  if (core && !is_running_) {
    last_due_ = core->now();
    last_fired_ = core->now();
    due_ = core->now() + period_;
    is_running_ = true;
    core->schedule(*this);
  }
}

void TimerState::stop() {
  const auto core = core_.lock();
  if (core && is_running_) {
    core->unschedule(*this);
  }
  is_running_ = false;
}

void TimerState::fire() {
  const auto core = core_.lock();
  core->unschedule(*this);
  const auto toRos = [](Nanoseconds time) {
    return ros::Time().fromNSec(static_cast<std::uint64_t>(time));
  };
  ros::TimerEvent event;
  event.last_expected = toRos(last_due_);
  event.last_real = toRos(last_fired_);
  event.current_expected = toRos(due_);
  event.current_real = toRos(core->now());
  last_due_ = due_;
  last_fired_ = core->now();
  if (oneshot_) {
    is_running_ = false;
  } else {
    // Before the callback, which may stop the timer. Calls that a sleeping callback has missed
    // become one.
    due_ += std::max<Nanoseconds>((core->now() - due_) / period_, 0) * period_ + period_;
    core->schedule(*this);
  }
  const Callback callback = callback_;
  callback(event);
}

}  // namespace move_base_abstract::lockstep::internal
