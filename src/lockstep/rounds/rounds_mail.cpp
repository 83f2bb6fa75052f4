// What is kept for a member until its next grant, and what it has told beforehand.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "rounds.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLaterLimit = kNanosecondsPerSecond / 10;  // simulated; see postLater()
constexpr Nanoseconds kStoredLimit = kNanosecondsPerSecond;      // simulated; see keepMail()
// What is unread or stored for a member is not to fill the memory, nor a grant's frame.
constexpr std::size_t kMostKept = std::size_t{1} << 20;  // bytes

}  // namespace

void LockstepRounds::post(MemberId id, Mail mail) {
  const auto found = members_.find(id);
  if (found == members_.end() || !found->second.present) {
    return;
  }
  MemberState& member = found->second;
  if (hasWindows()) {
    posted_.push_back(id);
    member.mail.push_back(mail);
    ++mail_waiting_;
    return;
  }
  const bool foresees = !member.foreseen.empty();  // its wake-ups are those of what it foresees
  if (mail.keep == Keep::kLater && !foresees) {
    postLater(id, member, mail);
    return;
  }
  const bool is_unread = mail.keep == Keep::kUnread && settings_.keep_unread;
  if (!foresees && (is_unread || mail.keep == Keep::kStored)) {
    kept_.push_back(id);
  } else {
    mail.keep = Keep::kNot;
    makeReady(id, member);
  }
  member.mail.push_back(mail);
  ++mail_waiting_;
}

/**
 * @brief Of the mail of the round that is over, keep what needs no grant.
 *
 * What is unread is looked at by threads of the receiver's, and all of them go on at its wake-ups
 * only: none notices when it is handed over. Where it has no wake-up, where time does not go on for
 * that, and from the instant on at which a thread of its goes on with any grant, it is mail like
 * any other. So the run is the same one, with fewer rounds.
 */
void LockstepRounds::keepPosted() {
  std::vector<MemberId> ids;
  ids.swap(kept_);
  for (const MemberId id : ids) {
    const auto found = members_.find(id);
    if (found == members_.end() || !found->second.present || found->second.ready) {
      continue;
    }
    if (mayKeep(found->second)) {
      keepMail(id, found->second);
    } else {
      makeReady(id, found->second);
    }
  }
}

bool LockstepRounds::mayKeep(const MemberState& member) const {
  const bool has_unread = std::any_of(member.mail.begin(), member.mail.end(),
                                      [](const Mail& mail) { return mail.keep == Keep::kUnread; });
  const bool wakes = member.next != kNever && !member.background && time_ < member.keep_until;
  return member.later_bytes < kMostKept && (wakes || !has_unread);
}

/** @brief Write out what @p member need not be granted for; what is stored waits a second at most.
 */
void LockstepRounds::keepMail(MemberId id, MemberState& member) {
  mail_waiting_ -= member.mail.size();
  for (const Mail& mail : std::exchange(member.mail, {})) {
    const bool is_stored = mail.keep == Keep::kStored;
    if (is_stored) {
      setNext(id, member, std::min(member.next, addSaturated(time_, kStoredLimit)));
    }
    member.later.push_back({rounds_, mail.order, {}, is_stored ? 0 : time_});
    wire::append(member.later.back().bytes, mail.item);
    member.later_bytes += member.later.back().bytes.size();
  }
}

void LockstepRounds::keepUntil(MemberId id, Nanoseconds instant) { at(id).keep_until = instant; }

/**
 * @brief Keep @p mail for the receiver's next grant. So that a program that only looks at what has
 * come, by a clock that nobody sees, does so at its pace, there is one a tenth of a second later at
 * the latest.
 */
void LockstepRounds::postLater(MemberId id, MemberState& member, const Mail& mail) {
  if (member.later.empty()) {
    setNext(id, member, std::min(member.next, addSaturated(time_, kLaterLimit)));
  }
  member.later.push_back({rounds_, mail.order, {}, 0});
  wire::append(member.later.back().bytes, mail.item);
}

void LockstepRounds::hurry(MemberId id) {
  MemberState& member = at(id);
  if (!member.later.empty()) {
    makeReady(id, member);
  }
}

/** @brief All who rest at this instant go on at once: none is to see what another makes of it. */
void LockstepRounds::wakeResting() {
  const auto rests = [this](MemberId id) {
    const MemberState* member = find(id);
    return member != nullptr && member->present && member->resting;
  };
  // Who has something unread is handed that before, as it would have been, and rests anew.
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

/**
 * @brief What was under way comes, as a round of its own that nobody is granted: what is kept of it
 * comes after what was kept before.
 * @return those to grant for it that are not due anyway.
 */
std::vector<MemberId> LockstepRounds::arrive() {
  ++rounds_;
  ++played_;
  arrivals_.arrive();
  keepPosted();
  std::vector<MemberId> ids;
  for (const MemberId id : ready_) {
    const MemberState* const member = find(id);
    if (member != nullptr && member->ready && member->next > time_) {
      ids.push_back(id);
    }
  }
  return ids;
}

/** @return what had time, in the order in which it would have come. */
std::string LockstepRounds::takeLater(MemberState& member) {
  std::vector<LaterMail> later;
  later.swap(member.later);
  member.later_bytes = 0;
  std::stable_sort(later.begin(), later.end(), [this](const LaterMail& a, const LaterMail& b) {
    return a.round != b.round ? a.round < b.round : before(a.order, b.order);
  });
  std::string items;
  Nanoseconds told = time_;
  const auto tell = [&](Nanoseconds came) {
    if (came != told) {
      wire::append(items, wire::Came{came});
      told = came;
    }
  };
  for (const LaterMail& mail : later) {
    tell(mail.came == 0 ? time_ : mail.came);
    items += mail.bytes;
  }
  tell(time_);
  return items;
}

/** @return whether the turn that the member is to have now is one that it has told already. */
bool LockstepRounds::isForeseen(const MemberState& member) const {
  return !member.ready && !member.owes && !member.foreseen.empty() &&
         member.foreseen.front() <= time_;
}

void LockstepRounds::takeForeseen(MemberId id, MemberState& member) {
  member.foreseen.pop_front();
  ++*member.happened;
  setNext(id, member, member.foreseen.empty() ? member.after_foreseen : member.foreseen.front());
}

}  // namespace move_base_abstract
