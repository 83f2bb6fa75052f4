// The run's secret from ROS parameters, for a participant.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_SECRET_PARAMETER_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_SECRET_PARAMETER_H

#include <ros/param.h>

#include <string>

#include "run_secret.h"

namespace move_base_abstract {

/**
 * @return the secret; '' if there is none. Call this when the time master is there, because it may
 * come with the parameters.
 * @throws std::invalid_argument, see runSecret().
 */
inline std::string secretOfRun() {
  std::string text, file;
  ros::param::get(kSecretParameter, text);
  ros::param::get(kSecretFileParameter, file);
  return runSecret(text, file);
}

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_SECRET_PARAMETER_H
