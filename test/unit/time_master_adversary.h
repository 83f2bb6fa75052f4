// Plays random commands at random instants to a TimeMaster and to its model, and compares them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "clock/time_master.h"
#include "refusal.h"
#include "time_master_model.h"

namespace move_base_abstract {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Nanoseconds kMost = std::numeric_limits<Nanoseconds>::max();

inline TimeMaster::Settings with(double factor, double busy_factor = 1.0) {
  TimeMaster::Settings settings;
  settings.factor = factor;
  settings.busy_factor = busy_factor;
  return settings;
}

class Adversary {
 public:
  explicit Adversary(unsigned seed, double busy_factor)
      : random_(seed), model_(1.0, busy_factor), master_(with(1.0, busy_factor), kBoot) {}

  void play(int moves) {
    for (int k = 0; k < moves; ++k) {
      for (Nanoseconds left = below(40); left > 0; --left) {
        model_.tick();
      }
      move(model_.wall());
      ASSERT_EQ(master_.now(), model_.now()) << "move " << k;
      ASSERT_EQ(master_.paused(), model_.paused()) << "move " << k;
      ASSERT_EQ(master_.target(), model_.target()) << "move " << k;
      collectEvents();
      ASSERT_EQ(expired_, model_.expired()) << "move " << k;
      checkPublication(model_.wall());
    }
  }

 private:
  Nanoseconds below(Nanoseconds end) { return static_cast<Nanoseconds>(random_() % end); }

  void move(Nanoseconds wall) {
    const std::string holder(1, static_cast<char>('a' + below(4)));
    switch (below(9)) {
      case 0:
        return setFactor(std::pow(10.0, static_cast<double>(below(8'000)) / 1000.0 - 2.0), wall);
      case 1:
        model_.pause();
        return master_.pause(wall);
      case 2:
        model_.resume();
        return master_.resume(wall);
      case 3:
        return step(1 + below(100'000), wall);
      case 4:
        return runUntil(model_.now() + below(3), wall);
      case 5: {
        const Nanoseconds timeout = 1 + below(100);
        model_.hold(holder, timeout);
        return master_.hold(holder, static_cast<double>(timeout) * 1e-9, wall);
      }
      case 6:
        ASSERT_EQ(master_.release(holder, wall), model_.release(holder));
        return;
      default:
        return master_.advance(wall);
    }
  }

  void setFactor(double factor, Nanoseconds wall) {
    model_.setFactor(factor);
    master_.setFactor(factor, wall);
  }

  void runUntil(Nanoseconds target, Nanoseconds wall) {
    model_.runUntil(target);
    master_.runUntil(target, wall);
  }

  void step(Nanoseconds duration, Nanoseconds wall) {
    const Nanoseconds target = model_.target().value_or(model_.now()) + duration;
    model_.runUntil(target);
    ASSERT_EQ(master_.step(duration, wall), target);
  }

  void collectEvents() {
    for (const auto& event : master_.takeEvents()) {
      if (event.kind == TimeMaster::Event::Kind::kHoldExpired) {
        expired_.push_back(event.holder);
      }
    }
  }

  void checkPublication(Nanoseconds wall) {
    if (const auto time = master_.poll(wall)) {
      ASSERT_GE(*time, last_time_);
      ASSERT_LE(*time, master_.now());
      if (last_wall_) {
        ASSERT_GE(wall - *last_wall_, 2'000'000);
      }
      last_time_ = *time;
      last_wall_ = wall;
    }
    ASSERT_TRUE(master_.nextWake() > wall);
  }

  std::mt19937_64 random_;
  Model model_;
  TimeMaster master_;
  std::vector<std::string> expired_;
  Nanoseconds last_time_ = kSecond;
  std::optional<Nanoseconds> last_wall_;
};

}  // namespace move_base_abstract
