// What was noticed and is to be told: Python fetches it when a turn is over. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PYTHON_SHIM_NOTICES_H
#define MOVE_BASE_ABSTRACT_PYTHON_SHIM_NOTICES_H

namespace move_base_abstract::native {

/** What is told; lockstep/machine/native.py has the words, in the same order. */
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
  kEntropy
};

/** @brief Note what the code at @p caller does; once. For any thread, at any time. */
void notice(What what, const void* caller);

}  // namespace move_base_abstract::native

#endif  // MOVE_BASE_ABSTRACT_PYTHON_SHIM_NOTICES_H
