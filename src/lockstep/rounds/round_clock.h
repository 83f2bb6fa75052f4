// Where a run is: its instant, and how many rounds there have been.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUND_CLOCK_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUND_CLOCK_H

#include <cstdint>
#include <functional>
#include <optional>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

/** @brief The present of a run, which its rounds move on. */
struct RoundClock {
  Nanoseconds time;  // simulated
  std::uint32_t microstep = 0;
  std::optional<Nanoseconds> applied = {};  // the instant whose turns are being applied
  std::uint64_t rounds = 0;
  std::uint64_t played = 0;  // of these, those in which nobody was granted
  std::uint64_t leaps = 0;

  Nanoseconds now() const { return applied.value_or(time); }
  /** @return whether it was not there already. */
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

/** @brief What comes from outside of rounds, at instants that are known: mail under way. */
struct OutsideArrivals {
  std::function<Nanoseconds()> next_due;  // kNever: nothing; asked when a round is over
  std::function<void()> arrive;           // post all that is due by now()

  Nanoseconds next() const { return next_due ? next_due() : kNever; }
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUND_CLOCK_H
