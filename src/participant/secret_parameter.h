// The run's secret as a participant's parameters say it.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_SECRET_PARAMETER_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_SECRET_PARAMETER_H

#include <ros/param.h>

#include <string>

#include "run_secret.h"

namespace move_base_abstract {

/**
 * @return the secret, '' if there is none. Ask when the time master is there, which may bring it.
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
