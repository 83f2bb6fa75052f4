// The scaled clock: simulated time = factor x wall time, on /clock.
#pragma once

#include <ros/publisher.h>

#include <string>

#include "clock/time_master.h"
#include "time_mode.h"

namespace move_base_abstract {

/** @brief The mode in which simulated time follows wall time; see TimeMaster. */
class ScaledMode : public TimeMode {
 public:
  ScaledMode(const TimeMaster::Settings& settings, const ros::Publisher& clock);

  const char* name() const override { return "scaled"; }
  Nanoseconds now() const override { return master_.now(); }
  bool work() override;
  Nanoseconds nextWork() const override { return master_.nextWake(); }
  bool finish(const std::string&) override { return true; }
  void describe(TimeState& state) override;
  std::string inUse() const override;
  std::string setFactor(double factor) override;
  std::string pause() override;
  std::string resume() override;
  Nanoseconds step(Nanoseconds duration) override { return master_.step(duration, wallNow()); }
  void runUntil(Nanoseconds target) override { master_.runUntil(target, wallNow()); }
  std::string hold(const std::string& holder, double timeout) override;
  std::string release(const std::string& holder) override;

 private:
  std::string holders() const;

  TimeMaster master_;
  ros::Publisher clock_;
};

}  // namespace move_base_abstract
