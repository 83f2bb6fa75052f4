// The present of a run: its instant and the number of rounds so far.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

/** @brief The present of a run. Its rounds move it on. */
struct RoundClock {
  Nanoseconds time;  // simulated
  std::uint32_t microstep = 0;
  std::optional<Nanoseconds> applied = {};  // the instant whose turns are being applied
  std::uint64_t rounds = 0;
  std::uint64_t played = 0;  // of these, the rounds without a grant
  std::uint64_t leaps = 0;

  Nanoseconds now() const { return applied.value_or(time); }
  /** @brief Go on to @p to. @return whether this is another instant. */
  bool moveTo(Nanoseconds to) {
    if (to == time) {
      return false;
    }
    time = to;
    microstep = 0;
    ++leaps;
    return true;
  }
};

/** @brief Mail under way, which arrives at known instants, and not from an action of a round. */
struct OutsideArrivals {
  std::function<Nanoseconds()> next_due;  // kNever: nothing; called when a round is over
  std::function<void()> arrive;           // posts all mail that is due by now()

  Nanoseconds next() const { return next_due ? next_due() : kNever; }
};

}  // namespace move_base_abstract
