// Detaches a participant from /clock, because its time comes with its grants.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_DETACH_FROM_CLOCK_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_DETACH_FROM_CLOCK_H

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Unsubscribe roscpp from /clock, which may be ahead of this node's grants or behind them.
 * @throws Error if roscpp or the ROS master do not do it.
 */
void detachFromClock();

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_DETACH_FROM_CLOCK_H
