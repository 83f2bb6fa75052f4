// A participant's timer: periodic on an exact grid, or once.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_TIMER_STATE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_TIMER_STATE_H

#include <ros/forwards.h>

#include <cstdint>
#include <functional>
#include <memory>

#include "clock/scaled_clock.h"

namespace move_base_abstract::lockstep::internal {

class Core;

class TimerState : public std::enable_shared_from_this<TimerState> {
 public:
  using Callback = std::function<void(const ros::TimerEvent&)>;

  TimerState(const std::shared_ptr<Core>& core, Nanoseconds period, Callback callback,
             bool oneshot);
  ~TimerState();
  TimerState(const TimerState&) = delete;
  TimerState& operator=(const TimerState&) = delete;

  void start();
  void stop();
  bool isRunning() const { return is_running_; }
  void fire();

 private:
  friend class Core;
  std::weak_ptr<Core> core_;
  std::uint64_t number_;  // order of creation
  Nanoseconds period_;
  Nanoseconds due_ = kNever;
  Nanoseconds last_due_ = 0;
  Nanoseconds last_fired_ = 0;
  bool oneshot_;
  bool is_running_ = false;
  Callback callback_;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_TIMER_STATE_H
