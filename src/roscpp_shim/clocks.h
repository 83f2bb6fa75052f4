// The clocks of the wall as the program sees them.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_CLOCKS_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_CLOCKS_H

#include <time.h>

#include "roscpp_shim/machine/instants.h"

namespace move_base_abstract::shim {

/** @return the machine's clock [ns]. */
Nanoseconds machineTime(clockid_t clock);
/** @return what the program sees of @p clock [ns]. */
Nanoseconds seenTime(clockid_t clock);
/** @return how long a wait until @p deadline, by a clock that the program sees, is meant to last
 * [ns]. */
Nanoseconds remaining(clockid_t clock, const timespec& deadline);
/** @brief The seen clocks go on by a sleep [ns] during which simulated time stands. */
void addSleep(Nanoseconds duration);

/**
 * @brief A wait by the machine's clock, of a thread that sees the run's: before the program joins,
 * when the run is over, or beside the threads that take turns.
 */
class MachineWait {
 public:
  MachineWait(clockid_t clock, const timespec* deadline);
  /** @return the deadline by the machine's clock; null if there is none. */
  const timespec* deadline() const { return deadline_; }
  /** @brief It has lasted until the deadline. */
  void timedOut() const;

 private:
  Nanoseconds lasts_ = 0;
  timespec translated_{};
  const timespec* deadline_;
};

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_CLOCKS_H
