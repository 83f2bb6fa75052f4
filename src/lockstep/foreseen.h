// Turns that a participant reports beforehand.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_FORESEEN_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_FORESEEN_H

#include <deque>
#include <memory>
#include <string>

#include "lockstep/wire/wire.h"
#include "member.h"

namespace move_base_abstract {

struct Foreseen {
  std::deque<Nanoseconds> instants;
  std::deque<PendingTurn> turns;  // as many
};

/**
 * @brief Take the AT items, and all items after them, out of @p report.
 *
 * @param bytes the bytes that the report's items point into.
 * @throws wire::MalformedFrame if an instant is not after the one before it (the first one: after
 * @p now), or not before the report's wake-up; if a turn does anything but send; or if this is a
 * last report.
 */
Foreseen takeForeseen(wire::Report& report, const std::shared_ptr<const std::string>& bytes,
                      Nanoseconds now);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_FORESEEN_H
