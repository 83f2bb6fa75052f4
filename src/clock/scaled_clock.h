// Simulated time as a multiple of wall time, in integers. No ROS, no clock of its own.
#pragma once

#include <cstdint>
#include <limits>

namespace move_base_abstract {

/** @brief An instant or a duration in nanoseconds, simulated or wall as its name says. */
using Nanoseconds = std::int64_t;

/** @brief A factor in billionths: 1'000'000'000 is real time. */
using FactorUnits = std::int64_t;

constexpr FactorUnits kFactorUnit = 1'000'000'000;
constexpr Nanoseconds kNanosecondsPerSecond = 1'000'000'000;

/** @brief A wall instant that never comes. */
constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();

/** @brief The end of simulated time [ns]: a ros::Duration, so a difference of times, ends there. */
constexpr Nanoseconds kLastInstant = 2'147'483'647 * kNanosecondsPerSecond;

/** @brief The sum of two instants, or kNever if the sum would overflow. @pre b >= 0 */
constexpr Nanoseconds addSaturated(Nanoseconds a, Nanoseconds b) {
  return a > kNever - b ? kNever : a + b;
}

/**
 * @brief Integrates rate x wall time without any rounding.
 *
 * The part below a nanosecond is carried on as a remainder in billionths of a nanosecond. So any
 * number of rate changes adds up to the exact sum.
 */
class ScaledClock {
 public:
  /** @brief Stand still at @p sim [ns, simulated] as of @p wall [ns]. */
  ScaledClock(Nanoseconds sim, Nanoseconds wall) : sim_(sim), wall_(wall) {}

  /** @brief Integrate up to @p wall [ns]; a wall instant before the latest changes nothing. */
  void advanceTo(Nanoseconds wall) {
    if (wall <= wall_) {
      return;
    }
    const Wide passed = static_cast<Wide>(wall) - wall_;
    const Wide total = passed * rate_ + remainder_;
    sim_ += static_cast<Nanoseconds>(total / kFactorUnit);
    remainder_ = static_cast<FactorUnits>(total % kFactorUnit);
    wall_ = wall;
  }

  /** @brief Go on to @p wall [ns] while simulated time stands still. @pre wall >= wall() */
  void skipTo(Nanoseconds wall) { wall_ = wall; }

  /** @brief Run at @p rate from the latest wall instant on. @pre rate >= 0 */
  void setRate(FactorUnits rate) { rate_ = rate; }

  /** @brief Set simulated time to exactly @p sim [ns, simulated], without a remainder. */
  void setTo(Nanoseconds sim) {
    sim_ = sim;
    remainder_ = 0;
  }

  /** @return the first wall instant [ns] at which the present rate gets to @p sim [ns], or kNever.
   */
  Nanoseconds wallWhen(Nanoseconds sim) const {
    if (sim <= sim_) {
      return wall_;
    }
    if (rate_ == 0) {
      return kNever;
    }
    const Wide missing = (static_cast<Wide>(sim) - sim_) * kFactorUnit - remainder_;
    const Wide wall = wall_ + (missing + rate_ - 1) / rate_;
    return wall > kNever ? kNever : static_cast<Nanoseconds>(wall);
  }

  Nanoseconds now() const { return sim_; }
  Nanoseconds wall() const { return wall_; }
  FactorUnits rate() const { return rate_; }

 private:
  __extension__ using Wide = __int128;

  Nanoseconds sim_;
  Nanoseconds wall_;
  FactorUnits rate_ = 0;
  FactorUnits remainder_ = 0;  // billionths of a nanosecond, 0 <= remainder < kFactorUnit
};

}  // namespace move_base_abstract
