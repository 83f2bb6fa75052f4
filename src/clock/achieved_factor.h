#pragma once

#include <algorithm>
#include <deque>

#include "scaled_clock.h"

namespace move_base_abstract {

/**
 * @brief The factor at which simulated time has gone on over about the last second of wall time; if
 * it leaps more rarely, from leap to leap.
 */
class AchievedFactor {
 public:
  /**
   * @brief Look at the clock.
   * @param held_at The speed limit that holds the next leap back, or 0: simulated time counts as
   * going on at this factor meanwhile.
   * @param moves Whether time will go on by itself; otherwise it stands still, and that counts.
   */
  void look(Nanoseconds wall, Nanoseconds time, double held_at, bool moves) {
    if (time != leap_.time) {
      leap_ = {wall, time};
    }
    const auto since = static_cast<double>(wall - leap_.wall);
    const Nanoseconds now = time + static_cast<Nanoseconds>(held_at * since);
    if (samples_.empty() ||
        (wall - samples_.back().wall >= kGap && (!moves || now > samples_.back().time))) {
      samples_.push_back({wall, now});
    }
    while (samples_.size() > 2 && samples_[1].wall <= wall - kWindow) {
      samples_.pop_front();
    }
  }

  /** @brief Return the factor, 0 before time has gone on. */
  double at(Nanoseconds wall) const {
    if (samples_.size() < 2) {
      return 0.0;
    }
    const Sample& first = samples_.front();
    const Sample& last = samples_.back();
    const Nanoseconds taken = std::max(last.wall - first.wall, wall - last.wall);
    return static_cast<double>(std::max<Nanoseconds>(last.time - first.time, 0)) /
           static_cast<double>(std::max<Nanoseconds>(taken, 1));
  }

 private:
  struct Sample {
    Nanoseconds wall;
    Nanoseconds time;
  };

  static constexpr Nanoseconds kWindow = kNanosecondsPerSecond;
  static constexpr Nanoseconds kGap = kWindow / 100;

  Sample leap_{0, 0};  // when simulated time was seen to be another one last
  std::deque<Sample> samples_;
};

}  // namespace move_base_abstract
