// Sends the grants of a round to the participants.
#pragma once

#include <string>
#include <vector>

#include "run.h"

namespace move_base_abstract {

class Grants {
 public:
  explicit Grants(LockstepRun& run) : run_(run) {}

  /**
   * @brief Send the grants. A turn that was reported beforehand gets no grant: it takes the place
   * of a report.
   */
  void send(const std::vector<LockstepRounds::Grant>& grants);
  /**
   * @return a text that names a participant whose grant would not fit into a frame; '' if there was
   * none.
   */
  const std::string& tooMuch() const { return too_much_; }
  /**
   * @return the connection that was granted last, of those that still owe a report of this round;
   * 0: none.
   */
  ConnectionId lastAwaited();

 private:
  void play(const LockstepRounds::Grant& grant, SessionMember& member);
  void sendOne(const LockstepRounds::Grant& grant, SessionMember& member);

  LockstepRun& run_;
  std::vector<MemberId> granted_;  // of this round, in this order
  std::string too_much_;
};

}  // namespace move_base_abstract
