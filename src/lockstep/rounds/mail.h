// The mail that is kept for a member until its next grant. No ROS, no sockets.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "members.h"

namespace move_base_abstract {

/** @return whether there is a message, call or answer among @p mail. */
bool hasNews(const std::vector<Mail>& mail);

/** @brief The mail of a run's members, posted in the rounds of @p clock. */
class RoundMail {
 public:
  /**
   * @brief Brings mail from the order in which it was posted into the order in which it is to be
   * handled.
   */
  using Arrange = std::function<void(MemberId receiver, std::vector<Mail>& mail)>;

  /**
   * @param waits whether all mail waits until an instant is over, as with a lookahead.
   * @param keeps_unread whether unread mail is kept.
   */
  RoundMail(RoundMembers& members, const RoundClock& clock, bool waits, bool keeps_unread)
      : members_(members), clock_(clock), waits_(waits), keeps_unread_(keeps_unread) {}

  /** @brief Use @p arrange instead of the stated order. */
  void setArrange(Arrange arrange) { arrange_ = std::move(arrange); }
  /**
   * @brief Hand @p mail over with the next grant of @p id. Does nothing if this member is not
   * there.
   */
  void post(MemberId id, Mail mail);
  /** @brief Make the mail that is kept for @p id a reason for a grant. */
  void hurry(MemberId id);
  void keepPosted();
  /** @return the members with posted mail that is still to be looked at, and forget them. */
  std::vector<MemberId> takePosted() { return std::exchange(posted_, {}); }
  /** @return the mail that is a reason for a grant, in the order in which it is to be handled. */
  std::vector<Mail> take(MemberId id, MemberState& member);
  std::string takeLater(MemberState& member);
  /** @brief Forget the mail of @p member, which is removed. */
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
