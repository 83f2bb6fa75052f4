// The clocks as libraries see them. No ROS.
#pragma once

#include "run.h"

namespace move_base_abstract::native {

/** @return the machine's clock [ns]. */
Nanoseconds machineTime(clockid_t clock);

/** @return what a clock shows to @p whose in the calling thread [ns]. Not counted as a look. */
Nanoseconds seenTime(clockid_t clock, Sees whose);

/** @brief Move clocks on by @p duration [ns]: those of all threads with turns, or, for kStray,
 * those of the calling thread. */
void goOn(Nanoseconds duration, Sees whose);

}  // namespace move_base_abstract::native
