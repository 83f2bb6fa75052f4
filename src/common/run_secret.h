// The secret of a run, without which a program cannot take part in it. No ROS.
#pragma once

#include <cstddef>
#include <string>

namespace move_base_abstract {

/** @brief The parameters of the secret: its text, or a file that has it. */
constexpr const char* kSecretParameter = "/time_master/lockstep_secret";
constexpr const char* kSecretFileParameter = "/time_master/lockstep_secret_file";

constexpr std::size_t kLongestSecret = 1024;  // bytes

/**
 * @param text the parameter lockstep_secret; '' if it is not set.
 * @param file the parameter lockstep_secret_file; '' if it is not set.
 * @return the secret, without white space around it; '' if there is none.
 * @throws std::invalid_argument if both are set, if the secret is empty or longer than
 * kLongestSecret, or if the file is missing, belongs to another user, or can be used by others. The
 * text begins with the name of a parameter, without its namespace.
 */
std::string runSecret(const std::string& text, const std::string& file);

}  // namespace move_base_abstract
