// Turns that a participant has had by itself in a window, and that are applied later ("walked"
// turns).
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_WALKED_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_WALKED_H

#include <deque>
#include <memory>
#include <string>

#include "lockstep/rounds/order.h"
#include "lockstep/wire/wire.h"
#include "member.h"

namespace move_base_abstract {

/** @brief A ROS parameter that was set or deleted in such a turn. */
struct WalkedSet {
  Nanoseconds at = 0;  // simulated
  MailOrder order;
  std::string by;                            // the node's name
  std::shared_ptr<const std::string> frame;  // that `item` points into
  wire::Parameter item;
};

/**
 * @brief Take the items out of @p report.
 * @param bytes the bytes that the report's items point into.
 * @return the turns of the report: the first at @p begin, the others at the instants of AT items.
 * @throws wire::MalformedFrame if an instant is before that of the previous turn, or not before @p
 * end.
 */
std::deque<WalkedTurn> takeWalked(wire::Report& report,
                                  const std::shared_ptr<const std::string>& bytes,
                                  Nanoseconds begin, Nanoseconds end);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_WALKED_H
