// The thread of a participant: the work between its grants and its reports.
#include "core.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>
#include <ros/time.h>

#include <algorithm>
#include <atomic>

#include "detach_from_clock.h"

namespace move_base_abstract::lockstep::internal {
namespace {

std::atomic<bool> exists{false};  // two cores would both set ros::Time

/**
 * Runs when the library is loaded, because a node handle may start ROS before the Participant
 * exists.
 */
__attribute__((constructor)) void beforeRos() { Membership::beforeRos(); }

}  // namespace

Core::Core(const Options& options) {
  if (exists) {
    throw Error("lockstep: node " + ros::this_node::getName() +
                " has a Participant already; one per process is allowed");
  }
  membership_.present(readPresence(options.rank));
  exists = true;
}

Core::~Core() { exists = false; }

// ---- joining and leaving ---------------------------------------------------------------------

void Core::join() {
  if (!membership_.connect()) {
    throw Error("lockstep: node " + name() +
                ": ROS was shut down before the time master was there");
  }
  detachFromClock();
  membership_.join();
  if (!membership_.hasTurn()) {
    throw Error("lockstep: node " + name() +
                " did not get to its first grant: " + membership_.endReason());
  }
}

void Core::leave(const std::string& reason) {
  if (membership_.hasTurn() && !reason.empty()) {
    ROS_INFO("lockstep: %s leaves: %s", name().c_str(), reason.c_str());
  }
  membership_.leave(reason);
  membership_.finish();
  mail_.clear();
  outside_.clear();
}

void Core::onEnd() {
  mail_.clear();
  outside_.clear();
  if (ros::ok()) {
    ros::shutdown();
  }
}

void Core::endIfRosHas() {
  constexpr const char* kReason = "ROS was shut down";
  if (!ros::ok() && membership_.leave(kReason, Membership::State::kOver)) {
    membership_.finish();
    mail_.clear();
    outside_.clear();
  }
}

void Core::check(const char* what) const {
  if (std::this_thread::get_id() != thread_) {
    throw Error("lockstep: " + std::string(what) + " of " + name() +
                " was called from another thread; only the one that made the Participant may");
  }
  if (membership_.state() == Membership::State::kLeft) {
    throw Error("lockstep: " + std::string(what) + " of " + name() +
                " was called after it has left");
  }
}

void Core::checkOutsideCallback(const char* what) const {
  check(what);
  if (is_in_callback_) {
    throw Error("lockstep: " + std::string(what) + " of " + name() +
                " was called in a callback; only sleep and service calls may");
  }
}

// ---- rounds ----------------------------------------------------------------------------------

Core::Woken Core::wait(Nanoseconds until, Callbacks callbacks, const std::function<bool()>& done,
                       const std::string& what) {
  const bool runs = callbacks == Callbacks::kRun && !is_in_callback_;
  while (true) {
    if (runs) {
      runCallbacks();
    }
    if (done && done()) {
      return Woken::kDone;
    }
    endIfRosHas();
    if (!isActive()) {
      return Woken::kOver;
    }
    if (now() >= until) {
      return Woken::kTime;
    }
    const std::string waits = until == kNever ? what : "";
    membership_.exchange({nextDue(until, runs ? Callbacks::kRun : Callbacks::kWait),
                          waits.empty() ? 0U : 1U, waits});
  }
}

bool Core::giveWay() {
  runCallbacks();
  if (isActive()) {
    membership_.exchange({now(), 0, ""});
    runCallbacks();
  }
  return isActive();
}

bool Core::hasInput() {
  takeOutside();
  return !outside_.empty() || !user_queue_->empty();
}

bool Core::waitsOn() {
  endIfRosHas();
  return true;
}

void Core::setTime(Nanoseconds now) {
  ros::Time::setNow(ros::Time().fromNSec(static_cast<std::uint64_t>(now)));
}

void Core::onGranted() {
  takeOutside();
  enterOutside();
}

// ---- callbacks -------------------------------------------------------------------------------

void Core::runCallbacks() {
  while (isActive()) {
    if (!mail_.empty()) {
      const auto callback = std::move(mail_.front());
      mail_.pop_front();
      runOne(callback);
    } else if (TimerState* const timer = dueTimer()) {
      const auto guard = timer->shared_from_this();  // the callback may drop the last handle
      runOne([&guard] { guard->fire(); });
    } else {
      return;
    }
  }
}

void Core::runOne(const std::function<void()>& callback) {
  struct Guard {
    explicit Guard(bool* entered) : flag(entered) { *flag = true; }
    ~Guard() { *flag = false; }
    bool* flag;
  };
  const Guard guard(&is_in_callback_);
  callback();
}

TimerState* Core::dueTimer() const {
  if (timers_.empty() || timers_.begin()->first.first > now()) {
    return nullptr;
  }
  return timers_.begin()->second;
}

Nanoseconds Core::nextDue(Nanoseconds until, Callbacks callbacks) const {
  if (callbacks == Callbacks::kWait || timers_.empty()) {
    return until;
  }
  return std::min(until, timers_.begin()->first.first);
}

void Core::schedule(TimerState& timer) { timers_[{timer.due_, timer.number_}] = &timer; }
void Core::unschedule(TimerState& timer) { timers_.erase({timer.due_, timer.number_}); }

}  // namespace move_base_abstract::lockstep::internal
