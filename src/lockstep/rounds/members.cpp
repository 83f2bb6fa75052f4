#include "members.h"

#include <algorithm>
#include <string_view>
#include <tuple>

namespace move_base_abstract {

MemberState& RoundMembers::add(MemberId id, const std::string& name, std::int32_t rank) {
  MemberState& member = members_[id];
  member.name = name;
  member.rank = rank;
  places_.add(id, name);
  return member;
}

void RoundMembers::gone(MemberId id) {
  MemberState& member = at(id);
  if (!member.present) {
    return;
  }
  member.present = false;
  setNext(id, member, kNever);
  member.played = member.after_played = kNever;
  member.open = member.idle = 0;
  if (member.owes) {
    settle(member);
  }
}

void RoundMembers::remove(MemberId id) {
  gone(id);
  members_.erase(id);
  places_.remove(id);
}

std::vector<std::string> RoundMembers::missing(const std::vector<std::string>& names) const {
  std::set<std::string_view> present;
  for (const auto& [id, member] : members_) {
    if (member.present) {
      present.insert(member.name);
    }
  }
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    if (present.count(name) == 0) {
      missing.push_back(name);
    }
  }
  return missing;
}

// ---- when members are granted ----------------------------------------------------------------

std::vector<MemberId> RoundMembers::begin(Nanoseconds now) {
  std::vector<MemberId> ids;
  for (auto& [id, member] : members_) {
    const Nanoseconds late = lateness_ ? lateness_(member) : 0;
    if (late > 0) {
      setNext(id, member, addSaturated(now, late));  // its first grant
    } else {
      member.ready = true;
      ids.push_back(id);
    }
  }
  return ids;
}

bool RoundMembers::isAnyToBegin() const {
  return std::any_of(members_.begin(), members_.end(), [](const auto& entry) {
    return entry.second.present && entry.second.round == 0;
  });
}

void RoundMembers::setNext(MemberId id, MemberState& member, Nanoseconds next) {
  if (member.next != kNever) {
    due_.erase({member.next, id});
  }
  member.next = next;
  if (next != kNever) {
    due_.insert({next, id});
  }
}

Nanoseconds RoundMembers::nextTime(Nanoseconds arrival) const {
  const auto counts = [this](const auto& due) { return !members_.at(due.second).background; };
  if (arrival == kNever && std::none_of(due_.begin(), due_.end(), counts)) {
    return kNever;
  }
  if (due_.empty() || arrival < due_.begin()->first) {
    return arrival;
  }
  return due_.begin()->first;
}

void RoundMembers::makeReady(MemberId id, MemberState& member) {
  if (!member.ready) {
    member.ready = true;
    ready_.push_back(id);
  }
}

void RoundMembers::dropGranted() {
  ready_.erase(std::remove_if(ready_.begin(), ready_.end(),
                              [this](MemberId id) {
                                const MemberState* member = find(id);
                                return !member || !member->ready;
                              }),
               ready_.end());
}

void RoundMembers::forgetLists() {
  ready_.clear();
  resting_.clear();
}

void RoundMembers::rest(MemberId id) {
  MemberState& member = at(id);
  if (!member.resting) {
    member.resting = true;
    resting_.push_back(id);
  }
}

/**
 * @brief Let all members that rest at this instant go on in one round: none of them must see what
 * another one does then.
 */
void RoundMembers::wakeResting() {
  const auto rests = [this](MemberId id) {
    const MemberState* member = find(id);
    return member != nullptr && member->present && member->resting;
  };
  // A member with unread mail gets that first, as it would have without keeping, and rests again.
  for (const MemberId id : resting_) {
    if (rests(id) && at(id).later_bytes > 0) {
      makeReady(id, at(id));
    }
  }
  if (!ready_.empty()) {
    return;
  }
  for (const MemberId id : resting_) {
    if (rests(id)) {
      makeReady(id, at(id));
    }
  }
  resting_.clear();
}

void RoundMembers::playNext(MemberId id, Nanoseconds next) {
  MemberState& member = at(id);
  member.played = next < member.after_played ? next : kNever;
  setNext(id, member, std::min(member.played, member.after_played));
}

/**
 * @brief Whether a member waits for something that is owed to it. A member that waits for work is
 * stuck only while an answer is owed, because it may be the one that has to give it.
 */
bool RoundMembers::areStuck(bool is_owed) const {
  return std::any_of(members_.begin(), members_.end(), [is_owed](const auto& entry) {
    const MemberState& member = entry.second;
    return (member.open > 0 && !member.waits_for_work) ||
           (member.open + member.idle > 0 && is_owed);
  });
}

// ---- the order of members --------------------------------------------------------------------

MailOrder RoundMembers::order(MemberId id, std::uint32_t sub, std::uint64_t number) const {
  const MemberState* member = find(id);
  return {member ? member->rank : 0, sub, places_.of(id), number};
}

void RoundMembers::sort(std::vector<MemberId>& ids) const {
  if (ids.size() < 2) {
    return;
  }
  std::vector<std::tuple<std::int32_t, std::uint32_t, MemberId>> keys;  // looked up once each
  keys.reserve(ids.size());
  for (const MemberId id : ids) {
    const MailOrder of = order(id, 0, 0);
    keys.emplace_back(of.rank, of.place, id);
  }
  std::sort(keys.begin(), keys.end());
  std::transform(keys.begin(), keys.end(), ids.begin(),
                 [](const auto& key) { return std::get<2>(key); });
}

}  // namespace move_base_abstract
