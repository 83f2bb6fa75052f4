#include "mail.h"

#include <algorithm>

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLaterLimit = kNanosecondsPerSecond / 10;  // simulated; see postLater()
constexpr Nanoseconds kStoredLimit = kNanosecondsPerSecond;      // simulated; see keep()
// What is unread or stored for a member is not to fill the memory, nor a grant's frame.
constexpr std::size_t kMostKept = std::size_t{1} << 20;  // bytes

}  // namespace

void RoundMail::post(MemberId id, Mail mail) {
  MemberState* const found = members_.find(id);
  if (found == nullptr || !found->present) {
    return;
  }
  MemberState& member = *found;
  if (waits_) {
    posted_.push_back(id);
    member.mail.push_back(mail);
    ++waiting_;
    return;
  }
  const bool foresees = !member.foreseen.empty();  // its wake-ups are those of what it foresees
  if (mail.keep == Keep::kLater && !foresees) {
    postLater(id, member, mail);
    return;
  }
  const bool is_unread = mail.keep == Keep::kUnread && keeps_unread_;
  if (!foresees && (is_unread || mail.keep == Keep::kStored)) {
    posted_.push_back(id);
  } else {
    mail.keep = Keep::kNot;
    members_.makeReady(id, member);
  }
  member.mail.push_back(mail);
  ++waiting_;
}

/**
 * @brief Of the mail of the round that is over, keep what needs no grant.
 *
 * What is unread is looked at by threads of the receiver's, and all of them go on at its wake-ups
 * only: none notices when it is handed over. Where it has no wake-up, where time does not go on for
 * that, and from the instant on at which a thread of its goes on with any grant, it is mail like
 * any other. So the run is the same one, with fewer rounds.
 */
void RoundMail::keepPosted() {
  if (posted_.empty()) {
    return;
  }
  for (const MemberId id : takePosted()) {
    MemberState* const member = members_.find(id);
    if (member == nullptr || !member->present || member->ready) {
      continue;
    }
    if (mayKeep(*member)) {
      keep(id, *member);
    } else {
      members_.makeReady(id, *member);
    }
  }
}

bool RoundMail::mayKeep(const MemberState& member) const {
  const bool has_unread = std::any_of(member.mail.begin(), member.mail.end(),
                                      [](const Mail& mail) { return mail.keep == Keep::kUnread; });
  const bool wakes = member.next != kNever && !member.background && clock_.time < member.keep_until;
  return member.later_bytes < kMostKept && (wakes || !has_unread);
}

/** @brief Write out what @p member need not be granted for; what is stored waits a second at most.
 */
void RoundMail::keep(MemberId id, MemberState& member) {
  waiting_ -= member.mail.size();
  for (const Mail& mail : std::exchange(member.mail, {})) {
    const bool is_stored = mail.keep == Keep::kStored;
    if (is_stored) {
      members_.setNext(id, member, std::min(member.next, addSaturated(clock_.time, kStoredLimit)));
    }
    member.later.push_back({clock_.rounds, mail.order, {}, is_stored ? 0 : clock_.time});
    wire::append(member.later.back().bytes, mail.item);
    member.later_bytes += member.later.back().bytes.size();
  }
}

/**
 * @brief Keep @p mail for the receiver's next grant. So that a program that only looks at what has
 * come, by a clock that nobody sees, does so at its pace, there is one a tenth of a second later at
 * the latest.
 */
void RoundMail::postLater(MemberId id, MemberState& member, const Mail& mail) {
  if (member.later.empty()) {
    members_.setNext(id, member, std::min(member.next, addSaturated(clock_.time, kLaterLimit)));
  }
  member.later.push_back({clock_.rounds, mail.order, {}, 0});
  wire::append(member.later.back().bytes, mail.item);
}

void RoundMail::hurry(MemberId id) {
  MemberState& member = members_.at(id);
  if (!member.later.empty()) {
    members_.makeReady(id, member);
  }
}

std::vector<Mail> RoundMail::take(MemberId id, MemberState& member) {
  waiting_ -= member.mail.size();
  std::vector<Mail> mail;
  mail.swap(member.mail);
  if (arrange_) {
    arrange_(id, mail);
  } else {
    std::stable_sort(mail.begin(), mail.end(),
                     [](const Mail& a, const Mail& b) { return isBefore(a.order, b.order); });
  }
  return mail;
}

/** @return what had time, in the order in which it would have come. */
std::string RoundMail::takeLater(MemberState& member) {
  std::vector<LaterMail> later;
  later.swap(member.later);
  member.later_bytes = 0;
  std::stable_sort(later.begin(), later.end(), [](const LaterMail& a, const LaterMail& b) {
    return a.round != b.round ? a.round < b.round : isBefore(a.order, b.order);
  });
  std::string items;
  Nanoseconds told = clock_.time;
  const auto tell = [&](Nanoseconds came) {
    if (came != told) {
      wire::append(items, wire::Came{came});
      told = came;
    }
  };
  for (const LaterMail& mail : later) {
    tell(mail.came == 0 ? clock_.time : mail.came);
    items += mail.bytes;
  }
  tell(clock_.time);
  return items;
}

}  // namespace move_base_abstract
