// Notices another node of this node's name. The ROS master then shuts this node down, and gives the
// reason.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_NAMESAKE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_NAMESAKE_H

namespace move_base_abstract::lockstep::internal {

/** @brief Watch for the reason of a shutdown. Call this before ros::start(). */
void watchForNamesake();

/**
 * @return whether another node of this node's name has taken its place. Any thread may call this.
 */
bool isReplaced();

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_NAMESAKE_H
