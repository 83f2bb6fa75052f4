#include "time_master.h"

#include <algorithm>
#include <cmath>

#include "argument_check.h"
#include "number_text.h"
#include "shown_text.h"

namespace move_base_abstract {
namespace {

FactorUnits toUnits(double factor) {
  return std::llround(factor * static_cast<double>(kFactorUnit));
}

double fromUnits(FactorUnits units) {
  return static_cast<double>(units) / static_cast<double>(kFactorUnit);
}

Nanoseconds toNanoseconds(double seconds) {
  return std::max<Nanoseconds>(1,
                               std::llround(seconds * static_cast<double>(kNanosecondsPerSecond)));
}

/** @return the time between two messages, rounded up so that the rate is never exceeded. */
Nanoseconds gap(double rate) {
  return static_cast<Nanoseconds>(std::ceil(static_cast<double>(kNanosecondsPerSecond) / rate));
}

}  // namespace

TimeMaster::TimeMaster(const Settings& settings, Nanoseconds wall)
    : factor_(toUnits(settings.factor)),
      busy_factor_(toUnits(settings.busy_factor)),
      longest_gap_(toNanoseconds(settings.longest_gap)),
      paused_(settings.start_paused),
      clock_(toNanoseconds(settings.start_time), wall),
      plan_(toNanoseconds(settings.finest_step), gap(settings.max_clock_rate),
            gap(settings.repeat_rate)) {
  applyRate();
  achieved_.look(clock_.wall(), now(), 0.0, !paused_);
}

void TimeMaster::advance(Nanoseconds wall) {
  leaveOutGap(wall);
  do {
    clock_.advanceTo(std::min({wall, nextStop(), nextExpiry()}));
    endRun();
    endHolds();
    applyRate();
  } while (clock_.wall() < wall);
  achieved_.look(clock_.wall(), now(), 0.0, !paused_);
}

std::optional<Nanoseconds> TimeMaster::poll(Nanoseconds wall) {
  advance(wall);
  if (plan_.due(clock_) > clock_.wall()) {
    return std::nullopt;
  }
  return plan_.take(clock_);
}

Nanoseconds TimeMaster::nextWake() const {
  return std::min({plan_.due(clock_), nextStop(), nextExpiry()});
}

std::vector<TimeMaster::Event> TimeMaster::takeEvents() {
  std::vector<Event> events;
  events.swap(events_);
  return events;
}

void TimeMaster::setFactor(double factor, Nanoseconds wall) {
  checkedFactor("factor", factor);
  advance(wall);
  factor_ = toUnits(factor);
  applyRate();
}

void TimeMaster::pause(Nanoseconds wall) {
  advance(wall);
  paused_ = true;
  target_.reset();
  applyRate();
}

void TimeMaster::resume(Nanoseconds wall) {
  advance(wall);
  if (now() >= kLastInstant) {
    refuse("resume: simulated time is at its end, " + secondsText(kLastInstant));
  }
  paused_ = false;
  target_.reset();
  applyRate();
}

Nanoseconds TimeMaster::step(Nanoseconds duration, Nanoseconds wall) {
  advance(wall);
  const Nanoseconds target = checkedStep(target_.value_or(now()), duration);
  aimAt(target);
  return target;
}

void TimeMaster::runUntil(Nanoseconds target, Nanoseconds wall) {
  advance(wall);
  aimAt(checkedTarget(now(), target));
}

void TimeMaster::hold(const std::string& holder, double timeout, Nanoseconds wall) {
  if (holder.empty()) {
    refuse("hold: holder must be a name, got an empty one");
  }
  if (holder.size() > kLongestName || hasControlCharacters(holder)) {
    refuse("hold: holder must be a name of at most " + std::to_string(kLongestName) +
           " bytes without control characters, got '" + shown(holder, kLongestName) + "'");
  }
  if (!(timeout > 0.0 && timeout <= kLongestHold)) {
    refuse("hold by '" + holder + "': timeout must be more than 0 and at most " +
           numberText(kLongestHold) + " s of wall time, got " + numberText(timeout));
  }
  advance(wall);
  Nanoseconds& end = holds_.try_emplace(holder, clock_.wall()).first->second;
  end = std::max(end, addSaturated(clock_.wall(), toNanoseconds(timeout)));
  applyRate();
}

bool TimeMaster::release(const std::string& holder, Nanoseconds wall) {
  advance(wall);
  const bool held = holds_.erase(holder) > 0;
  applyRate();
  return held;
}

std::vector<TimeMaster::Hold> TimeMaster::holds() const {
  std::vector<Hold> result;
  for (const auto& [holder, end] : holds_) {
    result.push_back({holder, end - clock_.wall()});
  }
  return result;
}

double TimeMaster::wantedFactor() const { return fromUnits(factor_); }

double TimeMaster::busyFactor() const { return fromUnits(busy_factor_); }

double TimeMaster::effectiveFactor() const { return fromUnits(clock_.rate()); }

void TimeMaster::aimAt(Nanoseconds target) {
  paused_ = false;
  target_ = target;
  endRun();
  applyRate();
}

void TimeMaster::applyRate() {
  if (paused_) {
    clock_.setRate(0);
  } else {
    clock_.setRate(holds_.empty() ? factor_ : std::min(factor_, busy_factor_));
  }
}

void TimeMaster::leaveOutGap(Nanoseconds wall) {
  const Nanoseconds left_out = wall - clock_.wall() - longest_gap_;
  if (left_out <= 0) {
    return;
  }
  if (clock_.rate() > 0) {
    events_.push_back({Event::Kind::kGap, wall, now(), "", left_out});
  }
  clock_.skipTo(clock_.wall() + left_out);
}

void TimeMaster::endHolds() {
  // Holds expire in the order of their ends; those that end at one instant, in alphabetical order.
  for (auto hold = holds_.begin(); hold != holds_.end();) {
    if (hold->second <= clock_.wall()) {
      events_.push_back({Event::Kind::kHoldExpired, clock_.wall(), now(), hold->first, 0});
      hold = holds_.erase(hold);
    } else {
      ++hold;
    }
  }
}

void TimeMaster::endRun() {
  const Nanoseconds stop = target_.value_or(kLastInstant);
  if (paused_ || now() < stop) {
    return;
  }
  // A nanosecond of wall time may be many of simulated time, so the clock may be past the stop.
  clock_.setTo(stop);
  paused_ = true;
  if (target_) {
    events_.push_back({Event::Kind::kTargetReached, clock_.wall(), stop, "", 0});
    target_.reset();
  }
  if (stop == kLastInstant) {
    events_.push_back({Event::Kind::kEndOfTime, clock_.wall(), stop, "", 0});
  }
}

Nanoseconds TimeMaster::nextStop() const {
  return paused_ ? kNever : clock_.wallWhen(target_.value_or(kLastInstant));
}

Nanoseconds TimeMaster::nextExpiry() const {
  Nanoseconds earliest = kNever;
  for (const auto& hold : holds_) {
    earliest = std::min(earliest, hold.second);
  }
  return earliest;
}

}  // namespace move_base_abstract
