// Rounds with a lookahead: each member goes on by itself through a window of simulated time.
//
// A message that is sent at s arrives at s + lookahead. A window begins at the earliest instant at
// which any member may still act, so nothing that happens from there on reaches a member before
// begin + lookahead. All members whose next turn comes before that are granted at once. See
// docs/lockstep_windows.md.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "gate.h"
#include "mail.h"
#include "members.h"

namespace move_base_abstract {

/** @brief The windows of a run. All instants are simulated [ns]. */
class RoundWindows {
 public:
  /** @param lookahead the length of a window; 0: there are no windows. */
  RoundWindows(RoundMembers& members, RoundClock& clock, RoundMail& mail,
               const OutsideArrivals& outside, Nanoseconds lookahead)
      : members_(members), clock_(clock), mail_(mail), outside_(outside), lookahead_(lookahead) {}

  bool areThere() const { return lookahead_ > 0; }
  /** @return the latest window, as the members that are granted are told of it. */
  wire::Window latestWindow() const { return {end_, lookahead_}; }
  /** @return the earliest instant at which any member may still act, or kNever. */
  Nanoseconds begin() const;
  /**
   * @brief Note that the last turn in a report was at @p instant. Call this before
   * LockstepRounds::report().
   */
  void walked(MemberId id, Nanoseconds instant) { members_.at(id).latest = instant; }
  /** @brief Do not grant @p id before all members have come to @p instant. */
  void holdUntil(MemberId id, Nanoseconds instant) { members_.at(id).held_until = instant; }
  /**
   * @brief Make @p instant the present, until endInstant(): mail that is posted meanwhile was sent
   * then.
   */
  void beginInstant(Nanoseconds instant) { clock_.applied = instant; }
  void endInstant();
  /** @brief Make @p instant, of the last turn that counts, the present. */
  void standAt(Nanoseconds instant);
  /** @brief Let mail under way arrive that is due up to and including @p instant. */
  void arriveUntil(Nanoseconds instant);

  // ---- for the rounds ----
  /**
   * @brief Open the window that begins at @p begin. @return the members to grant, in their order.
   */
  std::vector<MemberId> open(Nanoseconds begin, const RoundGate& gate);
  /**
   * @brief Open a window for all mail that is still to arrive. @return the members to grant, in
   * their order; none if there is no such mail.
   */
  std::vector<MemberId> openLast();
  /** @return the instant of the member's next turn, as far as is known, or kNever. */
  Nanoseconds nextOf(const MemberState& member) const {
    return member.present ? std::min(member.played, ownNextOf(member)) : kNever;
  }
  /** @return the same, of the turns that it has itself. */
  Nanoseconds ownNextOf(const MemberState& member) const;
  /**
   * @return the members for which turns are played in the latest window, and the instant up to
   * which they are: that of the member's own next turn, or the window's end.
   */
  std::vector<std::pair<MemberId, Nanoseconds>> played() const;
  std::string enter(MemberState& member, Nanoseconds next);
  Nanoseconds latest() const;
  Nanoseconds present() const;

 private:
  Nanoseconds endOf(Nanoseconds begin, const RoundGate& gate) const;
  bool restsAt(Nanoseconds begin) const;

  RoundMembers& members_;
  RoundClock& clock_;
  RoundMail& mail_;
  const OutsideArrivals& outside_;
  const Nanoseconds lookahead_;
  Nanoseconds end_ = 0;  // of the latest window
};

}  // namespace move_base_abstract
