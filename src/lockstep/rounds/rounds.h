// Rounds of the event-driven clock: who is granted, when, with which mail. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUNDS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUNDS_H

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "lockstep/wire/wire.h"
#include "order.h"
#include "settings.h"

namespace move_base_abstract {

/** @brief Whether mail is kept for the next grant that there is anyway (rounds_mail.cpp). */
enum class Keep {
  kNot,     // it is a reason for a grant
  kLater,   // hardly one: the receiver only puts it by
  kUnread,  // none before the receiver's wake-up, when it looks at what has come
  kStored   // the user says that it is hardly one
};

/** @brief Something to hand over with a receiver's next grant. */
struct Mail {
  MailOrder order;
  wire::GrantItem item;  // its texts and bytes are kept alive by whoever posted it
  Keep keep = Keep::kNot;
};

/** @brief What is handed over with a receiver's next grant, and is hardly a reason for one. */
struct LaterMail {
  std::uint64_t round = 0;  // in which it was posted
  MailOrder order;
  std::string bytes;     // the item, written out: it may stay for many rounds
  Nanoseconds came = 0;  // simulated, of what is unread; 0: nobody asks
};

/** @brief What a member is handed at an instant of its own, with a lookahead. */
struct Arrival {
  Nanoseconds at;
  std::string bytes;  // items, written out, in their order
};

enum class LockstepPhase {
  kWaitingForParticipants,
  kRunning,        // granted participants work
  kWaiting,        // the same, but one has not reported for more than 1 s of wall time
  kLimited,        // the speed limit holds the next leap back
  kPaused,         // the present instant is finished, and no leap is allowed
  kIdle,           // nobody wants to wake up ever
  kDeadlock,       // the same, but somebody waits for what is owed to it, see isStuck()
  kZeroDelayLoop,  // too many microsteps at one instant; no more grants
  kEnded
};

/** @return as in the state message: "waiting_for_participants", "running", ... */
const char* phaseName(LockstepPhase phase);

/**
 * @brief Who is granted when, and with what: knows members, times and mail, not what it means.
 *
 * `wall` arguments are monotonic wall instants in ns. A refused call throws std::invalid_argument,
 * says what it got and what is allowed, and changes nothing.
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

  struct MemberState {
    std::string name;
    std::int32_t rank = 0;
    Nanoseconds next = kNever;    // simulated
    std::uint32_t open = 0;       // application threads that wait without end for what is owed
    std::uint32_t idle = 0;       // those that wait without end for work that may come
    bool waits_for_work = false;  // it is declared: what it waits for is not owed to it
    bool knocked = false;
    bool present = true;  // false: it has gone, which counts when the round is over
    bool owes = false;    // the report of round `round`
    bool silence_told = false;
    std::uint64_t round = 0;       // of its latest grant
    Nanoseconds granted_wall = 0;  // of its latest grant
    std::uint32_t granted_mail = 0;
    bool granted_due = false;  // its wake-up was due with its latest grant
    std::vector<Mail> mail;
    std::vector<LaterMail> later;           // ahead of the mail
    std::size_t later_bytes = 0;            // of what is unread or stored in it
    Nanoseconds keep_until = kNever;        // what is unread is a reason for a grant from then on
    bool ready = false;                     // is in ready_
    bool resting = false;                   // is in resting_
    bool background = false;                // its wake-up alone is no reason for time to go on
    std::deque<Nanoseconds> foreseen;       // turns that its latest report told, still to come
    Nanoseconds after_foreseen = kNever;    // its wake-up after these
    std::optional<std::uint32_t> happened;  // of these; nothing if it told none
    // With a lookahead:
    std::deque<Arrival> arrivals;  // that it has not been told, the earliest first
    Nanoseconds latest = 0;        // instant of the latest turn that is known of it
    Nanoseconds window_end = 0;    // it may go on by itself before that
    Nanoseconds held_until = 0;    // not granted before all have come to this
  };

  /** @throws std::invalid_argument if a setting is out of its range. */
  explicit LockstepRounds(const LockstepSettings& settings);

  /** @brief What comes from outside of rounds, at instants that are known: mail under way. */
  struct Arrivals {
    std::function<Nanoseconds()> next_due;  // kNever: nothing; asked when a round is over
    std::function<void()> arrive;           // post all that is due by now()
  };
  /** @brief A reason for time to go on. With a lookahead, what is posted at an instant arrives when
   * that is over, as all else. */
  void setArrivals(Arrivals arrivals) { arrivals_ = std::move(arrivals); }
  /** @brief Has mail as it was posted, and leaves it as it is to be handled. */
  using Arrange = std::function<void(MemberId receiver, std::vector<Mail>& mail)>;
  /** @brief In the place of the stated order. */
  void setArrange(Arrange arrange) { arrange_ = std::move(arrange); }

  // ---- members ----
  void add(MemberId id, const std::string& name, std::int32_t rank, Nanoseconds wall);
  /** @brief It will not report any more; until remove() it still counts as a receiver. */
  void gone(MemberId id);
  void remove(MemberId id);
  void knock(MemberId id);
  /** @brief Grant it again when nobody has anything left to do at this instant, unless something
   * else comes before. */
  void rest(MemberId id);
  /** @brief Time does not go on for the wake-up alone that @p id has reported. */
  void background(MemberId id);
  /** @brief So many of its threads wait for work that may come: no deadlock
   * while no goal and no call is open. */
  void idle(MemberId id, std::uint32_t threads);
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
  /** @brief Hand @p mail over with the next grant of @p id; nothing if it is not there. */
  void post(MemberId id, Mail mail);
  /** @brief What is kept for the next grant of @p id is now a reason for one. */
  void hurry(MemberId id);
  /** @brief What @p id has not read is a reason for a grant from @p instant on: KEEP_UNTIL. */
  void keepUntil(MemberId id, Nanoseconds instant);

  // ---- with a lookahead: windows (rounds_window.cpp) ----
  bool hasWindows() const { return lookahead_ > 0; }
  /** @return the earliest instant at which any member may do anything yet, or kNever. */
  Nanoseconds windowBegin() const;
  /** @brief Before report(): the last of the turns that it tells was at @p instant. */
  void walked(MemberId id, Nanoseconds instant);
  /** @brief Grant @p id nothing before all have come to @p instant. */
  void holdUntil(MemberId id, Nanoseconds instant);
  /** @brief now() is @p instant, and what is posted was sent then, until endInstant(). */
  void beginInstant(Nanoseconds instant) { applied_ = instant; }
  void endInstant();
  /** @brief What comes from outside of rounds comes, up to @p instant, itself included. */
  void arriveUntil(Nanoseconds instant);

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

  // ---- gate; of pause, resume, step and runUntil the last one called wins ----
  void pause();
  void resume();
  /** @brief Run for @p duration [ns, simulated, > 0] from the present, or from the target of a step
   * still under way, and pause there. @return the target [ns]. */
  Nanoseconds step(Nanoseconds duration);
  void runUntil(Nanoseconds target);
  /** @brief At most @p factor simulated s per wall s (0.01 to 1e6); 0: no limit. */
  void setLimit(double factor);
  void end();

  // ---- what is so ----
  Nanoseconds now() const { return applied_.value_or(time_); }
  std::uint32_t microstep() const { return microstep_; }
  bool started() const { return started_; }
  bool ended() const { return ended_; }
  /** @return how many owe a report. */
  std::size_t owing() const { return owing_; }
  bool paused() const { return paused_; }
  /** @return whether it stands where every run of the same would: nobody has anything left to do,
   * or the target of a step or run is reached. */
  bool atRest() const;
  std::optional<Nanoseconds> target() const { return target_; }
  double limit() const;
  LockstepPhase phase(Nanoseconds wall) const;
  std::uint64_t rounds() const { return rounds_; }
  /** @return of these, those in which nobody was granted: all turns had been told beforehand. */
  std::uint64_t playedRounds() const { return played_; }
  std::uint64_t leaps() const { return leaps_; }
  bool mailWaiting() const { return mail_waiting_ > 0; }
  /** @brief The members of the latest round, in the stated order. */
  std::vector<MemberId> latestRound() const;
  const std::map<MemberId, MemberState>& members() const { return members_; }
  const MemberState* find(MemberId id) const;
  /** @return the named participants that are not there, in the order of the setting. */
  std::vector<std::string> missing() const;
  /** @brief Where an action of @p id comes. A member that joins or leaves moves the others' places:
   * keep none from one decision to the next. */
  MailOrder order(MemberId id, std::uint32_t sub, std::uint64_t number) const;
  /** @brief Whether @p a comes before @p b: by rank, then name. */
  bool before(MemberId a, MemberId b) const;
  /** @brief The stated order of mail and log entries. */
  bool before(const MailOrder& a, const MailOrder& b) const;

 private:
  enum class Gate { kOpen, kPaused, kLimited };

  MemberState& at(MemberId id);
  void postLater(MemberId id, MemberState& member, const Mail& mail);
  std::string takeLater(MemberState& member);
  bool mayKeep(const MemberState& member) const;
  void keepMail(MemberId id, MemberState& member);
  void keepPosted();
  void makeReady(MemberId id, MemberState& member);
  void wakeResting();
  bool mayStart(Nanoseconds wall) const;
  void setNext(MemberId id, MemberState& member, Nanoseconds next);
  std::vector<Grant> start(Nanoseconds wall);
  std::vector<Grant> nextMicrostep(Nanoseconds wall);
  std::vector<Grant> leap(Nanoseconds wall);
  std::vector<MemberId> arrive();
  Nanoseconds nextArrival() const { return arrivals_.next_due ? arrivals_.next_due() : kNever; }
  bool goTo(Nanoseconds next, Nanoseconds wall);
  bool isLoop();
  std::vector<Grant> nextWindow(Nanoseconds wall);
  std::vector<Grant> grantWindow(Nanoseconds begin, Nanoseconds wall);
  Grant grantIn(MemberId id, Nanoseconds end, Nanoseconds wall);
  Nanoseconds windowEnd(Nanoseconds begin) const;
  Nanoseconds nextOf(const MemberState& member) const;
  bool restsAt(Nanoseconds begin) const;
  Nanoseconds latest() const;
  Nanoseconds present() const;
  std::vector<Grant> grant(std::vector<MemberId> ids, Nanoseconds wall);
  Grant grantOne(MemberId id, MemberState& member, Nanoseconds wall);
  bool isForeseen(const MemberState& member) const;
  void takeForeseen(MemberId id, MemberState& member);
  Nanoseconds leapWall(Nanoseconds to) const;
  void moveTo(Nanoseconds to, Nanoseconds wall);
  Nanoseconds nextTime() const;
  void becomeIdle();
  bool isStuck() const;
  void refuseIfEnded(const char* call) const;

  LockstepSettings settings_;
  const Nanoseconds lookahead_;
  Arrivals arrivals_;
  Arrange arrange_;
  std::optional<Nanoseconds> applied_;  // the instant whose turns are being applied
  std::vector<MemberId> posted_;        // to these at that instant
  std::vector<MemberId> kept_;          // have mail of this round that may be kept
  Nanoseconds window_end_ = 0;          // of the latest one
  std::map<MemberId, MemberState> members_;
  NamePlaces places_;
  std::set<std::pair<Nanoseconds, MemberId>> due_;  // of those that have a finite wake-up
  std::vector<MemberId> ready_;                     // with mail, knocked, joined, or due now
  std::vector<MemberId> resting_;                   // for the end of this instant
  std::vector<MemberId> granted_;                   // of the latest round
  std::size_t owing_ = 0;
  std::size_t mail_waiting_ = 0;
  std::size_t owed_ = 0;  // answers
  Nanoseconds time_;
  std::uint32_t microstep_ = 0;
  bool started_ = false;
  bool ended_ = false;
  bool paused_;
  bool idle_ = false;
  bool zero_delay_loop_ = false;
  std::optional<Nanoseconds> target_;
  bool target_reached_ = false;  // ... and nobody has said anything else since
  FactorUnits limit_;
  Nanoseconds last_join_ = 0;           // wall
  Nanoseconds last_leap_ = 0;           // wall
  Nanoseconds silence_check_ = kNever;  // wall
  bool held_by_limit_ = false;
  std::uint64_t rounds_ = 0;
  std::uint64_t played_ = 0;
  std::uint64_t leaps_ = 0;
  std::vector<Event> events_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ROUNDS_H
