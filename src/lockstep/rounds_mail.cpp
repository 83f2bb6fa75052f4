// What is kept for a member until its next grant, and what it has told beforehand.
#include <algorithm>
#include <string>
#include <vector>

#include "rounds.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kLaterLimit = kNanosecondsPerSecond / 10;  // simulated; see postLater()

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
  if (mail.later && member.foreseen.empty()) {  // else its wake-ups are those of what it foresees
    postLater(id, member, mail);
    return;
  }
  if (!mail.waits) {
    makeReady(id, member);
  }
  member.mail.push_back(mail);
  ++mail_waiting_;
}

/**
 * @brief Keep @p mail for the receiver's next grant. So that a program that only looks at what has
 * come, by a clock that nobody sees, does so at its pace, there is one a tenth of a second later at
 * the latest.
 */
void LockstepRounds::postLater(MemberId id, MemberState& member, const Mail& mail) {
  if (member.later.empty()) {
    setNext(id, member, std::min(member.next, addSaturated(time_, kLaterLimit)));
  }
  member.later.push_back({rounds_, mail.order, {}});
  wire::append(member.later.back().bytes, mail.item);
}

void LockstepRounds::hurry(MemberId id) {
  MemberState& member = at(id);
  if (!member.later.empty()) {
    makeReady(id, member);
  }
}

/** @return what had time, in the order in which it would have come. */
std::string LockstepRounds::takeLater(MemberState& member) {
  std::vector<LaterMail> later;
  later.swap(member.later);
  std::stable_sort(later.begin(), later.end(), [this](const LaterMail& a, const LaterMail& b) {
    return a.round != b.round ? a.round < b.round : before(a.order, b.order);
  });
  std::string items;
  for (const LaterMail& mail : later) {
    items += mail.bytes;
  }
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
