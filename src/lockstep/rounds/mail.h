// What is kept for a member until its next grant. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_MAIL_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_MAIL_H

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "members.h"

namespace move_base_abstract {

/** @brief The mail of a run's members, posted in the rounds of @p clock. */
class RoundMail {
 public:
  /** @brief Has mail as it was posted, and leaves it as it is to be handled. */
  using Arrange = std::function<void(MemberId receiver, std::vector<Mail>& mail)>;

  /**
   * @param waits whether all mail is looked at when an instant is over, as it is with a lookahead.
   * @param keeps_unread whether what is unread is kept.
   */
  RoundMail(RoundMembers& members, const RoundClock& clock, bool waits, bool keeps_unread)
      : members_(members), clock_(clock), waits_(waits), keeps_unread_(keeps_unread) {}

  /** @brief In the place of the stated order. */
  void setArrange(Arrange arrange) { arrange_ = std::move(arrange); }
  /** @brief Hand @p mail over with the next grant of @p id; nothing if it is not there. */
  void post(MemberId id, Mail mail);
  /** @brief What is kept for the next grant of @p id is now a reason for one. */
  void hurry(MemberId id);
  void keepPosted();
  /** @return who was posted something that is still to be looked at; they are forgotten. */
  std::vector<MemberId> takePosted() { return std::exchange(posted_, {}); }
  /** @return what is a reason for a grant, in the order in which it is to be handled. */
  std::vector<Mail> take(MemberId id, MemberState& member);
  std::string takeLater(MemberState& member);
  /** @brief @p member is removed with its mail. */
  void forget(const MemberState& member) { waiting_ -= member.mail.size(); }
  bool isWaiting() const { return waiting_ > 0; }

 private:
  void postLater(MemberId id, MemberState& member, const Mail& mail);
  bool mayKeep(const MemberState& member) const;
  void keep(MemberId id, MemberState& member);

  RoundMembers& members_;
  const RoundClock& clock_;
  const bool waits_;
  const bool keeps_unread_;
  Arrange arrange_;
  std::vector<MemberId> posted_;
  std::size_t waiting_ = 0;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_MAIL_H
