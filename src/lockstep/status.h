// The state of a session, for state messages and as texts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clock/number_text.h"
#include "clock/scaled_clock.h"
#include "interruption.h"
#include "labels.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/routing/router.h"
#include "member.h"

namespace move_base_abstract {

/** @brief What ended a run, as a code for programs. The reason is a text for people. */
namespace ended_by {
inline constexpr std::string_view kEndAt = "end_at";         // the setting
inline constexpr std::string_view kIdle = "idle";            // nothing was left to do
inline constexpr std::string_view kDeparture = "departure";  // of a node that end_with names
inline constexpr std::string_view kDeadlock = "deadlock";  // the same, but one waited for something
inline constexpr std::string_view kZeroDelayLoop = "zero_delay_loop";  // it stood in such a loop
inline constexpr std::string_view kOther = "other";
}  // namespace ended_by

/** @return the phase as in the state message: "waiting_for_participants", "running", ... */
const char* phaseName(LockstepPhase phase);

/** @brief The content of a state message. */
struct LockstepStatus {
  struct Waiting {
    std::string name;
    Nanoseconds since;  // wall ns; before the start: since the session began to wait
    std::string owes;   // "its HELLO", "the report of round 17 (3 messages, wake-up due)"
    std::string where;  // what its thread does, in its own words; '' if it is not known
    std::string told;   // the items of its latest grant; '' if they are not known
  };
  struct Participant {
    MemberId id;
    std::string name;
    std::string node_uri;
    std::int32_t rank;
    std::optional<Nanoseconds> next;  // simulated; nothing: never
    std::uint32_t open;               // threads that wait without a timeout
    std::string waits_for;            // its own words
    std::string tells;                // its own words: at which rates it sends, and to whom
    bool knocked;
    std::size_t mail;  // waiting for its next grant
    bool owes;
  };
  /** @brief A participant that has left or died while the run went on. */
  struct Departure {
    std::string name;
    Nanoseconds time;  // simulated
    bool died;         // its connection was lost, or it was dropped
  };
  /** @brief Goals of a participant on an action that have not ended. */
  struct OpenGoals {
    std::string client;
    std::string action;
    std::size_t count;
  };
  LockstepPhase phase;
  Nanoseconds time;  // simulated
  std::uint32_t microstep;
  bool paused;
  std::vector<Waiting> waiting_for;
  std::vector<Participant> participants;    // by rank, then name
  std::vector<std::string> not_repeatable;  // why; empty: the run is repeatable
  std::vector<std::string> degraded;        // why
  std::vector<Departure> departures;        // in their order; the first ones only
  std::vector<OpenGoals> open_goals;        // by client, then action
  std::string reason;                       // text about a deadlock, a zero-delay loop or the end
  std::string ended_by;                     // one of ended_by
  std::string ended_with;                   // the node whose departure ended the run; else ''
  bool ended_as_wished;                     // as end_when_idle, end_at or end_with say
  bool cut;      // ended from outside while there was something left to do: another run of the same
                 // may end elsewhere
  double limit;  // 0: none
  std::optional<Nanoseconds> run_until;  // simulated
  std::uint64_t rounds;
  std::uint64_t leaps;
  std::uint64_t messages;              // delivered between participants, one for each receiver
  std::uint64_t rows;                  // of the event log, so far
  std::uint64_t stops;                 // so far
  std::uint64_t stop_row;              // of the latest stop, from 1; 0: it was not at a row
  std::vector<std::string> looked_at;  // names, sorted
  std::string chaos;                   // chaosText()
};

/** @brief Makes texts about rounds and their members, which must outlive this object. */
class StatusText {
 public:
  StatusText(const LockstepRounds& rounds, const SessionMembers& members)
      : rounds_(rounds), members_(members) {}

  /** @return the present as a text, such as " at 12.5 s". */
  std::string at() const;
  /** @return the member's name; '' if it is not there. */
  std::string nameOf(MemberId id) const;
  std::string quoted(MemberId id) const { return quote(nameOf(id)); }
  /** @return what the member owes, such as "the report of round 17 (3 messages, wake-up due)". */
  std::string owed(const MemberState& member) const;
  /**
   * @return the text about a deadlock or a zero-delay loop, with the participants and the reason;
   * else ''.
   */
  std::string standstill(LockstepPhase phase, const OpenGoals& goals) const;
  /**
   * @return the text which says that no participant has anything left to do, and whose threads wait
   * for work.
   */
  std::string idle() const;
  /** @return the goals that have not ended. */
  std::vector<LockstepStatus::OpenGoals> openGoals(const OpenGoals& goals) const;
  /**
   * @brief Note that a participant has gone before the start, which still waits for it. @param how
   * the text that says how it went.
   */
  void keepDeparture(const std::string& name, const std::string& how) { departures_[name] = how; }
  /** @return the names that the start waits for, and the number of participants that are there. */
  std::string missing() const;
  /** @param began wall ns, when the session began to wait. */
  std::vector<LockstepStatus::Waiting> waitingFor(Nanoseconds began,
                                                  const Interruption& interruption,
                                                  const MessageRouter& router) const;
  /**
   * @return a text with the last ten items of the member's latest grant; '' if they are not known.
   */
  std::string told(MemberId id, const MessageRouter& router) const;
  std::vector<LockstepStatus::Participant> participants() const;

 private:
  std::string stuck(const OpenGoals& goals) const;
  std::vector<std::string> waiting() const;
  std::string describe(const wire::Deliver& item, MemberId id, const MessageRouter& router) const;
  std::string describe(const wire::CallIn& item, MemberId id, const MessageRouter& router) const;
  std::string describe(const wire::Answer& item, MemberId id, const MessageRouter& router) const;
  /** @return '' for news of links and services: no node works on that for long. */
  template <typename Other>
  std::string describe(const Other&, MemberId, const MessageRouter&) const {
    return "";
  }
  std::string latestRound() const;
  std::string departureOf(const std::string& name) const;

  const LockstepRounds& rounds_;
  const SessionMembers& members_;
  std::map<std::string, std::string> departures_;
};

}  // namespace move_base_abstract
