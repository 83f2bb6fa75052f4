// The state of the rounds, which nothing here changes.

#include <algorithm>

#include "rounds.h"

namespace move_base_abstract {

Nanoseconds LockstepRounds::nextWake() const {
  if (ended() || zero_delay_loop_ || gate_.stopped()) {
    return kNever;
  }
  if (!started_) {
    const bool settling = settings_.participants.empty() && !members_.all().empty();
    return settling ? addSaturated(last_join_, toNanoseconds(settings_.settle)) : kNever;
  }
  if (!settled()) {
    return watch_.nextLook();
  }
  return gate_.isHeldByLimit() ? gate_.leapWall(clock_.time, gate_.stopBefore(nextTime())) : kNever;
}

/** @return the instant to which time goes on; kNever: there is no reason to go on. */
Nanoseconds LockstepRounds::nextTime() const {
  return windows_.areThere() ? std::min(windows_.begin(), outside_.next())
                             : members_.nextTime(outside_.next());
}

bool LockstepRounds::atRest() const {
  return started_ && settled() && (idle_ || zero_delay_loop_ || gate_.stands());
}

LockstepPhase LockstepRounds::phase(Nanoseconds wall) const {
  if (ended()) {
    return LockstepPhase::kEnded;
  }
  if (!started_) {
    return gate_.stopped() && mayStart(wall) ? LockstepPhase::kStopped
                                             : LockstepPhase::kWaitingForParticipants;
  }
  if (zero_delay_loop_) {
    return LockstepPhase::kZeroDelayLoop;
  }
  if (!settled()) {
    return watch_.isLong(wall) ? LockstepPhase::kWaiting : LockstepPhase::kRunning;
  }
  if (gate_.stopped()) {
    return LockstepPhase::kStopped;
  }
  if (idle_ && members_.areStuck(owed_ > 0)) {
    return LockstepPhase::kDeadlock;
  }
  if (gate_.paused()) {
    return LockstepPhase::kPaused;
  }
  if (idle_) {
    return LockstepPhase::kIdle;
  }
  return gate_.isHeldByLimit() ? LockstepPhase::kLimited : LockstepPhase::kRunning;
}

}  // namespace move_base_abstract
