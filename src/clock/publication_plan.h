// Decides when /clock is due and with which time. No ROS, no clock of its own.
#pragma once

#include <algorithm>

#include "scaled_clock.h"

namespace move_base_abstract {

/**
 * @brief Plans the messages on /clock by three rules. A new time is due when it is finest_step
 * ahead of the last one, or when time has come to a stand. The last time is repeated when nothing
 * was sent for repeat_gap. Nothing is sent sooner than min_gap after the last message.
 */
class PublicationPlan {
 public:
  /** @param finest_step [ns, simulated]  @param min_gap, repeat_gap [ns, wall]; all > 0 */
  PublicationPlan(Nanoseconds finest_step, Nanoseconds min_gap, Nanoseconds repeat_gap)
      : finest_step_(finest_step), min_gap_(min_gap), repeat_gap_(repeat_gap) {}

  /** @return the wall instant [ns] at which the next message is due; it may lie in the past. */
  Nanoseconds due(const ScaledClock& clock) const {
    if (!published_) {
      return clock.wall();
    }
    const Nanoseconds earliest = addSaturated(last_wall_, min_gap_);
    const Nanoseconds repeat = addSaturated(last_wall_, repeat_gap_);
    if (isNews(clock)) {
      return earliest;
    }
    return std::max(earliest,
                    std::min(repeat, clock.wallWhen(addSaturated(last_time_, finest_step_))));
  }

  /** @return the simulated time [ns] to send now, and note that it was sent. */
  Nanoseconds take(const ScaledClock& clock) {
    if (!published_ || isNews(clock)) {
      last_time_ = clock.now();
    }
    published_ = true;
    last_wall_ = clock.wall();
    return last_time_;
  }

 private:
  bool isNews(const ScaledClock& clock) const {
    const Nanoseconds ahead = clock.now() - last_time_;
    return ahead >= finest_step_ || (clock.rate() == 0 && ahead > 0);
  }

  Nanoseconds finest_step_;
  Nanoseconds min_gap_;
  Nanoseconds repeat_gap_;
  bool published_ = false;
  Nanoseconds last_wall_ = 0;
  Nanoseconds last_time_ = 0;
};

}  // namespace move_base_abstract
