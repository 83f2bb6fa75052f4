// How participants join: which nodes may take part, with which number, and how the others learn of
// them.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include "departures.h"
#include "lockstep/wire/wire.h"
#include "run.h"

namespace move_base_abstract {

class Joining {
 public:
  Joining(LockstepRun& run, Departures& departures);

  /**
   * @brief Let the sender of @p hello join. @throws wire::MalformedFrame if it may not take part.
   */
  void greet(ConnectionId id, const wire::Hello& hello);
  /** @brief Refuse a connection that has not joined. Only some of many refusals are logged. */
  void refuse(ConnectionId id, const std::string& reason);
  void dropSilentStrangers();

 private:
  void check(const wire::Hello& hello) const;
  void introduce(MemberId id, const std::string& welcome);
  void replaceOlder(std::string_view name);
  MemberId freshId(std::string_view name);
  void label(std::string_view name, bool rank_declared);

  LockstepRun& run_;
  Departures& departures_;
  MemberId last_id_;
  std::set<MemberId> used_ids_;  // of the numbers of named participants
  std::uint64_t refused_ = 0;    // connections
};

}  // namespace move_base_abstract
