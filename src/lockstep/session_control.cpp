// What people ask of a session: the gate, stops, and what a debugger shows.
#include <algorithm>
#include <string>
#include <vector>

#include "clock/argument_check.h"
#include "clock/number_text.h"
#include "clock/shown_text.h"
#include "session.h"

namespace move_base_abstract {

void LockstepSession::pause() {
  run_.rounds.gate().pause();
  poll_due_ = true;
}

void LockstepSession::resume() {
  run_.rounds.gate().resume();
  keepEnd();
  poll_due_ = true;
}

Nanoseconds LockstepSession::step(Nanoseconds duration) {
  const Nanoseconds target = run_.rounds.gate().step(run_.rounds.windows().present(), duration);
  keepEnd();
  poll_due_ = true;
  return target;
}

void LockstepSession::runUntil(Nanoseconds target) {
  run_.rounds.gate().runUntil(run_.rounds.windows().present(), target);
  keepEnd();
  poll_due_ = true;
}

void LockstepSession::setLimit(double factor) {
  run_.rounds.gate().setLimit(factor);
  poll_due_ = true;
}

/** @brief Let time stop at end_at, whatever the gate was told. */
void LockstepSession::keepEnd() {
  const Nanoseconds end = toNanoseconds(run_.settings.end_at);
  if (end != 0) {
    run_.rounds.gate().pauseAtLatest(end);
  }
}

// ---- stops -----------------------------------------------------------------------------------

std::uint64_t LockstepSession::stopWhen(const StopCondition& condition) {
  run_.stops.check(condition);
  run_.rounds.gate().awaitStop(run_.rounds.windows().present(), condition.until);
  keepEnd();
  if (!condition.topic.empty()) {
    run_.traceDeliveries();
  }
  const bool is_between = run_.rounds.settled() && !poll_due_;  // reports that came are not applied
  run_.stops.await(condition, run_.rounds.clock().rounds, is_between);
  poll_due_ = true;
  return run_.stops.count() + 1;
}

/** @return whether the run stops after the round that was applied last. */
bool LockstepSession::stopsHere() {
  RoundGate& gate = run_.rounds.gate();
  const std::uint64_t round = run_.rounds.clock().rounds;
  if (!gate.awaitsStop() || run_.rounds.ended() || !run_.stops.isDueAfter(round)) {
    return false;
  }
  gate.stop();
  const double lookahead = run_.settings.lookahead;
  run_.stops.stopped(
      round, run_.text.at() + (lookahead == 0.0 ? ""
                                                : " (with the lookahead, nodes may be up to " +
                                                      numberText(lookahead) + " s further)"));
  return true;
}

std::string LockstepSession::reason() const {
  const RoundGate& gate = run_.rounds.gate();
  const std::string reason = end_.reason();
  return !reason.empty()         ? reason
         : gate.stopped()        ? run_.stops.why()
         : gate.holdsForOthers() ? held_for_
                                 : "";
}

void LockstepSession::setWall(Nanoseconds wall) {
  limits_.setWall(wall);
  run_.wall = limits_.now();
}

/**
 * @brief Let limits of wall time stand at a stop, and while a node works at which somebody looks.
 * (With limits that always stood for such a node, a speed limit would stop the run.)
 */
void LockstepSession::letLimitsStand() {
  bool stands = run_.rounds.gate().stopped();
  if (!run_.looked_at.empty()) {
    for (const auto& [id, member] : run_.rounds.members().all()) {
      stands = stands || (member.owes && run_.looked_at.count(member.name) != 0);
    }
  }
  limits_.stand(stands && run_.rounds.started() && !run_.rounds.ended());
  run_.wall = limits_.now();
}

void LockstepSession::look(const std::string& node, bool is_looking) {
  if (is_looking) {
    std::vector<std::string> names;
    for (const LockstepStatus::Participant& participant : run_.text.participants()) {
      names.push_back(participant.name);
    }
    if (std::find(names.begin(), names.end(), node) == names.end()) {
      refuse("looking: node must be a participant, got " + quote(node) +
             "; there are: " + joined(names));
    }
    run_.looked_at.insert(node);
  } else if (run_.looked_at.erase(node) == 0) {
    refuse("looking: nobody looks at " + quote(node));
  }
  poll_due_ = true;
}

std::vector<KeptMessages::One> LockstepSession::recent(const std::string& name,
                                                       const std::string& node,
                                                       std::size_t most) const {
  if (!run_.kept.areKept()) {
    refuse(
        "recent: no messages are kept; start the run with the parameter keep_messages, such as 10");
  }
  return run_.kept.recent(name, node, most);
}

}  // namespace move_base_abstract
