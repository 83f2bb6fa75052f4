// A participant, as a session knows it.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_MEMBER_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_MEMBER_H

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "connections.h"
#include "order.h"
#include "wire.h"

namespace move_base_abstract {

/** @brief A report that waits for the end of its round, and the bytes that it points into. */
struct PendingReport {
  std::unique_ptr<const std::string> frame;
  wire::Report report;
};

struct SessionMember {
  ConnectionId connection = 0;
  std::string name;
  std::string node_uri;
  std::string waits_for;      // its own words
  std::uint64_t actions = 0;  // so far
  PendingReport report;       // none where `frame` is null
  bool departing = false;     // goes when the round is over
  bool dead = false;          // ... without having left
  std::string how;
  bool input_told = false;
  bool listed = false;  // has a report or departs
};

using SessionMembers = std::map<MemberId, SessionMember>;

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_MEMBER_H
