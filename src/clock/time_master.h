// The rules of the time master for the scaled clock. No ROS, no thread, no sleeping: wall time is
// an argument.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "achieved_factor.h"
#include "publication_plan.h"
#include "scaled_clock.h"

namespace move_base_abstract {

/**
 * @brief Simulated time = factor x wall time, with pause, step, run until and holds.
 *
 * Every `wall` argument is a monotonic wall instant in ns. An instant before the latest one given
 * counts as the latest. A hold, a step and a run end at exactly their own instants, however late
 * the next call comes. Of pause, resume, step and run until, the last one called wins. A refused
 * call throws std::invalid_argument, which says what was got and what is allowed; it changes
 * nothing.
 */
class TimeMaster {
 public:
  static constexpr double kLongestHold = 86400.0;  // wall seconds
  static constexpr double kLongestGap = 3e9;       // wall seconds

  struct Settings {
    double factor = 1.0;            // simulated s per wall s, 0.01 to 1e6
    double busy_factor = 1.0;       // limit during a hold; 0 (frozen) or 0.01 to 1e6
    double finest_step = 0.01;      // s simulated between two messages, 1e-6 to 3600
    double max_clock_rate = 500.0;  // messages per wall s, 1 to 10000
    double start_time = 1.0;        // s simulated, 1e-6 to 2e9
    bool start_paused = false;
    double repeat_rate = 20.0;         // messages per wall s while time stands still, 1 to 1000
    double longest_gap = kLongestGap;  // wall s between two calls that count, 0.2 to 3e9
  };

  /** @brief Something that happened without a call, such as the end of a hold. */
  struct Event {
    enum class Kind { kHoldExpired, kTargetReached, kEndOfTime, kGap };
    Kind kind;
    Nanoseconds wall;          // ns, when exactly it happened; for a gap, its end
    Nanoseconds time;          // ns, simulated
    std::string holder;        // of an expired hold
    Nanoseconds left_out = 0;  // ns, wall, for a gap: how long time stood but should not have
  };

  struct Hold {
    std::string holder;
    Nanoseconds remaining;  // ns, wall
  };

  /** @param settings within the ranges above, which the caller checks. */
  TimeMaster(const Settings& settings, Nanoseconds wall);

  /**
   * @brief Integrate up to @p wall. Each hold, step and run that ends on the way ends at its own
   * instant.
   *
   * If there was no call for longer than longest_gap, because the process was stopped or the
   * computer is overloaded, only longest_gap counts. Otherwise the nodes that listen to /clock
   * would see one large leap.
   */
  void advance(Nanoseconds wall);

  /** @brief Advance to @p wall. @return the time [ns] to publish, if a message is due. */
  std::optional<Nanoseconds> poll(Nanoseconds wall);

  /** @return the wall instant [ns] at which to poll next; it may lie in the past. */
  Nanoseconds nextWake() const;

  /** @return the events since the last call, in the order in which they happened. */
  std::vector<Event> takeEvents();

  /** @brief Run at @p factor (0.01 to 1e6) from @p wall on. */
  void setFactor(double factor, Nanoseconds wall);

  /** @brief Stand still. A step or run under way is given up. */
  void pause(Nanoseconds wall);

  /** @brief Run on without a target. Refused at the end of time. */
  void resume(Nanoseconds wall);

  /**
   * @brief Run for @p duration [ns, simulated, > 0] and pause there. It counts from the target of a
   * step or run under way; if there is none, from the present. @return the target [ns].
   */
  Nanoseconds step(Nanoseconds duration, Nanoseconds wall);

  /** @brief Run until @p target [ns, simulated, not before the present], and pause there. */
  void runUntil(Nanoseconds target, Nanoseconds wall);

  /**
   * @brief Limit the factor to busy_factor for @p timeout wall seconds (more than 0, to 86400). A
   * second hold under the same name can move the end later, but not earlier.
   */
  void hold(const std::string& holder, double timeout, Nanoseconds wall);

  /** @brief End the hold of @p holder. @return whether there was one. */
  bool release(const std::string& holder, Nanoseconds wall);

  Nanoseconds now() const { return clock_.now(); }
  bool paused() const { return paused_; }
  std::optional<Nanoseconds> target() const { return target_; }
  std::vector<Hold> holds() const;  // in alphabetical order
  double wantedFactor() const;
  double busyFactor() const;
  double effectiveFactor() const;  // 0 while time stands still
  double achievedFactor() const { return achieved_.at(clock_.wall()); }

 private:
  void aimAt(Nanoseconds target);
  void applyRate();
  void leaveOutGap(Nanoseconds wall);
  void endHolds();
  void endRun();
  Nanoseconds nextStop() const;
  Nanoseconds nextExpiry() const;

  FactorUnits factor_;
  FactorUnits busy_factor_;
  Nanoseconds longest_gap_;  // wall
  bool paused_;
  std::optional<Nanoseconds> target_;
  std::map<std::string, Nanoseconds> holds_;  // holder -> wall instant of its end
  ScaledClock clock_;
  PublicationPlan plan_;
  std::vector<Event> events_;
  AchievedFactor achieved_;
};

}  // namespace move_base_abstract
