// Finds the run and presents this node to it, as ROS parameters say.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "link.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {

/** @brief The time master runs, but not in lockstep. */
class NotLockstep : public Error {
 public:
  using Error::Error;
};

constexpr const char* kModeParameter = "/time_master/mode";
constexpr const char* kLockstepMode = "lockstep";

/** @brief How a node presents itself. */
struct Presence {
  std::string name;
  std::string uri;                   // of the node's XML-RPC server
  std::optional<std::int32_t> rank;  // nothing: not declared; the time master chooses one
};

/**
 * @brief Read the node's own parameters.
 * @param rank the rank, if the program declares one; otherwise the parameter ~lockstep_rank counts.
 * @throws Error if a parameter is wrong.
 */
Presence readPresence(const std::optional<std::int32_t>& rank);

/**
 * @brief Connect @p link to the time master, which may still be starting.
 * @return false if ROS is shut down meanwhile.
 * @throws NotLockstep if the time master runs but is not in lockstep.
 * @throws Error if its address is wrong.
 */
bool connectToTimeMaster(const std::string& name, Link* link);

/** @return HELLO as a whole frame. @throws Error if the run's secret cannot be read. */
std::string helloOf(const Presence& presence);

}  // namespace move_base_abstract::lockstep::internal
