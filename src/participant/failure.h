// A node that has lost its run ends with an error, whatever its main function returns.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_FAILURE_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_FAILURE_H

#include <string>

namespace move_base_abstract::lockstep::internal {

/** @brief Say so in a fatal line; the process ends with 1. */
void fail(const std::string& name, const std::string& reason);

/**
 * @brief Wait a moment (1 s of wall time): who ends all processes may have ended the time master
 * first.
 * @return whether a signal, or a shutdown of ROS, ends this process too.
 */
bool awaitsOwnSignal();

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_FAILURE_H
