// Where a run is and how this node shows itself to it, as ROS's parameters say.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_JOINING_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_JOINING_H

#include <cstdint>
#include <optional>
#include <string>

#include "link.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {

constexpr const char* kModeParameter = "/time_master/mode";
constexpr const char* kLockstepMode = "lockstep";

/** @brief How a node presents itself. */
struct Presence {
  std::string name;
  std::string uri;                   // of the node's XML-RPC server
  std::optional<std::int32_t> rank;  // nothing: none is declared, and the time master gives one
};

/**
 * @brief Read what the node's own parameters say.
 * @param rank of the node if its program says so; else ~lockstep_rank does.
 * @throws Error where a parameter is bad.
 */
Presence readPresence(const std::optional<std::int32_t>& rank);

/**
 * @brief Connect @p link to the time master, which may still be starting.
 * @return false if ROS is shut down meanwhile.
 * @throws NotLockstep if the time master runs but is not in lockstep; Error for a bad address.
 */
bool connectToTimeMaster(const std::string& name, Link* link);

/** @return HELLO as a whole frame. @throws Error where the run's secret cannot be read. */
std::string helloOf(const Presence& presence);

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_JOINING_H
