// What the participants that are granted are sent.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_GRANTS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_GRANTS_H

#include <string>
#include <vector>

#include "run.h"

namespace move_base_abstract {

class Grants {
 public:
  explicit Grants(LockstepRun& run) : run_(run) {}

  /** @brief Send them, and put in the place of a report what was told beforehand. */
  void send(const std::vector<LockstepRounds::Grant>& grants);
  /** @return who was to be sent more than a frame may hold, in words; '' if nobody was. */
  const std::string& tooMuch() const { return too_much_; }
  /** @return of the connections that owe the round's report, the one granted last; 0: none. */
  ConnectionId lastAwaited();

 private:
  void sendOne(const LockstepRounds::Grant& grant, SessionMember& member);

  LockstepRun& run_;
  std::vector<MemberId> granted_;  // of this round, in this order
  std::string too_much_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_GRANTS_H
