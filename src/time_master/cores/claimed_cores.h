// The cores of this computer that a run has for itself. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CLAIMED_CORES_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CLAIMED_CORES_H

#include <sched.h>

#include <cstddef>
#include <map>
#include <vector>

#include "time_master/descriptor.h"

namespace move_base_abstract {

/**
 * @brief Chooses cores that no other run has, the idlest first, and claims them, so that other runs
 * on this computer take others. A claim ends with this process. Not thread-safe.
 */
class ClaimedCores {
 public:
  ClaimedCores();

  /**
   * @brief Choose up to @p most of the cores @p allowed that no other run has; if these are fewer
   * than @p fewest, also those that the fewest other runs have.
   */
  void choose(const cpu_set_t& allowed, std::size_t fewest, std::size_t most);
  /** @brief Give the cores up. */
  void leave();

  /** @return the chosen cores, in the order of their numbers. */
  const std::vector<int>& numbers() const { return numbers_; }
  /** @return whether another run had one of the cores when they were chosen. */
  bool areShared() const { return are_shared_; }
  /** @return whether all of them are among @p cores. */
  bool areIn(const cpu_set_t& cores) const;

 private:
  struct Ticks {
    double idle = 0.0;
    double all = 0.0;
  };

  static std::map<int, Ticks> ticks();
  std::vector<int> idlestFirst(const cpu_set_t& cores) const;

  const std::map<int, Ticks> ticks_at_start_;  // of each core
  std::vector<int> numbers_;
  std::vector<Descriptor> claims_;
  bool are_shared_ = false;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CLAIMED_CORES_H
