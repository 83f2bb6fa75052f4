// The interface of the time master's two modes, scaled and lockstep.
#pragma once

#include <move_base_abstract/TimeState.h>
#include <ros/time.h>

#include <cstdio>
#include <optional>
#include <string>

#include "clock/number_text.h"
#include "clock/scaled_clock.h"
#include "wall_now.h"

namespace move_base_abstract {

inline ros::Time toRos(Nanoseconds time) {
  return ros::Time(static_cast<uint32_t>(time / kNanosecondsPerSecond),
                   static_cast<uint32_t>(time % kNanosecondsPerSecond));
}

/** @brief Return an instant or duration of ROS in ns; exact, also if it is negative. */
template <typename RosTime>
Nanoseconds fromRos(const RosTime& time) {
  return static_cast<Nanoseconds>(time.sec) * kNanosecondsPerSecond + time.nsec;
}

inline std::string text(Nanoseconds time) {
  char buffer[40];
  std::snprintf(buffer, sizeof(buffer), "%lld.%09lld s",
                static_cast<long long>(time / kNanosecondsPerSecond),
                static_cast<long long>(time % kNanosecondsPerSecond));
  return buffer;
}

inline std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof(buffer), "%.12g", value);
  return buffer;
}

class LockstepServer;

/**
 * @brief Decides how simulated time moves, and publishes it on /clock. For one thread.
 *
 * A refused request throws std::invalid_argument, which says what was got and what is allowed; it
 * changes nothing. Requests that return a text say what was done, for the service's answer.
 */
class TimeMode {
 public:
  /** @brief The end of a run that has ended by itself. */
  struct End {
    bool good;  // false: the process has to end with an error
    std::string reason;
  };

  TimeMode() = default;
  virtual ~TimeMode() = default;
  TimeMode(const TimeMode&) = delete;
  TimeMode& operator=(const TimeMode&) = delete;

  virtual const char* name() const = 0;
  /** @return the server of lockstep; null on the scaled clock. */
  virtual LockstepServer* lockstep() { return nullptr; }
  virtual Nanoseconds now() const = 0;

  /** @brief Do the work that is due. @return whether the state should be published now. */
  virtual bool work() = 0;
  /** @return the wall instant [ns] of the next work(). */
  virtual Nanoseconds nextWork() const = 0;
  virtual std::optional<End> ended() const { return std::nullopt; }
  /** @brief End the run. @return whether all its files were written. */
  virtual bool finish(const std::string& reason) = 0;

  virtual void describe(TimeState& state) = 0;
  /** @return why the mode cannot be changed now; '' if it can. */
  virtual std::string inUse() const = 0;

  virtual std::string setFactor(double factor) = 0;
  virtual std::string pause() = 0;
  virtual std::string resume() = 0;
  virtual Nanoseconds step(Nanoseconds duration) = 0;
  virtual void runUntil(Nanoseconds target) = 0;
  virtual std::string hold(const std::string& holder, double timeout) = 0;
  virtual std::string release(const std::string& holder) = 0;
};

}  // namespace move_base_abstract
