// Applies what participants do in their turns, in the stated order.
#include "turns.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "clock/shown_text.h"

namespace move_base_abstract {

void Turns::take(MemberId id, wire::Report report,
                 const std::shared_ptr<const std::string>& bytes) {
  const bool is_last = report.leaving;
  SessionMember& member = run_.members.at(id);
  std::vector<wire::ReportItem>& items = report.items;
  items.erase(std::remove_if(items.begin(), items.end(),
                             [&](const wire::ReportItem& item) {
                               if (std::holds_alternative<wire::At>(item)) {
                                 throw wire::MalformedFrame("AT must be in a window");
                               }
                               return member.played.takeItem(item, bytes, run_.rounds.now(),
                                                             run_.radio != nullptr);
                             }),
              items.end());
  run_.rounds.report(id, is_last ? kNever : report.next_ns, is_last ? 0 : report.open, run_.wall,
                     is_last ? kNever : member.played.next());
  member.turn = {bytes, std::move(report.items)};
}

/**
 * @return whether the turn of @p id affects the results of others' turns: links, services,
 * parameters.
 */
bool Turns::changesOthers(MemberId id) const {
  const SessionMember& member = run_.members.at(id);
  return member.departing ||
         std::any_of(member.turn.items.begin(), member.turn.items.end(), [](const auto& item) {
           return !std::holds_alternative<wire::Send>(item) &&
                  !std::holds_alternative<wire::Call>(item) &&
                  !std::holds_alternative<wire::Response>(item) &&
                  !std::holds_alternative<wire::Log>(item) &&
                  !std::holds_alternative<wire::Note>(item) &&
                  !std::holds_alternative<wire::Rest>(item) &&
                  !std::holds_alternative<wire::Background>(item) &&
                  !std::holds_alternative<wire::Idle>(item) &&
                  !std::holds_alternative<wire::KeepUntil>(item);
         });
}

/**
 * @return whether the item counts. In the last round participants hear what was sent before, and
 * what they send then reaches nobody. With a lookahead their own lines are later than the end, too.
 */
bool Turns::counts(const wire::ReportItem& item) const {
  return !run_.rounds.isFinishing() || std::holds_alternative<wire::Note>(item) ||
         std::holds_alternative<wire::Parameter>(item) ||
         (std::holds_alternative<wire::Log>(item) && !run_.rounds.windows().areThere());
}

void Turns::apply() {
  if (run_.changed.empty()) {
    return;
  }
  std::vector<MemberId> ids = run_.changed.take();
  run_.rounds.members().sort(ids);
  if (run_.order) {
    run_.order->arrangeTurns(ids, [this](MemberId id) { return changesOthers(id); });
  }
  for (const MemberId id : ids) {
    SessionMember& member = run_.members.at(id);
    member.listed = false;
    if (member.turn.frame) {
      applyOne(id, member);
    }
    if (member.departing) {
      departures_.apply(id);
    }
  }
  run_.changed.clear();  // members that were dropped for their reports have departed above
  finish();
}

void Turns::finish() {
  run_.router.finishRound();
  if (departures_.takeTogether()) {
    run_.log.dropRound();
  }
  run_.log.closeRound();
  for (const std::string& warning : run_.router.takeWarnings()) {
    run_.messages.say(LockstepMessage::Level::kWarn, warning);
  }
}

void Turns::applyOne(MemberId id, SessionMember& member) {
  PendingTurn pending = std::exchange(member.turn, PendingTurn());
  try {
    for (const wire::ReportItem& item : pending.items) {
      if (counts(item)) {
        applyItem(id, member, item);
      }
    }
  } catch (const MessageRouter::BadAction& error) {
    run_.connections.close(member.connection, error.what());
    departures_.die(id, std::string("it was dropped: ") + error.what());
    member.walked.clear();
  }
  applied_.push_back(std::move(pending));
}

void Turns::applyItem(MemberId id, SessionMember& member, const wire::ReportItem& item) {
  const std::uint64_t number = member.actions++;
  if (const auto* log = std::get_if<wire::Log>(&item)) {
    run_.log.add(run_.rounds.members().order(id, log->sub, number), *log);
  } else if (const auto* note = std::get_if<wire::Note>(&item)) {
    applyNote(member, *note);
  } else if (const auto* parameter = std::get_if<wire::Parameter>(&item)) {
    applyParameter(member, *parameter);
  } else if (const auto* keep = std::get_if<wire::KeepUntil>(&item)) {
    run_.rounds.members().keepUntil(id, keep->time_ns);
  } else if (const auto* motion = std::get_if<wire::Motion>(&item)) {
    applyMotion(id, member, *motion);
  } else if (!applyOwn(id, member, item)) {
    if (std::holds_alternative<wire::ChooseDelivery>(item)) {
      run_.rounds.mail().hurry(id);
    }
    run_.router.apply(id, number, item);
  }
}

bool Turns::applyOwn(MemberId id, const SessionMember& member, const wire::ReportItem& item) {
  if (std::holds_alternative<wire::Rest>(item)) {
    run_.rounds.members().rest(id);
  } else if (std::holds_alternative<wire::Background>(item)) {
    run_.rounds.members().background(id);
  } else if (const auto* idle = std::get_if<wire::Idle>(&item)) {
    run_.rounds.members().idle(id, idle->count);
  } else if (const auto* asks = std::get_if<wire::Asks>(&item)) {
    run_.labels.addIfAny(run_.parameters.asks(member.name, asks->name));
  } else {
    return false;
  }
  return true;
}

/** @throws MessageRouter::BadAction if @p item is not a valid parameter. */
void Turns::applyParameter(const SessionMember& member, const wire::Parameter& item) {
  if (const std::string fault = faultOf(member.name, item); !fault.empty()) {
    throw MessageRouter::BadAction(fault);
  }
  run_.parameters.change(member.name, item);
}

/** @throws MessageRouter::BadAction if @p motion is not valid. */
void Turns::applyMotion(MemberId id, const SessionMember& member, const wire::Motion& motion) {
  if (run_.radio == nullptr) {
    return;
  }
  try {
    run_.radio->move(id, motion, run_.rounds.now());
  } catch (const std::invalid_argument& error) {
    throw MessageRouter::BadAction(quote(member.name) + ": " + error.what());
  }
}

void Turns::applyNote(SessionMember& member, const wire::Note& note) {
  switch (note.what) {
    case wire::NoteKind::kWaitsFor:
      member.waits_for = shown(note.text);
      break;
    case wire::NoteKind::kTells:
      member.tells = shown(note.text);
      break;
    case wire::NoteKind::kNotRepeatable:
      run_.labels.addNotRepeatable(quote(member.name) + ": " + std::string(note.text));
      break;
    case wire::NoteKind::kDegraded:
      run_.labels.addDegraded(quote(member.name) + ": " + std::string(note.text));
      break;
    case wire::NoteKind::kStrict:
      end_.beStrict();
      break;
    case wire::NoteKind::kReads:
    case wire::NoteKind::kWrites:
      run_.labels.addIfAny(files_.add(member.name, note));
      break;
  }
}

void Turns::noteChangedParameters() {
  for (const std::string& name : run_.parameters.concerned()) {
    for (auto& [id, member] : run_.members) {
      member.has_changed = member.has_changed || member.name == name;
    }
  }
}

}  // namespace move_base_abstract
