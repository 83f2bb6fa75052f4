// Rounds of the event-driven clock: the members that are granted, when, and with which mail. No
// ROS, no sockets.
#pragma once

#include <cstdint>
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
  kWaiting,        // the same, but a report takes more than 1 s of wall time
  kLimited,        // the speed limit holds the next leap back
  kPaused,         // the present instant is finished, and time may not go on
  kStopped,        // time stands between two rounds, see RoundGate::stop()
  kIdle,           // no member has a wake-up
  kDeadlock,       // the same, but a member waits for something, see areStuck()
  kZeroDelayLoop,  // too many microsteps at one instant; no more grants
  kEnded
};

/**
 * @brief Decides which members are granted, when, and with which mail. It does not look into the
 * mail.
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
    // The member sends no report: its turns are played, in a window those before `time`, and then
    // RoundMembers::playNext() is called.
    bool is_played = false;
    std::optional<Nanoseconds> happened;  // up to it turns were played; no more will be
    std::string later;                    // encoded items, to be handled before the mail
  };

  struct Event {
    enum class Kind {
      kStarted,
      kSilent,    // `member` is silent; once per silence
      kAnswered,  // `member` has reported after a silence
      kTargetReached,
      kIdle,
      kDeadlock,
      kZeroDelayLoop
    };
    Kind kind;
    MemberId member = 0;
    Nanoseconds duration = 0;  // wall ns since the grant, for kSilent and kAnswered
  };

  /** @throws std::invalid_argument if some settings do not go together. */
  explicit LockstepRounds(const LockstepSettings& settings);
  LockstepRounds(const LockstepRounds&) = delete;
  LockstepRounds& operator=(const LockstepRounds&) = delete;

  /**
   * @brief Set the source of mail that arrives at known instants; time goes on for it. With a
   * lookahead, mail that is posted at an instant arrives when that is over, like all other mail.
   */
  void setArrivals(OutsideArrivals arrivals) { outside_ = std::move(arrivals); }

  // ---- parts ----
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
  /**
   * @brief Set the number of goals and calls that have reached a member and are not answered yet.
   */
  void setOwed(std::size_t answers) { owed_ = answers; }

  /**
   * @brief Take a member's report on its latest grant. @pre owes
   *
   * @param next the member's wake-up [ns, simulated], or kNever.
   * @param open the number of its threads that wait without a timeout for something owed to them.
   * @param played the first instant, after the present, of turns that are played in its place.
   * They count like granted turns, until @p next or another grant.
   */
  void report(MemberId id, Nanoseconds next, std::uint32_t open, Nanoseconds wall,
              Nanoseconds played = kNever);

  // ---- decisions ----
  /**
   * @return whether no member owes a report, so that actions may be applied and decide() called.
   */
  bool settled() const;
  /**
   * @return the grants to send now; none if time may not go on, or no member has anything to do.
   */
  std::vector<Grant> decide(Nanoseconds wall);
  /** @brief Look for silent members. decide() does not do this. */
  void watch(Nanoseconds wall);
  std::vector<Event> takeEvents();
  /**
   * @return the wall instant [ns] at which to call again even if nothing is received, or kNever.
   */
  Nanoseconds nextWake() const;
  /**
   * @brief Let decide() hand over what was sent so far, in a last round at this instant, and then
   * end the run. With a lookahead it is handed over at the instants at which it arrives.
   */
  void finish() { is_finishing_ = true; }
  /** @brief End the run: no member is granted any more. */
  void end() { gate_.end(clock_.time); }

  // ---- state ----
  Nanoseconds now() const { return clock_.now(); }
  bool started() const { return started_; }
  bool ended() const { return gate_.ended(); }
  /** @return whether the run ends after the present round, and what members send does not count. */
  bool isFinishing() const { return is_finishing_; }
  /**
   * @return whether time stands at an instant at which it would stand in every run of the same
   * system: no member has anything left to do, or the target of a step or run is reached.
   */
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
  std::vector<Grant> enterWindow(std::vector<MemberId> ids, Nanoseconds wall,
                                 std::vector<Grant> grants = {});
  std::vector<Grant> lastRound(Nanoseconds wall);
  std::vector<Grant> grant(std::vector<MemberId> ids, Nanoseconds wall);
  Grant grantOne(MemberId id, MemberState& member, Nanoseconds wall);
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
  bool is_finishing_ = false;
  bool idle_ = false;
  bool zero_delay_loop_ = false;
  Nanoseconds last_join_ = 0;  // wall
  std::vector<Event> events_;
};

}  // namespace move_base_abstract
