// Controls a run from outside: pause, step, run until, stops, speed limit, end.
#pragma once

#include <optional>

#include "clock/scaled_clock.h"
#include "settings.h"

namespace move_base_abstract {

/**
 * @brief Decides whether time may go on. Of pause, resume, step, runUntil and awaitStop, the last
 * one called wins.
 *
 * A refused call throws std::invalid_argument, which says what was got and what is allowed; it
 * changes nothing.
 */
class RoundGate {
 public:
  RoundGate(double limit, bool is_paused, bool is_stopped)
      : paused_(is_paused), stopped_(is_stopped), limit_(checkedLimit(limit)) {}

  void pause();
  void resume();
  /** @brief Run for @p duration [ns, simulated, > 0] from @p present, or from the target of a step
   * still under way, and pause there. @return the target [ns]. */
  Nanoseconds step(Nanoseconds present, Nanoseconds duration);
  void runUntil(Nanoseconds present, Nanoseconds target);
  /** @brief Run until stop() is called, or pause at @p until; 0: nowhere. */
  void awaitStop(Nanoseconds present, Nanoseconds until);
  /** @brief Let time stand between two rounds: those of the present instant stand, too. */
  void stop();
  /** @brief Leave a stop, if time stands at one. */
  void leaveStop() { stopped_ = false; }
  /** @brief If time goes on, pause at @p end at the latest. */
  void pauseAtLatest(Nanoseconds end);
  /** @brief Limit the speed to @p factor simulated s per wall s (0.01 to 1e6); 0: no limit. */
  void setLimit(double factor);
  void end(Nanoseconds at) { ended_ = at; }
  /** @brief Let time stand, whatever else was called, until this is called with false. */
  void holdForOthers(bool holds) { holds_for_others_ = holds; }
  bool holdsForOthers() const { return holds_for_others_; }

  bool ended() const { return ended_.has_value(); }
  bool paused() const { return paused_ || stopped_ || holds_for_others_; }
  bool stopped() const { return stopped_; }
  bool awaitsStop() const { return awaits_stop_; }
  std::optional<Nanoseconds> target() const { return target_; }
  double limit() const;
  /**
   * @return whether time stands at a reached target, as it would in every run of the same system.
   */
  bool stands() const { return paused_ && target_reached_; }
  /** @return whether since forgetLimit() mayGo() has refused only because of the limit. */
  bool isHeldByLimit() const { return held_by_limit_; }

  // ---- for the rounds; `wall` is a monotonic wall instant in ns ----
  void forgetLimit() { held_by_limit_ = false; }
  /** @return @p next, or the target if that is earlier. */
  Nanoseconds stopBefore(Nanoseconds next) const;
  /** @return whether time may go on from @p from to @p to. */
  bool mayGo(Nanoseconds from, Nanoseconds to, Nanoseconds wall);
  /**
   * @return the wall instant [ns] from which on the limit allows time to go on from @p from to @p
   * to.
   */
  Nanoseconds leapWall(Nanoseconds from, Nanoseconds to) const;
  /** @brief Note that time has gone on. */
  void leapt(Nanoseconds wall) { last_leap_ = wall; }
  /** @brief Note that time has come to the target, and pause. */
  void reach();

 private:
  void refuseIfEnded(const char* call) const;
  void open(bool is_paused, std::optional<Nanoseconds> target);

  bool paused_;
  bool stopped_;
  bool awaits_stop_ = false;
  bool holds_for_others_ = false;
  std::optional<Nanoseconds> ended_;
  std::optional<Nanoseconds> target_;
  bool target_reached_ = false;  // ... and no other call has come since
  FactorUnits limit_;
  Nanoseconds last_leap_ = 0;  // wall
  bool held_by_limit_ = false;
};

}  // namespace move_base_abstract
