// The secret of a run, which keeps strangers of the same machine out. No ROS.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_RUN_SECRET_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_RUN_SECRET_H

#include <cstddef>
#include <string>

namespace move_base_abstract {

/** @brief Parameters that name the secret: as a text, or as a file that has it. */
constexpr const char* kSecretParameter = "/time_master/lockstep_secret";
constexpr const char* kSecretFileParameter = "/time_master/lockstep_secret_file";

constexpr std::size_t kLongestSecret = 1024;  // bytes

/**
 * @param text the one parameter, '' if it is not set; @param file the other one.
 * @return the secret, without white space around it; '' if there is none.
 * @throws std::invalid_argument that begins with the name of a parameter (without its namespace):
 * both are set, or the file is missing, empty or too long, or not only its owner, who runs this
 * process, may read it.
 */
std::string runSecret(const std::string& text, const std::string& file);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_RUN_SECRET_H
