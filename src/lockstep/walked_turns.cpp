// With a lookahead: applies the turns that participants have had by themselves, instant by instant.

#include "walked_turns.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace move_base_abstract {
namespace {

/**
 * @brief Take the items out of @p report.
 * @param bytes the bytes that the report's items point into.
 * @param state its latest turn, and the end of its window.
 * @return the turns of the report, the first of which is at its latest turn, and the others at the
 * instants of AT items; and between these, what it has had played meanwhile.
 * @throws wire::MalformedFrame if an instant is before that of the previous turn, or not before the
 * end of the window; or as Played::takeItem() does.
 */
std::deque<WalkedTurn> takeWalked(wire::Report& report,
                                  const std::shared_ptr<const std::string>& bytes,
                                  const MemberState& state, Played& played, bool has_radio) {
  std::deque<WalkedTurn> turns;
  turns.push_back({state.latest, {bytes, {}}});
  for (wire::ReportItem& item : report.items) {
    const auto* const at = std::get_if<wire::At>(&item);
    if (at == nullptr) {
      if (!played.takeItem(item, bytes, turns.back().at, has_radio)) {
        turns.back().turn.items.push_back(item);
      }
      continue;
    }
    if (at->time_ns < turns.back().at || at->time_ns >= state.window_end) {
      throw wire::MalformedFrame("AT must be from " + secondsText(turns.back().at) +
                                 " on and before the end of the window, " +
                                 secondsText(state.window_end) + ", got " +
                                 secondsText(at->time_ns));
    }
    played.takeUntil(at->time_ns, &turns);
    played.stop();
    turns.push_back({at->time_ns, {bytes, {}}});
  }
  report.items.clear();
  return turns;
}

/** @throws wire::MalformedFrame if @p turn sets an invalid parameter. */
void checkSets(const SessionMember& member, const PendingTurn& turn) {
  for (const wire::ReportItem& item : turn.items) {
    if (const auto* set = std::get_if<wire::Parameter>(&item)) {
      if (const std::string fault = faultOf(member.name, *set); !fault.empty()) {
        throw wire::MalformedFrame(fault);
      }
    }
  }
}

}  // namespace

void WalkedTurns::take(MemberId id, wire::Report report,
                       const std::shared_ptr<const std::string>& bytes) {
  SessionMember& member = run_.members.at(id);
  const MemberState& state = *run_.rounds.members().find(id);
  std::deque<WalkedTurn> turns =
      takeWalked(report, bytes, state, member.played, run_.radio != nullptr);
  for (const WalkedTurn& walked : turns) {
    checkSets(member, walked.turn);
  }
  run_.rounds.windows().walked(id, turns.back().at);
  run_.rounds.report(id, report.leaving ? kNever : report.next_ns, report.leaving ? 0 : report.open,
                     run_.wall, report.leaving ? kNever : member.played.next());
  takeAtOnce(id, &turns);
  std::move(turns.begin(), turns.end(), std::back_inserter(member.walked));
}

/**
 * @brief Take the items out of @p turns that do not have to wait until no member can act before
 * them: the state of the participant after its last turn, and the parameters that it has set or
 * asked for. (What others set may be applied before this turn is, and it must be told of that.)
 */
void WalkedTurns::takeAtOnce(MemberId id, std::deque<WalkedTurn>* turns) {
  SessionMember& member = run_.members.at(id);
  for (WalkedTurn& walked : *turns) {
    std::vector<wire::ReportItem> kept;
    for (wire::ReportItem& item : walked.turn.items) {
      if (turns_.applyOwn(id, member, item)) {
        continue;
      }
      if (const auto* set = std::get_if<wire::Parameter>(&item)) {
        sets_.push_back({walked.at,
                         run_.rounds.members().order(id, 0, member.actions + sets_.size()),
                         member.name, walked.turn.frame, *set});
        run_.rounds.windows().holdUntil(id, walked.at);  // it must see the value that it has set
      } else {
        kept.push_back(item);
      }
    }
    walked.turn.items = std::move(kept);
  }
}

/** @return the first instant whose turns are not applied yet, or kNever. */
Nanoseconds WalkedTurns::first() const {
  Nanoseconds first = kNever;
  for (const auto& [id, member] : run_.members) {
    first = member.walked.empty() ? first : std::min(first, member.walked.front().at);
  }
  return first;
}

void WalkedTurns::apply() {
  if (run_.rounds.isFinishing()) {
    applyAfterEnd();
    return;
  }
  for (const MemberId id : run_.changed.take()) {
    run_.members.at(id).listed = false;
  }
  if (departures_.areTogether()) {
    sets_.clear();
  }
  applyGone();
  Nanoseconds last = run_.rounds.now();
  while (true) {
    const Nanoseconds at = first();
    if (end_.stopsTurns() && at != run_.rounds.now()) {
      break;
    }
    if (at == kNever || at >= run_.rounds.windows().begin()) {
      last = run_.rounds.windows().begin();
      break;
    }
    run_.rounds.windows().arriveUntil(at);
    applyInstant(at);
    last = at;
    if (end_.stopsTurns()) {
      run_.rounds.windows().standAt(at);
    }
  }
  applySets(last);
}

/** @brief Apply the turns in which participants heard what was under way when the run ended. */
void WalkedTurns::applyAfterEnd() {
  std::vector<MemberId> ids = run_.changed.take();
  run_.rounds.members().sort(ids);
  for (const MemberId id : ids) {
    SessionMember& member = run_.members.at(id);
    member.listed = false;
    while (!member.walked.empty()) {
      member.turn = std::move(member.walked.front().turn);
      member.walked.pop_front();
      turns_.applyOne(id, member);
    }
    if (member.departing) {
      departures_.apply(id);
    }
  }
  run_.changed.clear();
  turns_.finish();
}

/** @brief Remove the participants that have gone and have no turns left to apply. */
void WalkedTurns::applyGone() {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : run_.members) {
    if (member.departing && member.walked.empty()) {
      ids.push_back(id);
    }
  }
  if (ids.empty()) {
    return;
  }
  run_.rounds.members().sort(ids);
  run_.rounds.windows().beginInstant(run_.rounds.now());
  for (const MemberId id : ids) {
    departures_.apply(id);
  }
  turns_.finish();
  run_.rounds.windows().endInstant();
}

void WalkedTurns::applyInstant(Nanoseconds at) {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : run_.members) {
    if (!member.walked.empty() && member.walked.front().at == at) {
      ids.push_back(id);
    }
  }
  run_.rounds.members().sort(ids);
  run_.rounds.windows().beginInstant(at);
  for (const MemberId id : ids) {
    SessionMember& member = run_.members.at(id);
    while (!member.walked.empty() && member.walked.front().at == at) {
      member.turn = std::move(member.walked.front().turn);
      member.walked.pop_front();
      turns_.applyOne(id, member);
    }
    if (member.departing && member.walked.empty()) {
      departures_.apply(id);
    }
  }
  run_.changed.clear();  // members that were dropped for their turns have departed
  turns_.finish();
  run_.rounds.windows().endInstant();
}

/** @brief Pass on the parameters that were set up to and including @p until, for the ROS master. */
void WalkedTurns::applySets(Nanoseconds until) {
  std::stable_sort(sets_.begin(), sets_.end(), [](const Set& a, const Set& b) {
    return a.at != b.at ? a.at < b.at : isBefore(a.order, b.order);
  });
  const auto later =
      std::find_if(sets_.begin(), sets_.end(), [until](const Set& set) { return set.at > until; });
  for (auto set = sets_.begin(); set != later; ++set) {
    run_.parameters.change(set->by, set->item);
  }
  sets_.erase(sets_.begin(), later);
}

}  // namespace move_base_abstract
