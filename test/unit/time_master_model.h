// The time master's rules once more, for tests, in the plainest way: one wall nanosecond at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clock/time_master.h"

namespace move_base_abstract {

__extension__ using Wide = __int128;

constexpr Nanoseconds kSecond = kNanosecondsPerSecond;
constexpr Nanoseconds kBoot = 5'000 * kSecond;  // some wall instant at which a test begins

/** @brief Takes the commands of a TimeMaster; time passes by tick(). */
class Model {
 public:
  Model(double factor, double busy_factor)
      : factor_(std::llround(factor * 1e9)), busy_(std::llround(busy_factor * 1e9)) {}

  void tick() {
    if (!paused_) {
      total_ += holds_.empty() ? factor_ : std::min(factor_, busy_);
    }
    ++wall_;
    if (!paused_ && target_ && total_ >= Wide{*target_} * kFactorUnit) {
      stop();
    }
    for (auto hold = holds_.begin(); hold != holds_.end();) {
      if (hold->second == wall_) {
        expired_.push_back(hold->first);
        hold = holds_.erase(hold);
      } else {
        ++hold;
      }
    }
  }

  void setFactor(double factor) { factor_ = std::llround(factor * 1e9); }
  void pause() {
    paused_ = true;
    target_.reset();
  }
  void resume() {
    paused_ = false;
    target_.reset();
  }
  void runUntil(Nanoseconds target) {
    target_ = target;
    paused_ = false;
    if (now() >= target) {
      stop();
    }
  }
  void hold(const std::string& holder, Nanoseconds timeout) {
    holds_[holder] = std::max(holds_[holder], wall_ + timeout);
  }
  bool release(const std::string& holder) { return holds_.erase(holder) == 1; }

  Nanoseconds now() const { return static_cast<Nanoseconds>(total_ / kFactorUnit); }
  Nanoseconds wall() const { return wall_; }
  bool paused() const { return paused_; }
  std::optional<Nanoseconds> target() const { return target_; }
  const std::vector<std::string>& expired() const { return expired_; }

 private:
  void stop() {
    total_ = Wide{*target_} * kFactorUnit;
    pause();
  }

  Wide total_ = Wide{kSecond} * kFactorUnit;
  Nanoseconds wall_ = kBoot;
  FactorUnits factor_;
  FactorUnits busy_;
  bool paused_ = false;
  std::optional<Nanoseconds> target_;
  std::map<std::string, Nanoseconds> holds_;
  std::vector<std::string> expired_;
};

}  // namespace move_base_abstract
