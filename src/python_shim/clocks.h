// The clocks as libraries see them. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PYTHON_SHIM_CLOCKS_H
#define MOVE_BASE_ABSTRACT_PYTHON_SHIM_CLOCKS_H

#include "run.h"

namespace move_base_abstract::native {

/** @return the machine's clock [ns]. */
Nanoseconds machineTime(clockid_t clock);

/** @return what a clock shows in the calling thread [ns], which does not count as a look. */
Nanoseconds seenTime(clockid_t clock, Sees whose);

/** @brief The clocks go on by so long [ns]: those of all that have turns, or of a stray thread. */
void goOn(Nanoseconds duration, Sees whose);

}  // namespace move_base_abstract::native

#endif  // MOVE_BASE_ABSTRACT_PYTHON_SHIM_CLOCKS_H
