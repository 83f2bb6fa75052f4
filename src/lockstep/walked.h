// Turns that a participant has had by itself, with a lookahead, and what comes of them later.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_WALKED_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_WALKED_H

#include <deque>
#include <memory>
#include <string>

#include "lockstep/rounds/order.h"
#include "lockstep/wire/wire.h"
#include "member.h"

namespace move_base_abstract {

/** @brief A parameter of ROS that was set, or deleted, in such a turn. */
struct WalkedSet {
  Nanoseconds at = 0;  // simulated
  MailOrder order;
  std::string by;                            // the node's name
  std::shared_ptr<const std::string> frame;  // that `item` points into
  wire::Parameter item;
};

/**
 * @return the turns of @p report, whose items are taken out; the first at @p begin, those after AT
 * items at their instants.
 * @param bytes what the report's items point into.
 * @throws wire::MalformedFrame where an instant is before that of the turn before it, or not before
 * @p end.
 */
std::deque<WalkedTurn> takeWalked(wire::Report& report,
                                  const std::shared_ptr<const std::string>& bytes,
                                  Nanoseconds begin, Nanoseconds end);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_WALKED_H
