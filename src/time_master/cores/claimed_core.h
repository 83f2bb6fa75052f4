// The core of this computer that a run has for itself. No ROS.
#pragma once

#include <sched.h>

#include <map>
#include <vector>

#include "time_master/descriptor.h"

namespace move_base_abstract {

/**
 * @brief Chooses a core and claims it, so that other runs on this computer take others. A claim
 * ends with this process. Not thread-safe.
 */
class ClaimedCore {
 public:
  ClaimedCore();

  /** @brief Choose the idlest of the cores @p allowed of those that the fewest other runs have. */
  void choose(const cpu_set_t& allowed);
  /** @brief Give the core up. */
  void leave();

  /** @return -1 if there is none. */
  int number() const { return number_; }
  /** @return whether another run had the core when it was chosen. */
  bool isShared() const { return is_shared_; }

 private:
  struct Ticks {
    double idle = 0.0;
    double all = 0.0;
  };

  static std::map<int, Ticks> ticks();
  std::vector<int> idlestFirst(const cpu_set_t& cores) const;

  const std::map<int, Ticks> ticks_at_start_;  // of each core
  int number_ = -1;
  Descriptor claim_;
  bool is_shared_ = false;
};

}  // namespace move_base_abstract
