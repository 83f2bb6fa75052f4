// A participant, as a session knows it.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_MEMBER_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_MEMBER_H

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "connections.h"
#include "lockstep/rounds/order.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief What was done in a turn and waits for its round's end, and the bytes that it points into.
 */
struct PendingTurn {
  std::shared_ptr<const std::string> frame;
  std::vector<wire::ReportItem> items;
};

/** @brief One of the turns that a participant has had by itself, with a lookahead. */
struct WalkedTurn {
  Nanoseconds at = 0;  // simulated
  PendingTurn turn;
};

struct SessionMember {
  ConnectionId connection = 0;
  std::string name;
  std::string node_uri;
  std::string waits_for;             // its own words
  std::string tells;                 // ... at which rates, and to whom
  std::uint64_t actions = 0;         // so far
  PendingTurn turn;                  // none where `frame` is null
  std::deque<PendingTurn> foreseen;  // those that its latest report told beforehand
  std::deque<WalkedTurn> walked;     // those that others may have turns before
  bool departing = false;            // goes when the round is over
  bool dead = false;                 // ... without having left
  std::string how;
  std::string granted;        // the items of its latest grant, where they are few
  std::string where;          // its own words, of the latest grant: what its thread is doing
  bool silence_told = false;  // of the latest grant
  bool input_told = false;
  bool has_changed = false;  // a parameter that it asks for, since its latest grant
  bool listed = false;       // has a report or departs
};

using SessionMembers = std::map<MemberId, SessionMember>;

/** @brief Who has a report or departs, in the order of arrival. */
class ChangedMembers {
 public:
  void add(MemberId id, SessionMember& member) {
    if (!member.listed) {
      member.listed = true;
      ids_.push_back(id);
    }
  }
  std::vector<MemberId> take() { return std::exchange(ids_, {}); }
  /** @brief Forget those that have departed. */
  void clear() { ids_.clear(); }
  bool empty() const { return ids_.empty(); }

 private:
  std::vector<MemberId> ids_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_MEMBER_H
