// A participant, as a session knows it.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "connections.h"
#include "lockstep/rounds/order.h"
#include "played.h"

namespace move_base_abstract {

struct SessionMember {
  ConnectionId connection = 0;
  std::string name;
  std::string node_uri;
  std::string waits_for;          // its own words
  std::string tells;              // its own words: at which rates it sends, and to whom
  std::uint64_t actions = 0;      // so far
  PendingTurn turn;               // none if `frame` is null
  Played played;                  // what its latest report has played
  std::deque<WalkedTurn> walked;  // turns that must wait, as others may act before them
  bool departing = false;         // is removed when the round is over
  bool dead = false;              // ... as its connection was lost or dropped
  bool crashing = false;          // has said that it ends by its own doing
  std::string how;
  std::string granted;        // the items of its latest grant, if they are few
  std::string where;          // its own words, in the latest grant: what its thread does
  bool silence_told = false;  // in the latest grant
  bool input_told = false;
  bool has_changed = false;  // a parameter that it depends on, since its latest grant
  bool listed = false;       // has a report or departs
};

using SessionMembers = std::map<MemberId, SessionMember>;

/** @brief The members that have a report or depart, in the order of arrival. */
class ChangedMembers {
 public:
  void add(MemberId id, SessionMember& member) {
    if (!member.listed) {
      member.listed = true;
      ids_.push_back(id);
    }
  }
  std::vector<MemberId> take() { return std::exchange(ids_, {}); }
  /** @brief Forget all members, once they have departed. */
  void clear() { ids_.clear(); }
  bool empty() const { return ids_.empty(); }

 private:
  std::vector<MemberId> ids_;
};

}  // namespace move_base_abstract
