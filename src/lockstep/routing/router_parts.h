// Code that the parts of the router share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "lockstep/rounds/order.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract::router {

// Links open before, and close after, everything that the same participant sent in the round.
constexpr std::uint32_t kFirstSub = 0;
constexpr std::uint32_t kLastSub = std::numeric_limits<std::uint32_t>::max();

template <typename Entries>
auto findMember(Entries& entries, MemberId id) {
  return std::find_if(entries.begin(), entries.end(),
                      [id](const auto& entry) { return entry.member == id; });
}

/**
 * @return whether a message is kept for the receiver's next grant, if the receiver has chosen @p
 * what.
 */
inline Keep keepFor(wire::Delivery what, bool is_stored) {
  const Keep keep = what == wire::Delivery::kLater    ? Keep::kLater
                    : what == wire::Delivery::kUnread ? Keep::kUnread
                                                      : Keep::kNot;
  return keep == Keep::kNot && is_stored ? Keep::kStored : keep;
}

}  // namespace move_base_abstract::router
