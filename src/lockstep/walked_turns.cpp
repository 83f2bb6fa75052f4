// With a lookahead: what participants have done by themselves is applied instant by instant.

#include "walked_turns.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace move_base_abstract {
namespace {

/** @throws wire::MalformedFrame if what @p turn sets is no parameter. */
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
  const LockstepRounds::MemberState& state = *run_.rounds.find(id);
  std::deque<WalkedTurn> turns = takeWalked(report, bytes, state.latest, state.window_end);
  for (const WalkedTurn& walked : turns) {
    checkSets(member, walked.turn);
  }
  run_.rounds.walked(id, turns.back().at);
  run_.rounds.report(id, report.leaving ? kNever : report.next_ns, report.leaving ? 0 : report.open,
                     run_.wall);
  takeAtOnce(id, &turns);
  std::move(turns.begin(), turns.end(), std::back_inserter(member.walked));
}

/** @brief Take out of @p turns what does not wait until nobody can act before it any more: how the
 * participant stands after the last of them, and the parameters that it has set. */
void WalkedTurns::takeAtOnce(MemberId id, std::deque<WalkedTurn>* turns) {
  SessionMember& member = run_.members.at(id);
  for (WalkedTurn& walked : *turns) {
    std::vector<wire::ReportItem> kept;
    for (wire::ReportItem& item : walked.turn.items) {
      if (std::holds_alternative<wire::Rest>(item)) {
        run_.rounds.rest(id);
      } else if (std::holds_alternative<wire::Background>(item)) {
        run_.rounds.background(id);
      } else if (const auto* idle = std::get_if<wire::Idle>(&item)) {
        run_.rounds.idle(id, idle->count);
      } else if (const auto* set = std::get_if<wire::Parameter>(&item)) {
        sets_.push_back({walked.at, run_.rounds.order(id, 0, member.actions + sets_.size()),
                         member.name, walked.turn.frame, *set});
        run_.rounds.holdUntil(id, walked.at);  // it is to see what it has set
      } else {
        kept.push_back(item);
      }
    }
    walked.turn.items = std::move(kept);
  }
}

/** @return the first instant whose turns are not applied, or kNever. */
Nanoseconds WalkedTurns::first() const {
  Nanoseconds first = kNever;
  for (const auto& [id, member] : run_.members) {
    first = member.walked.empty() ? first : std::min(first, member.walked.front().at);
  }
  return first;
}

void WalkedTurns::apply() {
  for (const MemberId id : run_.changed.take()) {
    run_.members.at(id).listed = false;
  }
  if (departures_.areTogether()) {
    sets_.clear();
  }
  applyGone();
  Nanoseconds last = kNever;
  while (!end_.stopsTurns()) {
    const Nanoseconds at = first();
    if (at == kNever || at >= run_.rounds.windowBegin()) {
      last = run_.rounds.windowBegin();
      break;
    }
    run_.rounds.arriveUntil(at);
    applyInstant(at);
    last = at;
  }
  applySets(last);
}

/** @brief Who has gone, and has no turn left that counts. */
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
  std::sort(ids.begin(), ids.end(), [this](auto a, auto b) { return run_.rounds.before(a, b); });
  run_.rounds.beginInstant(run_.rounds.now());
  for (const MemberId id : ids) {
    departures_.apply(id);
  }
  turns_.finish();
  run_.rounds.endInstant();
}

void WalkedTurns::applyInstant(Nanoseconds at) {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : run_.members) {
    if (!member.walked.empty() && member.walked.front().at == at) {
      ids.push_back(id);
    }
  }
  std::sort(ids.begin(), ids.end(), [this](auto a, auto b) { return run_.rounds.before(a, b); });
  run_.rounds.beginInstant(at);
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
  run_.changed.clear();  // who was dropped for what it has done has departed
  turns_.finish();
  run_.rounds.endInstant();
}

/** @brief The ROS master is told of what was set up to @p until, itself included. */
void WalkedTurns::applySets(Nanoseconds until) {
  std::stable_sort(sets_.begin(), sets_.end(), [this](const WalkedSet& a, const WalkedSet& b) {
    return a.at != b.at ? a.at < b.at : run_.rounds.before(a.order, b.order);
  });
  const auto later = std::find_if(sets_.begin(), sets_.end(),
                                  [until](const WalkedSet& set) { return set.at > until; });
  for (auto set = sets_.begin(); set != later; ++set) {
    run_.parameters.change(set->by, set->item);
  }
  sets_.erase(sets_.begin(), later);
}

}  // namespace move_base_abstract
