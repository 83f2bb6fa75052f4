// The cores of this computer that a run has for itself. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CLAIMED_CORES_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CLAIMED_CORES_H

#include <sched.h>

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "time_master/descriptor.h"

namespace move_base_abstract {

/**
 * @brief Chooses cores that are idle most of the time, and claims them, so that other runs on this
 * computer take others. A claim ends with this process. Not thread-safe.
 */
class ClaimedCores {
 public:
  ClaimedCores() { takeWork(); }

  /**
   * @brief Choose from @p fewest up to @p most of the cores @p allowed that no other run has.
   * @param is_wished whether cores of other runs may be taken, if there are no others.
   * @return false if there are not enough. Then none is chosen.
   */
  bool choose(const cpu_set_t& allowed, std::size_t fewest, std::size_t most, bool is_wished);
  /** @brief Give the cores up, and choose others the next time, if there are any. */
  void leave();

  /** @return the chosen cores, in the order of their numbers. */
  const std::vector<int>& numbers() const { return numbers_; }
  /** @return whether all of them are among @p cores. */
  bool areIn(const cpu_set_t& cores) const;

 private:
  struct Work {
    double idle = 0.0;  // ticks
    double all = 0.0;
  };

  std::map<int, Work> takeWork();
  std::vector<std::pair<int, int>> byWork(const cpu_set_t& cores);

  std::vector<int> numbers_;
  std::vector<int> avoided_;
  std::vector<Descriptor> claims_;
  std::map<int, Work> work_;  // of each core, at the latest takeWork()
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_CORES_CLAIMED_CORES_H
