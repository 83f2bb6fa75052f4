// Who may take part, as whom, and who hears of it.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_JOINING_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_JOINING_H

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

  /** @throws wire::MalformedFrame unless it may take part. */
  void greet(ConnectionId id, const wire::Hello& hello);
  /** @brief A stranger is sent away. Thousands of them do not fill the log. */
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
  std::set<MemberId> used_ids_;  // of those that belong to named participants
  std::uint64_t refused_ = 0;    // connections
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_JOINING_H
