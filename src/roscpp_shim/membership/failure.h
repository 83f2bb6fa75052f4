// Makes a node that has lost its run, or its name, end with an error, whatever its main function
// returns.
#pragma once

#include <string>

namespace move_base_abstract::lockstep::internal {

/** @brief Log a fatal line, and make the process end with exit code 1. */
void fail(const std::string& name, const std::string& reason);

/**
 * @brief Wait for up to 1 s of wall time, because a program that ends all processes may have ended
 * the time master first. @return whether a signal, or a shutdown of ROS, ends this process, too.
 */
bool awaitsOwnSignal();

/**
 * @brief Watch for the reason of a shutdown: the ROS master shuts a node down if another node takes
 * its name. Call this before ros::start().
 */
void watchForNamesake();

/**
 * @return whether another node of this node's name has taken its place. Any thread may call this.
 */
bool isReplaced();

}  // namespace move_base_abstract::lockstep::internal
