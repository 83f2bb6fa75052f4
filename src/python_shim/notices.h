// Notices of what cannot be followed. Python fetches them when a turn is over. No ROS.
#pragma once

namespace move_base_abstract::native {

/** The kinds of notices; lockstep/machine/native.py has their texts, in the same order. */
enum class What {
  kStrayClock,
  kStrayChance,
  kComputes,
  kTimes,
  kUsage,
  kLoad,
  kSystem,
  kWakes,
  kProcess,
  kNumber,
  kDevice,
  kEntropy,
  kWorkers
};

/** @brief Note once what the code at @p caller does. For any thread, at any time. */
void notice(What what, const void* caller);

}  // namespace move_base_abstract::native
