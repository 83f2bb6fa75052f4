// The event-driven clock without sockets: bytes of connections in, bytes of connections out.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "clock/scaled_clock.h"
#include "rounds.h"
#include "router.h"
#include "wire.h"

namespace move_base_abstract {

/** @brief A connection's number, chosen by the caller and never reused. */
using ConnectionId = std::uint64_t;

/** @brief A line of the event log. */
struct LockstepLogEntry {
  Nanoseconds time;    // simulated
  std::string robot;   // of a message or call: the topic's or service's name
  std::string kind;    // with log_messages also "message", "call", "response"
  std::string values;  // a JSON array
};

/** @brief Something for the user to read. */
struct LockstepMessage {
  enum class Level { kDebug, kInfo, kWarn, kError };
  Level level;
  std::string text;
};

/** @brief All that a state message tells. */
struct LockstepStatus {
  struct Waiting {
    std::string name;
    Nanoseconds since;  // wall ns; before the start: since the session began to wait
    std::string owes;   // "its HELLO", "the report of round 17 (3 messages, wake-up due)"
  };
  struct Participant {
    MemberId id;
    std::string name;
    std::string node_uri;
    std::int32_t rank;
    std::optional<Nanoseconds> next;  // simulated; nothing: never
    std::uint32_t open;               // application threads that wait without end
    std::string waits_for;            // its own words
    bool knocked;
    std::size_t mail;  // waiting for its next grant
    bool owes;
  };
  LockstepPhase phase;
  Nanoseconds time;  // simulated
  std::uint32_t microstep;
  bool paused;
  std::vector<Waiting> waiting_for;
  std::vector<Participant> participants;    // by rank, then name
  std::vector<std::string> not_repeatable;  // why; empty: the run is repeatable
  std::vector<std::string> degraded;        // why
  std::string reason;                       // of deadlock, zero-delay loop and end: who and why
  double limit;                             // 0: none
  std::optional<Nanoseconds> run_until;     // simulated
  std::uint64_t rounds;
  std::uint64_t leaps;
  std::uint64_t messages;  // delivered between participants, one for each receiver
};

/**
 * @brief A run of the event-driven clock: rounds, messages and their participants' connections.
 *
 * Feed it with connect(), received() and disconnected(), then call poll() and send what it gives;
 * call poll() at nextWake() even if nothing came in. Every `wall` is a monotonic wall instant in
 * ns. Nothing is decided outside poll(). Of several inputs before one poll() the result does not
 * depend on their order, but for the ids of participants that are not named in the settings.
 */
class LockstepSession {
 public:
  struct Output {
    ConnectionId connection;
    std::string bytes;
    bool close;  // after the bytes are sent; the connection is known no more
  };

  /** @throws std::invalid_argument if a setting is out of its range. */
  LockstepSession(const LockstepSettings& settings, Nanoseconds wall,
                  const LockstepRules& rules = {});
  LockstepSession(const LockstepSession&) = delete;
  LockstepSession& operator=(const LockstepSession&) = delete;

  /** @brief A new connection, which has 10 wall seconds to say HELLO. */
  void connect(ConnectionId connection, Nanoseconds wall);
  /** @brief Any piece of the connection's bytes; those of unknown connections are dropped. */
  void received(ConnectionId connection, std::string_view bytes, Nanoseconds wall);
  /** @brief The connection is lost, also if this was the session's wish. */
  void disconnected(ConnectionId connection, Nanoseconds wall);
  /** @brief Decide what can be decided. @return what to send, one entry per connection. */
  std::vector<Output> poll(Nanoseconds wall);
  /** @return the wall instant [ns] at which to poll next even if nothing comes in, or kNever. */
  Nanoseconds nextWake() const;

  /** @return how many connections have said no HELLO yet. */
  std::size_t strangers() const { return hello_due_.size(); }
  /** @return of the connections that owe the round's report, the one granted last; 0: none. */
  ConnectionId lastAwaited();

  Nanoseconds now() const { return rounds_.now(); }  // simulated
  std::uint32_t microstep() const { return rounds_.microstep(); }
  LockstepPhase phase() const { return rounds_.phase(wall_); }
  LockstepStatus status() const;

  /** @return log lines since the last call, by time, round and (rank, sub, name, number). */
  std::vector<LockstepLogEntry> takeLog();
  std::vector<LockstepMessage> takeMessages();

  // ---- the gate: leaps wait for it, the present instant does not. See LockstepRounds. ----
  void pause();
  void resume();
  Nanoseconds step(Nanoseconds duration);
  void runUntil(Nanoseconds target);
  void setLimit(double factor);

  /** @brief END to everybody; poll() gives it out. Reports of a round that is not over are lost. */
  void end(const std::string& reason);

 private:
  struct Connection {
    wire::FrameBuffer buffer;
    MemberId member = 0;  // 0: no HELLO yet
    std::string out;
    bool close = false;
    bool listed = false;  // is in outgoing_
  };
  /** @brief A report that waits for the end of its round, and the bytes that it points into. */
  struct PendingReport {
    std::unique_ptr<const std::string> frame;
    wire::Report report;
  };
  struct Member {
    ConnectionId connection = 0;
    std::string name;
    std::string node_uri;
    std::string waits_for;
    std::uint64_t actions = 0;  // so far
    PendingReport report;       // none where `frame` is null
    bool departing = false;     // goes when the round is over
    bool dead = false;          // ... without having left
    std::string how;
    bool input_told = false;
    bool listed = false;  // is in changed_
  };
  struct OrderedLog {
    MailOrder order;
    LockstepLogEntry entry;
  };
  using Level = LockstepMessage::Level;

  void take(ConnectionId id, Connection& connection, std::string_view frame);
  void hello(ConnectionId id, Connection& connection, const wire::Hello& hello);
  void checkHello(const wire::Hello& hello) const;
  void introduce(MemberId id);
  void replaceOlder(std::string_view name);
  MemberId freshId(std::string_view name);
  void takeReport(MemberId id, std::string_view frame);
  void takeKnock(MemberId id);
  void takeLeave(MemberId id, const wire::Leave& leave);
  void drop(ConnectionId id, const std::string& reason);
  void refuseConnection(ConnectionId id, const std::string& reason);
  void dropSilentStrangers();
  void depart(MemberId id, const std::string& how);
  void die(MemberId id, const std::string& how);
  void listChanged(MemberId id);
  void labelJoin(std::string_view name, bool rank_declared);
  void labelNotRepeatable(const std::string& why);
  void labelDegraded(const std::string& why);
  bool goesOnWithout(MemberId id) const;

  void applyRound();
  void applyReport(MemberId id, Member& member);
  void applyItem(MemberId id, Member& member, const wire::ReportItem& item);
  void applyNote(Member& member, const wire::Note& note);
  void applyLog(MemberId id, std::uint64_t number, const wire::Log& log);
  void applyDeparture(MemberId id);
  void trace(const MessageRouter::Delivery& delivery);
  void closeRoundLog();
  void sendGrants(const std::vector<LockstepRounds::Grant>& grants);
  void sayGone();
  void handleEvents();
  void handle(const LockstepRounds::Event& event);
  void handleSilence(const LockstepRounds::Event& event);
  void handleStandstill(const LockstepRounds::Event& event);
  void nameMissing();
  std::vector<Output> flush();

  void send(ConnectionId id, std::string_view bytes);
  void close(ConnectionId id, const std::string& reason);
  void list(ConnectionId id, Connection& connection);
  void say(Level level, const std::string& text);
  std::string at() const;
  std::string nameOf(MemberId id) const;
  std::string quoted(MemberId id) const;
  std::string owed(const LockstepRounds::MemberState& member) const;
  std::string stuck() const;
  std::string latestRound() const;
  std::string standstill() const;
  std::vector<LockstepStatus::Waiting> waitingFor() const;
  std::vector<LockstepStatus::Participant> participants() const;

  const LockstepSettings settings_;
  const LockstepRules rules_;
  LockstepRounds rounds_;
  MessageRouter router_;
  Nanoseconds wall_;  // the latest
  const Nanoseconds began_;
  Nanoseconds missing_due_;  // wall
  MemberId last_id_;
  std::set<MemberId> used_ids_;  // of those that belong to named participants
  std::map<ConnectionId, Connection> connections_;
  std::map<ConnectionId, Nanoseconds> hello_due_;  // wall; in the order of connecting
  std::uint64_t refused_ = 0;                      // connections
  std::map<MemberId, Member> members_;
  std::vector<ConnectionId> outgoing_;
  std::vector<MemberId> granted_;       // of this round, in this order
  std::vector<MemberId> changed_;       // have a report or depart, in the order of arrival
  std::vector<PendingReport> applied_;  // kept while mail points into them
  std::vector<MemberId> gone_;          // GONE is due after the next grants
  std::vector<OrderedLog> round_log_;
  std::vector<LockstepLogEntry> log_;
  std::vector<LockstepMessage> messages_;
  std::vector<std::string> not_repeatable_;
  std::vector<std::string> degraded_;
  std::string death_;  // on_death says that the run ends with it
  std::string reason_;
  bool poll_due_ = false;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H
