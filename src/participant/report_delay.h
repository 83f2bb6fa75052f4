// Delays of reports and of first turns, in wall time: what `verify` uses to show that they do not
// matter.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_REPORT_DELAY_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_REPORT_DELAY_H

#include <cstdint>
#include <random>
#include <string>

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Holds one report in sixteen back, for a random part of the milliseconds that the
 * environment variable MOVE_BASE_ABSTRACT_REPORT_DELAY names: SEED:MILLISECONDS. Where
 * MOVE_BASE_ABSTRACT_FIRST_TURNS says COUNT:MILLISECONDS, each of so many first turns begins so
 * much later: what several nodes tell the ROS master at one instant comes in another order.
 */
class ReportDelay {
 public:
  /** @brief What the environment asks for, for the node @p name. @throws Error if it has another
   * form. */
  void prepare(const std::string& name);
  void wait();
  /** @brief A turn begins. */
  void begin();

 private:
  std::uint64_t longest_ns_ = 0;
  std::mt19937_64 chance_;
  std::uint64_t turns_ = 0;  // that are still to begin late,
  std::uint64_t late_ns_ = 0;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_REPORT_DELAY_H
