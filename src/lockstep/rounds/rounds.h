// Rounds of the event-driven clock: who is granted, when, with which mail. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUNDS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUNDS_H

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "gate.h"
#include "mail.h"
#include "members.h"
#include "settings.h"
#include "watch.h"
#include "windows.h"

namespace move_base_abstract {

enum class LockstepPhase {
  kWaitingForParticipants,
  kRunning,        // granted participants work
  kWaiting,        // the same, but one has not reported for more than 1 s of wall time
  kLimited,        // the speed limit holds the next leap back
  kPaused,         // the present instant is finished, and no leap is allowed
  kIdle,           // nobody wants to wake up ever
  kDeadlock,       // the same, but somebody waits for what is owed to it, see areStuck()
  kZeroDelayLoop,  // too many microsteps at one instant; no more grants
  kEnded
};

/** @return as in the state message: "waiting_for_participants", "running", ... */
const char* phaseName(LockstepPhase phase);

/**
 * @brief Who is granted when, and with what: knows members, times and mail, not what it means.
 *
 * `wall` arguments are monotonic wall instants in ns.
 */
class LockstepRounds {
 public:
  struct Grant {
    MemberId member;
    std::uint64_t round;
    Nanoseconds time;
    std::uint32_t microstep;
    std::vector<Mail> mail;  // in the order in which it is to be handled
    bool foreseen = false;  // a turn that the member's report has told already: it is not to report
    std::optional<std::uint32_t>
        happened;       // so many of the turns that it had foreseen; no more will
    std::string later;  // items, written out, to be handled ahead of the mail
  };

  struct Event {
    enum class Kind {
      kStarted,
      kSilent,    // of `member`; once per silence
      kAnswered,  // of `member`, after a silence
      kTargetReached,
      kIdle,
      kDeadlock,
      kZeroDelayLoop
    };
    Kind kind;
    MemberId member = 0;
    Nanoseconds duration = 0;  // wall ns since the grant, of kSilent and kAnswered
  };

  /** @throws std::invalid_argument if a setting is out of its range. */
  explicit LockstepRounds(const LockstepSettings& settings);
  LockstepRounds(const LockstepRounds&) = delete;
  LockstepRounds& operator=(const LockstepRounds&) = delete;

  /** @brief A reason for time to go on. With a lookahead, what is posted at an instant arrives when
   * that is over, as all else. */
  void setArrivals(OutsideArrivals arrivals) { outside_ = std::move(arrivals); }

  // ---- its parts ----
  RoundMembers& members() { return members_; }
  const RoundMembers& members() const { return members_; }
  RoundMail& mail() { return mail_; }
  RoundWindows& windows() { return windows_; }
  RoundGate& gate() { return gate_; }
  const RoundGate& gate() const { return gate_; }
  const RoundClock& clock() const { return clock_; }

  // ---- members ----
  void add(MemberId id, const std::string& name, std::int32_t rank, Nanoseconds wall);
  void remove(MemberId id);
  void knock(MemberId id);
  /** @brief So many goals and calls of members have reached others, who have not answered. */
  void setOwed(std::size_t answers) { owed_ = answers; }

  /**
   * @brief The report of its latest grant is in. @pre owes
   *
   * @param foreseen instants, ascending, after the present and before @p next, of turns whose
   * actions it has told. They come as granted ones do, unless another grant comes before.
   */
  void report(MemberId id, Nanoseconds next, std::uint32_t open, Nanoseconds wall,
              std::deque<Nanoseconds> foreseen = {});

  // ---- decisions ----
  /** @return whether nobody owes a report, so that actions may be applied and decide() called. */
  bool settled() const;
  /** @return those to grant now; nothing if time may not move, or nobody has anything to do. */
  std::vector<Grant> decide(Nanoseconds wall);
  /** @brief Look for silent ones. decide() does not. */
  void watch(Nanoseconds wall);
  std::vector<Event> takeEvents();
  /** @return the wall instant [ns] at which to call again even if nothing comes in, or kNever. */
  Nanoseconds nextWake() const;
  /** @brief Nobody is granted anything any more. */
  void end() { gate_.end(clock_.time); }

  // ---- what is so ----
  Nanoseconds now() const { return clock_.now(); }
  bool started() const { return started_; }
  bool ended() const { return gate_.ended(); }
  /** @return whether it stands where every run of the same would: nobody has anything left to do,
   * or the target of a step or run is reached. */
  bool atRest() const;
  LockstepPhase phase(Nanoseconds wall) const;
  /** @brief The members of the latest round, in the stated order. */
  const std::vector<MemberId>& latestRound() const { return watch_.granted(); }
  /** @return the named participants that are not there, in the order of the setting. */
  std::vector<std::string> missing() const { return members_.missing(settings_.participants); }

 private:
  bool mayStart(Nanoseconds wall) const;
  std::vector<Grant> start(Nanoseconds wall);
  std::vector<Grant> nextMicrostep(Nanoseconds wall);
  std::vector<Grant> leap(Nanoseconds wall);
  std::vector<MemberId> arrive();
  bool goTo(Nanoseconds next, Nanoseconds wall);
  bool isLoop();
  std::vector<Grant> nextWindow(Nanoseconds wall);
  std::vector<Grant> grantWindow(Nanoseconds begin, Nanoseconds wall);
  std::vector<Grant> grant(std::vector<MemberId> ids, Nanoseconds wall);
  Grant grantOne(MemberId id, MemberState& member, Nanoseconds wall);
  bool isForeseen(const MemberState& member) const;
  Nanoseconds nextTime() const;
  void becomeIdle();

  const LockstepSettings settings_;
  OutsideArrivals outside_;
  RoundClock clock_;
  RoundMembers members_;
  RoundMail mail_;
  RoundWindows windows_;
  RoundGate gate_;
  RoundWatch watch_;
  std::size_t owed_ = 0;  // answers
  bool started_ = false;
  bool idle_ = false;
  bool zero_delay_loop_ = false;
  Nanoseconds last_join_ = 0;  // wall
  std::vector<Event> events_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUNDS_H
