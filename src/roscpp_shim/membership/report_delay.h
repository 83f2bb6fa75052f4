// Delays of reports and of first turns, in wall time. `verify` uses them to show that they do not
// matter.
#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Holds one report in sixteen back, for a random part of the milliseconds in the environment
 * variable MOVE_BASE_ABSTRACT_REPORT_DELAY, SEED:MILLISECONDS. With MOVE_BASE_ABSTRACT_FIRST_TURNS,
 * COUNT:MILLISECONDS, the first COUNT turns begin later by that time. So the calls of several nodes
 * to the ROS master at one instant come in another order.
 */
class ReportDelay {
 public:
  /**
   * @brief Read the environment variables, for the node @p name. @throws Error if one has another
   * form.
   */
  void prepare(const std::string& name);
  void wait();
  /** @brief Delay a turn that begins, if it is one of the first. */
  void begin();

 private:
  std::uint64_t longest_ns_ = 0;
  std::mt19937_64 chance_;
  std::uint64_t turns_ = 0;  // that still have to begin late
  std::uint64_t late_ns_ = 0;
};

}  // namespace move_base_abstract::lockstep::internal
