// The wall clock by which limits count: it stands while somebody looks at the run in a debugger.
#pragma once

#include <algorithm>
#include <optional>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

/**
 * @brief Wall time without the time for which somebody looked. So each limit that was set before is
 * moved by as long as that took. Instants and durations are in ns.
 */
class LimitsClock {
 public:
  explicit LimitsClock(Nanoseconds wall) : wall_(wall) {}

  /** @brief Let it stand, or go on, from the latest instant on. */
  void stand(bool stands) {
    if (!stands && since_) {
      stood_ += wall_ - *since_;
    }
    since_ = stands ? std::make_optional(since_.value_or(wall_)) : std::nullopt;
  }
  bool stands() const { return since_.has_value(); }
  /** @brief Note the present instant of the wall clock. */
  void setWall(Nanoseconds wall) { wall_ = std::max(wall_, wall); }
  Nanoseconds wall() const { return wall_; }
  Nanoseconds now() const { return since_.value_or(wall_) - stood_; }
  /** @return the wall instant of @p due, an instant of this clock; kNever if it stands before. */
  Nanoseconds wallOf(Nanoseconds due) const {
    return due > now() && since_ ? kNever : addSaturated(due, stood_);
  }

 private:
  Nanoseconds wall_;
  Nanoseconds stood_ = 0;
  std::optional<Nanoseconds> since_;  // wall; nothing: it goes
};

}  // namespace move_base_abstract
