// Lets a participant whose work on one grant takes long say what it is doing.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "clock/scaled_clock.h"

namespace move_base_abstract::lockstep::internal {

/** @brief Watches, in a thread of its own, how long the work on a grant takes. */
class SilenceWatch {
 public:
  /** @brief Returns the number of the round that is being worked on; 0: none. */
  using Granted = std::function<std::uint64_t()>;
  /** @brief Called once for each round on which the work takes long. */
  using Tell = std::function<void(std::uint64_t)>;

  ~SilenceWatch() { end(); }

  /** @brief Begin to watch. Call this once. @param limit wall ns; kNever: nothing is watched. */
  void begin(Nanoseconds limit, Granted granted, Tell tell);
  void end();

 private:
  void watch(Nanoseconds limit, const Granted& granted, const Tell& tell) const;

  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace move_base_abstract::lockstep::internal
