// Lets time stand at its first instant until the nodes that look on are there.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lockstep_server.h"

namespace move_base_abstract {

/**
 * @brief Holds time at its first instant while participants want topics or services that none of
 * them provides, until all onlookers have registered, the services are there, and nothing has
 * happened for a wall second: so long latched messages may be under way. This takes 5 wall seconds
 * at most, since an onlooker may itself wait for time to go on.
 */
class OnlookerWait {
 public:
  /** @brief Hold time for these nodes; not if there are none. */
  void begin(LockstepServer& server, const std::vector<std::string>& names);
  /** @brief Look whether the wait is over. @param wall the present wall instant [ns]. */
  void work(LockstepServer& server, Nanoseconds wall);

 private:
  static void hold(LockstepServer& server, const std::string& what);
  bool look();
  std::string missing(const std::vector<std::string>& services) const;

  std::set<std::string> missing_;  // have not registered yet
  bool is_over_ = true;
  Nanoseconds due_ = 0;             // wall; of the next look
  Nanoseconds limit_ = kNever;      // wall
  Nanoseconds changed_ = 0;         // wall
  std::string seen_;                // all registrations, as text
  std::set<std::string> services_;  // that anybody offers
  std::uint64_t rounds_ = 0;
};

}  // namespace move_base_abstract
