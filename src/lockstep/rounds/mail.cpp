#include "mail.h"

#include <algorithm>

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLaterLimit = kNanosecondsPerSecond / 10;  // simulated; see postLater()
constexpr Nanoseconds kStoredLimit = kNanosecondsPerSecond;      // simulated; see keep()
// Unread and stored mail of a member must not fill the memory or a grant's frame.
constexpr std::size_t kMostKept = std::size_t{1} << 20;  // bytes

}  // namespace

bool hasNews(const std::vector<Mail>& mail) {
  return std::any_of(mail.begin(), mail.end(), [](const Mail& one) {
    return std::holds_alternative<wire::Deliver>(one.item) ||
           std::holds_alternative<wire::CallIn>(one.item) ||
           std::holds_alternative<wire::Answer>(one.item);
  });
}

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
  const bool plays = member.played != kNever;  // its wake-ups are those of turns that are played
  if (mail.keep == Keep::kLater && !plays) {
    postLater(id, member, mail);
    return;
  }
  const bool is_unread = mail.keep == Keep::kUnread && keeps_unread_;
  if (!plays && (is_unread || mail.keep == Keep::kStored)) {
    posted_.push_back(id);
  } else {
    mail.keep = Keep::kNot;
    members_.makeReady(id, member);
  }
  member.mail.push_back(mail);
  ++waiting_;
}

/**
 * @brief Keep the mail of the finished round that needs no grant.
 *
 * Unread mail is read by threads of the receiver that go on at its wake-ups only, so none of them
 * notices when it is handed over. It is treated like other mail if the receiver has no wake-up, if
 * time does not go on for this wake-up, and from the instant on at which one of its threads goes on
 * with any grant. So the run stays the same, with fewer rounds.
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

/**
 * @brief Encode the mail of @p member, which needs no grant. Stored mail waits for a second at
 * most.
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
 * @brief Keep @p mail for the receiver's next grant, which comes a tenth of a simulated second
 * later at the latest. So a program that only looks for new messages, by a clock that the time
 * master does not see, can do so at its pace.
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

/** @return the kept mail as encoded items, in the order in which it would have come. */
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
