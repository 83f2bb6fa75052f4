// The wall clocks, as the program sees them.
#pragma once

#include <time.h>

#include "libc/instants.h"

namespace move_base_abstract::shim {

/** @return the time of the machine's own @p clock [ns]. */
Nanoseconds machineTime(clockid_t clock);
/** @return the time of @p clock as the program sees it [ns]. */
Nanoseconds seenTime(clockid_t clock);
/** @return how long a wait until @p deadline is meant to last [ns]; @p clock is one that the
 * program sees. */
Nanoseconds remaining(clockid_t clock, const timespec& deadline);
/** @brief Advance the seen clocks by a sleep [ns] during which simulated time stands still. */
void addSleep(Nanoseconds duration);

/**
 * @brief A wait by the machine's clock, of a thread that sees the clocks of the run: before the
 * program joins, after the run, or beside the threads that take turns.
 */
class MachineWait {
 public:
  MachineWait(clockid_t clock, const timespec* deadline);
  /** @return the deadline by the machine's clock; null if there is none. */
  const timespec* deadline() const { return deadline_; }
  /** @brief Note that the wait has lasted until the deadline. */
  void timedOut() const;

 private:
  Nanoseconds lasts_ = 0;
  timespec translated_{};
  const timespec* deadline_;
};

}  // namespace move_base_abstract::shim
