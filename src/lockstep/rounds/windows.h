// Rounds with a lookahead: each member goes on by itself through a window of simulated time.
//
// What is sent at s arrives at s + lookahead, so that nothing done from `begin` on, the earliest
// instant at which anybody may do anything yet, reaches anybody before begin + lookahead. All whose
// next turn comes before that are granted at once. See docs/lockstep_windows.md.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_WINDOWS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_WINDOWS_H

#include <string>
#include <vector>

#include "clock/scaled_clock.h"
#include "gate.h"
#include "mail.h"
#include "members.h"

namespace move_base_abstract {

/** @brief The windows of a run. All instants are simulated [ns]. */
class RoundWindows {
 public:
  /** @param lookahead 0: there are none. */
  RoundWindows(RoundMembers& members, RoundClock& clock, RoundMail& mail,
               const OutsideArrivals& outside, Nanoseconds lookahead)
      : members_(members), clock_(clock), mail_(mail), outside_(outside), lookahead_(lookahead) {}

  bool areThere() const { return lookahead_ > 0; }
  /** @return the earliest instant at which any member may do anything yet, or kNever. */
  Nanoseconds begin() const;
  /** @brief Before report(): the last of the turns that it tells was at @p instant. */
  void walked(MemberId id, Nanoseconds instant) { members_.at(id).latest = instant; }
  /** @brief Grant @p id nothing before all have come to @p instant. */
  void holdUntil(MemberId id, Nanoseconds instant) { members_.at(id).held_until = instant; }
  /** @brief now() is @p instant, and what is posted was sent then, until endInstant(). */
  void beginInstant(Nanoseconds instant) { clock_.applied = instant; }
  void endInstant();
  /** @brief What comes from outside of rounds comes, up to @p instant, itself included. */
  void arriveUntil(Nanoseconds instant);

  // ---- of rounds ----
  /** @brief Open the window that begins at @p begin. @return those to grant, in their order. */
  std::vector<MemberId> open(Nanoseconds begin, const RoundGate& gate);
  Nanoseconds nextOf(const MemberState& member) const;
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
  Nanoseconds end_ = 0;  // of the latest one
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_WINDOWS_H
