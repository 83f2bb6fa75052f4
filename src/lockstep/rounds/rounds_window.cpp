// Rounds with a lookahead: each member goes on by itself through a window of simulated time.
//
// What is sent at s arrives at s + lookahead, so that nothing done from `begin` on, the earliest
// instant at which anybody may do anything yet, reaches anybody before begin + lookahead. All whose
// next turn comes before that are granted at once. See docs/lockstep_windows.md.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "clock/time_master.h"
#include "rounds.h"

namespace move_base_abstract {

/** @return the instant of the member's next turn, as far as is known, or kNever. */
Nanoseconds LockstepRounds::nextOf(const MemberState& member) const {
  if (!member.present) {
    return kNever;
  }
  if (member.ready) {
    return std::max(member.latest, time_);
  }
  if (member.resting) {
    return member.latest;
  }
  return member.arrivals.empty() ? member.next : std::min(member.next, member.arrivals.front().at);
}

Nanoseconds LockstepRounds::windowBegin() const {
  Nanoseconds begin = kNever;
  bool counts = nextArrival() != kNever;
  for (const auto& [id, member] : members_) {
    const Nanoseconds next = nextOf(member);
    const bool is_reason =
        !member.background || member.ready || member.resting || !member.arrivals.empty();
    counts = counts || (next != kNever && is_reason);
    begin = std::min(begin, next);
  }
  return counts ? begin : kNever;
}

void LockstepRounds::walked(MemberId id, Nanoseconds instant) { at(id).latest = instant; }

void LockstepRounds::holdUntil(MemberId id, Nanoseconds instant) { at(id).held_until = instant; }

/** @brief What was sent at this instant arrives, in the stated order, when the lookahead is over.
 */
void LockstepRounds::endInstant() {
  const Nanoseconds arrival = addSaturated(now(), lookahead_);
  for (const MemberId id : posted_) {
    const auto found = members_.find(id);
    if (found == members_.end() || found->second.mail.empty()) {
      continue;
    }
    std::vector<Mail> mail;
    mail.swap(found->second.mail);
    mail_waiting_ -= mail.size();
    std::stable_sort(mail.begin(), mail.end(),
                     [this](const Mail& a, const Mail& b) { return before(a.order, b.order); });
    if (arrival > TimeMaster::kLastInstant) {
      continue;  // beyond the end of simulated time
    }
    found->second.arrivals.push_back({arrival, {}});
    for (const Mail& one : mail) {
      wire::append(found->second.arrivals.back().bytes, one.item);
    }
  }
  posted_.clear();
  applied_.reset();
}

void LockstepRounds::arriveUntil(Nanoseconds instant) {
  for (Nanoseconds due = nextArrival(); due != kNever && due <= instant; due = nextArrival()) {
    beginInstant(due);
    arrivals_.arrive();
    endInstant();
  }
}

/** @brief Once nobody can do anything before windowBegin() any more, and all that was done before
 * is applied. */
std::vector<LockstepRounds::Grant> LockstepRounds::nextWindow(Nanoseconds wall) {
  for (Nanoseconds due = nextArrival(); due < windowBegin(); due = nextArrival()) {
    if (!goTo(due, wall)) {
      return {};
    }
    arriveUntil(due);  // the window may begin sooner for it
  }
  const Nanoseconds begin = windowBegin();
  if (begin == time_) {
    if (isLoop()) {
      return {};
    }
    ++microstep_;
    return grantWindow(begin, wall);
  }
  const bool stays = !target_ || settings_.end_when_idle;
  if (begin == kNever && stays && !paused_) {  // it stands where the last one did something
    const Nanoseconds last = latest();
    microstep_ = last == time_ ? microstep_ : 0;
    time_ = last;
  }
  return goTo(begin, wall) ? grantWindow(begin, wall) : std::vector<Grant>{};
}

/** @return the instant of the latest turn that is known of anybody. */
Nanoseconds LockstepRounds::latest() const {
  Nanoseconds latest = time_;
  for (const auto& [id, member] : members_) {
    latest = std::max(latest, member.latest);
  }
  return latest;
}

/** @return up to which instant, itself included, turns may have been done. */
Nanoseconds LockstepRounds::present() const {
  if (!hasWindows()) {
    return time_;
  }
  return owing_ > 0 ? std::max(time_, window_end_ - 1) : latest();
}

/** @return the instant before which members may go on by themselves. */
Nanoseconds LockstepRounds::windowEnd(Nanoseconds begin) const {
  if (paused_ || restsAt(begin)) {
    return begin + 1;
  }
  const Nanoseconds last = std::min(target_.value_or(kNever), TimeMaster::kLastInstant);
  return std::min(addSaturated(begin, lookahead_), last + 1);
}

/** @return whether only those are left at @p begin who wait until nobody else has anything to do at
 * it. They are granted alone: what they look at is not to change meanwhile. */
bool LockstepRounds::restsAt(Nanoseconds begin) const {
  return std::all_of(members_.begin(), members_.end(), [this, begin](const auto& entry) {
    const MemberState& member = entry.second;
    return nextOf(member) > begin || (member.resting && !member.ready);
  });
}

std::vector<LockstepRounds::Grant> LockstepRounds::grantWindow(Nanoseconds begin,
                                                               Nanoseconds wall) {
  const Nanoseconds end = windowEnd(begin);
  const bool rests = restsAt(begin);
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_) {
    const bool is_resting = member.resting && !member.ready;
    if (nextOf(member) < end && is_resting == rests && member.held_until <= begin) {
      ids.push_back(id);
    }
  }
  std::sort(ids.begin(), ids.end(), [this](MemberId a, MemberId b) { return before(a, b); });
  ++rounds_;
  idle_ = false;
  window_end_ = end;
  granted_ = ids;
  ready_.clear();    // whoever is not granted now stays
  resting_.clear();  // ... as its own state says
  std::vector<Grant> grants;
  for (const MemberId id : ids) {
    grants.push_back(grantIn(id, end, wall));
  }
  const Nanoseconds limit = toNanoseconds(settings_.silence_limit);
  silence_check_ = limit == 0 ? kNever : addSaturated(wall, limit);
  return grants;
}

/** @return the grant of the member's next turn, and of those after it that come before @p end. */
LockstepRounds::Grant LockstepRounds::grantIn(MemberId id, Nanoseconds end, Nanoseconds wall) {
  MemberState& member = at(id);
  const Nanoseconds next = nextOf(member);
  Grant grant = grantOne(id, member, wall);
  grant.time = next;
  member.latest = next;
  member.window_end = end;
  wire::append(grant.later, wire::Window{end, lookahead_});
  Nanoseconds told = next;
  while (!member.arrivals.empty() && member.arrivals.front().at < end) {
    const Arrival& arrival = member.arrivals.front();
    if (arrival.at > told) {
      told = arrival.at;
      wire::append(grant.later, wire::Arrives{told});
    }
    grant.later += arrival.bytes;
    ++member.granted_mail;
    member.arrivals.pop_front();
  }
  return grant;
}

}  // namespace move_base_abstract
