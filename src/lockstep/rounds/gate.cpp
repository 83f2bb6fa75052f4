#include "gate.h"

#include <algorithm>
#include <string>

#include "clock/argument_check.h"
#include "clock/number_text.h"

namespace move_base_abstract {

void RoundGate::pause() {
  refuseIfEnded("pause");
  open(true, {});
}

void RoundGate::resume() {
  refuseIfEnded("resume");
  open(false, {});
}

Nanoseconds RoundGate::step(Nanoseconds present, Nanoseconds duration) {
  refuseIfEnded("step");
  open(false, checkedStep(target_.value_or(present), duration));
  return *target_;
}

void RoundGate::runUntil(Nanoseconds present, Nanoseconds target) {
  refuseIfEnded("run_until");
  open(false, checkedTarget(present, target));
}

void RoundGate::awaitStop(Nanoseconds present, Nanoseconds until) {
  refuseIfEnded("stop_when");
  open(false, until == 0 ? std::nullopt : std::make_optional(checkedTarget(present, until)));
  awaits_stop_ = true;
}

void RoundGate::stop() {
  open(false, {});
  stopped_ = true;
}

void RoundGate::pauseAtLatest(Nanoseconds end) {
  if (!paused_ && !stopped_) {
    target_ = std::min(target_.value_or(end), end);
  }
}

void RoundGate::open(bool is_paused, std::optional<Nanoseconds> target) {
  paused_ = is_paused;
  stopped_ = awaits_stop_ = false;
  target_reached_ = false;
  target_ = target;
}

void RoundGate::setLimit(double factor) {
  const FactorUnits limit = checkedLimit(factor);
  refuseIfEnded("limit");
  limit_ = limit;
}

double RoundGate::limit() const {
  return static_cast<double>(limit_) / static_cast<double>(kFactorUnit);
}

void RoundGate::refuseIfEnded(const char* call) const {
  if (ended_) {
    refuse(std::string(call) + ": the run has ended, at " + secondsText(*ended_));
  }
}

Nanoseconds RoundGate::stopBefore(Nanoseconds next) const {
  return target_ && next > *target_ ? *target_ : next;
}

bool RoundGate::mayGo(Nanoseconds from, Nanoseconds to, Nanoseconds wall) {
  if (paused() || to == kNever) {
    return false;
  }
  held_by_limit_ = wall < leapWall(from, to);
  return !held_by_limit_;
}

Nanoseconds RoundGate::leapWall(Nanoseconds from, Nanoseconds to) const {
  if (limit_ == 0 || to <= from) {
    return last_leap_;
  }
  __extension__ using Wide = __int128;
  const Wide distance = static_cast<Wide>(to - from) * kFactorUnit;
  const Wide wall = last_leap_ + (distance + limit_ - 1) / limit_;
  return wall > kNever ? kNever : static_cast<Nanoseconds>(wall);
}

void RoundGate::reach() {
  paused_ = true;
  awaits_stop_ = false;
  target_reached_ = true;
  target_.reset();
}

}  // namespace move_base_abstract
