// Turns that a report tells beforehand.
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
 * @brief Move what comes after the AT items of @p report out of it.
 *
 * @param bytes what the report's items point into.
 * @throws wire::MalformedFrame where an instant is not after the one before it (the first: after
 * @p now) and before the report's wake-up, where a turn does anything but send, or with a last
 * report.
 */
Foreseen takeForeseen(wire::Report& report, const std::shared_ptr<const std::string>& bytes,
                      Nanoseconds now);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_FORESEEN_H
