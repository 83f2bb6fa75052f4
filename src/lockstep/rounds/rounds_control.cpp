// How rounds are steered from outside (the gate), and what is said of them.
#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "clock/number_text.h"
#include "clock/time_master.h"
#include "rounds.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLongReport = kNanosecondsPerSecond;  // wall; longer is shown as waiting
constexpr Nanoseconds kLastInstant = TimeMaster::kLastInstant;

[[noreturn]] void refuse(const std::string& text) { throw std::invalid_argument(text); }

}  // namespace

const char* phaseName(LockstepPhase phase) {
  switch (phase) {
    case LockstepPhase::kWaitingForParticipants:
      return "waiting_for_participants";
    case LockstepPhase::kRunning:
      return "running";
    case LockstepPhase::kWaiting:
      return "waiting";
    case LockstepPhase::kLimited:
      return "limited";
    case LockstepPhase::kPaused:
      return "paused";
    case LockstepPhase::kIdle:
      return "idle";
    case LockstepPhase::kDeadlock:
      return "deadlock";
    case LockstepPhase::kZeroDelayLoop:
      return "zero_delay_loop";
    case LockstepPhase::kEnded:
      return "ended";
  }
  return "unknown";
}

// ---- gate ------------------------------------------------------------------------------------

void LockstepRounds::pause() {
  refuseIfEnded("pause");
  paused_ = true;
  target_reached_ = false;
  target_.reset();
}

void LockstepRounds::resume() {
  refuseIfEnded("resume");
  paused_ = false;
  target_reached_ = false;
  target_.reset();
}

Nanoseconds LockstepRounds::step(Nanoseconds duration) {
  refuseIfEnded("step");
  const Nanoseconds from = target_.value_or(present());
  if (duration <= 0 || duration > kLastInstant - from) {
    refuse("step: duration must be more than 0 and at most " + secondsText(kLastInstant - from) +
           " from " + secondsText(from) + " on, got " + secondsText(duration));
  }
  paused_ = false;
  target_reached_ = false;
  target_ = from + duration;
  return *target_;
}

void LockstepRounds::runUntil(Nanoseconds target) {
  refuseIfEnded("run_until");
  if (target < present() || target > kLastInstant) {
    refuse("run_until: target must be from the present, " + secondsText(present()) + ", to " +
           secondsText(kLastInstant) + ", got " + secondsText(target));
  }
  paused_ = false;
  target_reached_ = false;
  target_ = target;
}

void LockstepRounds::setLimit(double factor) {
  const FactorUnits limit = checkedLimit(factor);
  refuseIfEnded("limit");
  limit_ = limit;
}

void LockstepRounds::end() { ended_ = true; }

void LockstepRounds::refuseIfEnded(const char* call) const {
  if (ended_) {
    refuse(std::string(call) + ": the run has ended, at " + secondsText(time_));
  }
}

// ---- what is so ------------------------------------------------------------------------------

double LockstepRounds::limit() const {
  return static_cast<double>(limit_) / static_cast<double>(kFactorUnit);
}

void LockstepRounds::background(MemberId id) { at(id).background = true; }
void LockstepRounds::idle(MemberId id, std::uint32_t threads) { at(id).idle = threads; }

/** @return when time goes on; kNever: nobody has a reason to wake up. */
Nanoseconds LockstepRounds::nextTime() const {
  if (hasWindows()) {
    return std::min(windowBegin(), nextArrival());
  }
  const auto counts = [this](const auto& due) { return !members_.at(due.second).background; };
  const Nanoseconds arrival = nextArrival();
  if (arrival == kNever && std::none_of(due_.begin(), due_.end(), counts)) {
    return kNever;
  }
  if (due_.empty() || arrival < due_.begin()->first) {
    return arrival;
  }
  return due_.begin()->first;
}

bool LockstepRounds::atRest() const {
  return started_ && owing_ == 0 && (idle_ || zero_delay_loop_ || (paused_ && target_reached_));
}

LockstepPhase LockstepRounds::phase(Nanoseconds wall) const {
  if (ended_) {
    return LockstepPhase::kEnded;
  }
  if (!started_) {
    return LockstepPhase::kWaitingForParticipants;
  }
  if (zero_delay_loop_) {
    return LockstepPhase::kZeroDelayLoop;
  }
  if (owing_ > 0) {
    const bool working = std::none_of(granted_.begin(), granted_.end(), [this, wall](MemberId id) {
      const MemberState* member = find(id);
      return member && member->owes && wall - member->granted_wall > kLongReport;
    });
    return working ? LockstepPhase::kRunning : LockstepPhase::kWaiting;
  }
  if (idle_ && isStuck()) {
    return LockstepPhase::kDeadlock;
  }
  if (paused_) {
    return LockstepPhase::kPaused;
  }
  if (idle_) {
    return LockstepPhase::kIdle;
  }
  return held_by_limit_ ? LockstepPhase::kLimited : LockstepPhase::kRunning;
}

std::vector<MemberId> LockstepRounds::latestRound() const { return granted_; }

std::vector<std::string> LockstepRounds::missing() const {
  std::set<std::string_view> present;
  for (const auto& [id, member] : members_) {
    if (member.present) {
      present.insert(member.name);
    }
  }
  std::vector<std::string> missing;
  for (const std::string& name : settings_.participants) {
    if (present.count(name) == 0) {
      missing.push_back(name);
    }
  }
  return missing;
}

MailOrder LockstepRounds::order(MemberId id, std::uint32_t sub, std::uint64_t number) const {
  const MemberState* member = find(id);
  return {member ? member->rank : 0, sub, places_.of(id), number};
}

bool LockstepRounds::before(MemberId a, MemberId b) const {
  const MailOrder left = order(a, 0, 0);
  const MailOrder right = order(b, 0, 0);
  return std::tie(left.rank, left.place, a) < std::tie(right.rank, right.place, b);
}

bool LockstepRounds::before(const MailOrder& a, const MailOrder& b) const { return isBefore(a, b); }

}  // namespace move_base_abstract
