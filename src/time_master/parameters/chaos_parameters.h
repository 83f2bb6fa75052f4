// The time master's parameters of chaos, and the file of the decisions. No ROS.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "lockstep/chaos/decisions.h"
#include "lockstep/rounds/settings.h"

namespace move_base_abstract {

/**
 * @brief Read and check the parameters of chaos into @p lockstep, and the path of the new file into
 * @p decisions.
 * @throws std::invalid_argument if one is wrong; the text begins with its key.
 */
template <typename Reader>
void readChaos(Reader& reader, bool in_lockstep, LockstepSettings& lockstep,
               std::string& decisions) {
  int seed = 0;
  reader.read("chaos_seed", seed);
  if (seed != 0 && !in_lockstep) {
    throw std::invalid_argument(
        "chaos_seed must be 0 in mode scaled, where events have no stated order; got " +
        std::to_string(seed));
  }
  lockstep.chaos_seed = static_cast<std::uint32_t>(seed);
  reader.read("chaos_delay", lockstep.chaos_delay);
  reader.read("chaos_starts", lockstep.chaos_starts);
  std::vector<std::string> only;
  reader.read("chaos_only", only);
  for (const std::string& name : only) {
    lockstep.chaos_only += (lockstep.chaos_only.empty() ? "" : ",") + name;
  }
  reader.read("chaos_decisions", decisions);
  lockstep.keeps_decisions = !decisions.empty();
  chaos::decisionsOf(lockstep.chaos_only);
  if (in_lockstep) {
    checkedSettings(lockstep);
  }
}

/** @return the entry about chaos for the head of the event log, as JSON; '' without chaos. */
std::string chaosHead(const LockstepSettings& settings);

/**
 * @brief Write the new file, either whole or not at all. @return the text of an error; '' if there
 * was none.
 */
std::string writeDecisions(const std::string& path, const std::vector<chaos::Decision>& decisions);

}  // namespace move_base_abstract
