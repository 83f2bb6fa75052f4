#include "windows.h"

#include <algorithm>
#include <utility>

namespace move_base_abstract {

Nanoseconds RoundWindows::ownNextOf(const MemberState& member) const {
  if (!member.present) {
    return kNever;
  }
  if (member.ready) {
    return std::max(member.latest, clock_.time);
  }
  if (member.resting) {
    return member.latest;
  }
  return member.arrivals.empty() ? member.after_played
                                 : std::min(member.after_played, member.arrivals.front().at);
}

Nanoseconds RoundWindows::begin() const {
  Nanoseconds begin = kNever;
  bool counts = outside_.next() != kNever;
  for (const auto& [id, member] : members_.all()) {
    const Nanoseconds next = nextOf(member);
    const bool is_reason =
        !member.background || member.ready || member.resting || !member.arrivals.empty();
    counts = counts || (next != kNever && is_reason);
    begin = std::min(begin, next);
  }
  return counts ? begin : kNever;
}

/**
 * @brief End the instant: mail that was sent at it arrives when the lookahead is over, in the
 * stated order.
 */
void RoundWindows::endInstant() {
  const Nanoseconds arrival = addSaturated(clock_.now(), lookahead_);
  for (const MemberId id : mail_.takePosted()) {
    MemberState* const member = members_.find(id);
    if (member == nullptr || member->mail.empty()) {
      continue;
    }
    const std::vector<Mail> mail = mail_.take(id, *member);
    if (arrival > kLastInstant) {
      continue;  // beyond the end of simulated time
    }
    member->arrivals.push_back({arrival, {}, hasNews(mail)});
    for (const Mail& one : mail) {
      wire::append(member->arrivals.back().bytes, one.item);
    }
  }
  clock_.applied.reset();
}

void RoundWindows::standAt(Nanoseconds instant) {
  clock_.microstep = instant == clock_.time ? clock_.microstep : 0;
  clock_.time = instant;
}

void RoundWindows::arriveUntil(Nanoseconds instant) {
  for (Nanoseconds due = outside_.next(); due != kNever && due <= instant; due = outside_.next()) {
    beginInstant(due);
    outside_.arrive();
    endInstant();
  }
}

/** @return the instant of the latest known turn of all members. */
Nanoseconds RoundWindows::latest() const {
  Nanoseconds latest = clock_.time;
  for (const auto& [id, member] : members_.all()) {
    latest = std::max(latest, member.latest);
  }
  return latest;
}

/** @return the latest instant at which turns may have been done. */
Nanoseconds RoundWindows::present() const {
  if (!areThere()) {
    return clock_.time;
  }
  return members_.owing() > 0 ? std::max(clock_.time, end_ - 1) : latest();
}

/** @return the instant before which members may go on by themselves. */
Nanoseconds RoundWindows::endOf(Nanoseconds begin, const RoundGate& gate) const {
  if (gate.paused() || restsAt(begin)) {
    return begin + 1;
  }
  const Nanoseconds last = std::min(gate.target().value_or(kNever), kLastInstant);
  return std::min(addSaturated(begin, lookahead_), last + 1);
}

/**
 * @return whether all members that are left at @p begin rest until no other member has anything to
 * do at it. They are granted alone, because what they look at must not change meanwhile.
 */
bool RoundWindows::restsAt(Nanoseconds begin) const {
  return std::all_of(members_.all().begin(), members_.all().end(), [this, begin](const auto& one) {
    const MemberState& member = one.second;
    return nextOf(member) > begin || (member.resting && !member.ready);
  });
}

std::vector<MemberId> RoundWindows::open(Nanoseconds begin, const RoundGate& gate) {
  end_ = endOf(begin, gate);
  const bool rests = restsAt(begin);
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_.all()) {
    const bool is_resting = member.resting && !member.ready;
    if (ownNextOf(member) < end_ && is_resting == rests && member.held_until <= begin) {
      ids.push_back(id);
    }
  }
  members_.sort(ids);
  members_.forgetLists();  // members that are not granted now keep their states
  return ids;
}

std::vector<std::pair<MemberId, Nanoseconds>> RoundWindows::played() const {
  std::vector<std::pair<MemberId, Nanoseconds>> played;
  for (const auto& [id, member] : members_.all()) {
    const Nanoseconds until = std::min(end_, ownNextOf(member));
    if (member.played < until) {
      played.emplace_back(id, until);
    }
  }
  return played;
}

std::vector<MemberId> RoundWindows::openLast() {
  std::vector<MemberId> ids;
  for (const auto& [id, member] : members_.all()) {
    const auto last = std::find_if(member.arrivals.rbegin(), member.arrivals.rend(),
                                   [](const Arrival& arrival) { return arrival.has_news; });
    if (member.present && last != member.arrivals.rend()) {
      ids.push_back(id);
      end_ = std::max(end_, last->at + 1);
    }
  }
  members_.sort(ids);
  members_.forgetLists();
  return ids;
}

/**
 * @brief Let the member go on at @p next, and by itself up to the end of the window.
 * @return the mail that arrives before that, as encoded items.
 */
std::string RoundWindows::enter(MemberState& member, Nanoseconds next) {
  member.latest = next;
  member.window_end = end_;
  std::string items;
  Nanoseconds told = next;
  while (!member.arrivals.empty() && member.arrivals.front().at < end_) {
    const Arrival& arrival = member.arrivals.front();
    if (arrival.at > told) {
      told = arrival.at;
      wire::append(items, wire::Arrives{told});
    }
    items += arrival.bytes;
    ++member.granted_mail;
    member.arrivals.pop_front();
  }
  return items;
}

}  // namespace move_base_abstract
