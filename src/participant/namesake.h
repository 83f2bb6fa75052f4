// Another node that takes this one's name: the ROS master then has this one shut down, and says
// why.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_NAMESAKE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_NAMESAKE_H

namespace move_base_abstract::lockstep::internal {

/** @brief Listen to why this node is shut down. Before ros::start(). */
void watchForNamesake();

/** @return whether another node of this one's name has taken its place. From any thread. */
bool isReplaced();

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_NAMESAKE_H
