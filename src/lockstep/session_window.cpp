// With a lookahead: what participants have done by themselves is applied instant by instant.
#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "session.h"

namespace move_base_abstract {

// ---- reports ---------------------------------------------------------------------------------

void LockstepSession::takeTurns(MemberId id, wire::Report report,
                                const std::shared_ptr<const std::string>& bytes) {
  Member& member = members_.at(id);
  const LockstepRounds::MemberState& state = *rounds_.find(id);
  std::deque<WalkedTurn> turns = takeWalked(report, bytes, state.latest, state.window_end);
  for (const WalkedTurn& walked : turns) {
    checkSets(member, walked.turn);
  }
  rounds_.walked(id, turns.back().at);
  rounds_.report(id, report.leaving ? kNever : report.next_ns, report.leaving ? 0 : report.open,
                 wall_);
  takeAtOnce(id, &turns);
  std::move(turns.begin(), turns.end(), std::back_inserter(member.walked));
}

/** @brief Take out of @p turns what does not wait until nobody can act before it any more: how the
 * participant stands after the last of them, and the parameters that it has set. */
void LockstepSession::takeAtOnce(MemberId id, std::deque<WalkedTurn>* turns) {
  Member& member = members_.at(id);
  for (WalkedTurn& walked : *turns) {
    std::vector<wire::ReportItem> kept;
    for (wire::ReportItem& item : walked.turn.items) {
      if (std::holds_alternative<wire::Rest>(item)) {
        rounds_.rest(id);
      } else if (std::holds_alternative<wire::Background>(item)) {
        rounds_.background(id);
      } else if (const auto* idle = std::get_if<wire::Idle>(&item)) {
        rounds_.idle(id, idle->count);
      } else if (const auto* set = std::get_if<wire::Parameter>(&item)) {
        sets_.push_back({walked.at, rounds_.order(id, 0, member.actions + sets_.size()),
                         member.name, walked.turn.frame, *set});
        rounds_.holdUntil(id, walked.at);  // it is to see what it has set
      } else {
        kept.push_back(item);
      }
    }
    walked.turn.items = std::move(kept);
  }
}

// ---- what is done ----------------------------------------------------------------------------

/** @return the first instant whose turns are not applied, or kNever. */
Nanoseconds LockstepSession::firstWalked() const {
  Nanoseconds first = kNever;
  for (const auto& [id, member] : members_) {
    first = member.walked.empty() ? first : std::min(first, member.walked.front().at);
  }
  return first;
}

/**
 * @brief Apply the turns of all instants before which nobody can have a turn any more, in the order
 * of time. If the run ends with one of them, the others are not done.
 */
void LockstepSession::applyWindow() {
  for (const MemberId id : std::exchange(changed_, {})) {
    members_.at(id).listed = false;
  }
  applyGone();
  Nanoseconds last = kNever;
  while (left_.empty() && !(is_strict_ && !labels_.first().empty())) {
    const Nanoseconds at = firstWalked();
    if (at == kNever || at >= rounds_.windowBegin()) {
      last = rounds_.windowBegin();
      break;
    }
    applyInstant(at);
    last = at;
  }
  applySets(last);
}

/** @brief Who has gone, and has no turn left that counts. */
void LockstepSession::applyGone() {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_) {
    if (member.departing && member.walked.empty()) {
      ids.push_back(id);
    }
  }
  if (ids.empty()) {
    return;
  }
  std::sort(ids.begin(), ids.end(), [this](auto a, auto b) { return rounds_.before(a, b); });
  rounds_.beginInstant(rounds_.now());
  for (const MemberId id : ids) {
    applyDeparture(id);
  }
  endOfTurns();
  rounds_.endInstant();
}

void LockstepSession::applyInstant(Nanoseconds at) {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_) {
    if (!member.walked.empty() && member.walked.front().at == at) {
      ids.push_back(id);
    }
  }
  std::sort(ids.begin(), ids.end(), [this](auto a, auto b) { return rounds_.before(a, b); });
  rounds_.beginInstant(at);
  for (const MemberId id : ids) {
    Member& member = members_.at(id);
    while (!member.walked.empty() && member.walked.front().at == at) {
      member.turn = std::move(member.walked.front().turn);
      member.walked.pop_front();
      applyTurn(id, member);
    }
    if (member.departing && member.walked.empty()) {
      applyDeparture(id);
    }
  }
  changed_.clear();  // who was dropped for what it has done has departed
  endOfTurns();
  rounds_.endInstant();
}

/** @brief The ROS master is told of what was set up to @p until, itself included. */
void LockstepSession::applySets(Nanoseconds until) {
  std::stable_sort(sets_.begin(), sets_.end(), [this](const WalkedSet& a, const WalkedSet& b) {
    return a.at != b.at ? a.at < b.at : rounds_.before(a.order, b.order);
  });
  const auto later = std::find_if(sets_.begin(), sets_.end(),
                                  [until](const WalkedSet& set) { return set.at > until; });
  for (auto set = sets_.begin(); set != later; ++set) {
    parameters_.change(set->by, set->item);
  }
  sets_.erase(sets_.begin(), later);
}

}  // namespace move_base_abstract
