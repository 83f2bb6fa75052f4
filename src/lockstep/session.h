// The event-driven clock without sockets: bytes of connections in, bytes of connections out.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "clock/scaled_clock.h"
#include "connections.h"
#include "interruption.h"
#include "labels.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/routing/router.h"
#include "lockstep/wire/wire.h"
#include "member.h"
#include "message.h"
#include "parameters.h"
#include "round_log.h"
#include "shared_files.h"
#include "status.h"
#include "walked.h"

namespace move_base_abstract {

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
  using Output = ConnectionOutput;

  /** @throws std::invalid_argument if a setting is out of its range. */
  LockstepSession(const LockstepSettings& settings, Nanoseconds wall);
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
  std::size_t strangers() const { return connections_.strangers(); }
  /** @return of the connections that owe the round's report, the one granted last; 0: none. */
  ConnectionId lastAwaited();

  /** @return whether a participant is at the other end, also if it is about to leave. */
  bool takesPart(ConnectionId connection) const { return connections_.memberOf(connection) != 0; }
  std::uint64_t rounds() const { return rounds_.rounds(); }
  /** @return how many have not reported in the present round. */
  std::size_t owing() const { return rounds_.owing(); }
  bool ended() const { return rounds_.ended(); }

  Nanoseconds now() const { return rounds_.now(); }  // simulated
  std::uint32_t microstep() const { return rounds_.microstep(); }
  LockstepPhase phase() const { return rounds_.phase(wall_); }
  LockstepStatus status() const;

  /** @return log lines since the last call, by time, round and (rank, sub, name, number). */
  std::vector<LockstepLogEntry> takeLog();
  std::vector<LockstepMessage> takeMessages();
  /** @return what the ROS master is to be told before the output of the latest poll() is sent. */
  std::vector<ParameterChange> takeParameters() { return parameters_.take(); }
  /** @brief Somebody who takes no part has set or deleted a parameter of ROS. */
  void parameterChangedOutside(const std::string& name);
  /** @brief The ROS master has not taken what a participant has set or deleted. */
  void parameterNotTaken(const ParameterChange& change);

  // ---- the gate: leaps wait for it, the present instant does not. See LockstepRounds. ----
  void pause();
  void resume();
  Nanoseconds step(Nanoseconds duration);
  void runUntil(Nanoseconds target);
  void setLimit(double factor);

  /** @brief END to everybody; poll() gives it out. Reports of a round that is not over are lost. */
  void end(const std::string& reason);
  /** @brief end(), because the wall clock or somebody outside says so; see LockstepStatus::cut. */
  void endFromOutside(const std::string& reason);
  /** @brief End, and label, a run that has lost its ROS master. */
  void loseRosMaster(const std::string& how);

 private:
  using Member = SessionMember;
  using Level = LockstepMessage::Level;

  void take(ConnectionId id, const Connection& connection, std::string_view frame);
  void checkHello(const wire::Hello& hello) const;
  void hello(ConnectionId id, const wire::Hello& hello);
  void introduce(MemberId id, const std::string& welcome);
  void replaceOlder(std::string_view name);
  MemberId freshId(std::string_view name);
  void labelJoin(std::string_view name, bool rank_declared);
  void takeReport(MemberId id, std::string_view frame);
  void takeKnock(MemberId id);
  void takeLeave(MemberId id, const wire::Leave& leave);
  void takeStopping(MemberId id, const wire::Stopping& stopping);
  void takeBusy(MemberId id, const wire::Busy& busy);
  void beginInterruption(MemberId id);
  void keepLeft(MemberId id);
  bool heldByInterruption();
  void endTogether();
  void goOnWithoutSome();
  void degrade(const std::string& why);
  void endIfLabelled();
  void drop(ConnectionId id, const Connection& connection, const std::string& reason);
  void refuseConnection(ConnectionId id, const std::string& reason);
  void dropSilentStrangers();
  void depart(MemberId id, const std::string& how);
  void die(MemberId id, const std::string& how);
  void listChanged(MemberId id);
  bool goesOnWithout(MemberId id) const;

  void applyRound();
  void applyTurn(MemberId id, Member& member);
  void applyItem(MemberId id, Member& member, const wire::ReportItem& item);
  void takeTurns(MemberId id, wire::Report report, const std::shared_ptr<const std::string>& bytes);
  static void checkSets(const Member& member, const PendingTurn& turn);
  void takeAtOnce(MemberId id, std::deque<WalkedTurn>* turns);
  void applyWindow();
  void applyInstant(Nanoseconds at);
  void applyGone();
  void applySets(Nanoseconds until);
  void endOfTurns();
  Nanoseconds firstWalked() const;
  void applyNote(Member& member, const wire::Note& note);
  void noteChanged();
  void applyParameter(const Member& member, const wire::Parameter& item);
  void labelIf(const std::string& why);
  void applyDeparture(MemberId id);
  void finishRound();
  void sendGrants(const std::vector<LockstepRounds::Grant>& grants);
  void sendGrant(const LockstepRounds::Grant& grant, Member& member);
  void sayGone();
  void handleEvents();
  void handle(const LockstepRounds::Event& event);
  void handleSilence(const LockstepRounds::Event& event);
  void handleStandstill(const LockstepRounds::Event& event);
  void nameMissing();
  void keepEnd();
  void endAsWished(const std::string& reason);
  std::string reason() const;

  const LockstepSettings settings_;
  LockstepRounds rounds_;
  RoundLog log_;
  MessageRouter router_;
  Nanoseconds wall_;  // the latest
  const Nanoseconds began_;
  Nanoseconds missing_due_;  // wall
  MemberId last_id_;
  std::set<MemberId> used_ids_;  // of those that belong to named participants
  Connections connections_;
  std::uint64_t refused_ = 0;  // connections
  SessionMembers members_;
  StatusText text_;
  MessageList messages_;
  RunLabels labels_;
  SharedFiles files_;
  ParameterBook parameters_;
  std::vector<MemberId> granted_;     // of this round, in this order
  std::vector<MemberId> changed_;     // have a report or depart, in the order of arrival
  std::vector<PendingTurn> applied_;  // kept while mail points into them
  std::vector<WalkedSet> sets_;       // parameters that the ROS master has not been told
  std::vector<MemberId> gone_;        // GONE is due after the next grants
  std::vector<LockstepStatus::Departure> departures_;  // while the run went on
  std::string death_;                                  // on_death says that the run ends with it
  std::string left_;  // end_with says that the run ends with who left
  bool ended_as_wished_ = false;
  Interruption interruption_;
  bool rested_ = false;         // ... when the first of them was told to end
  bool cut_ = false;            // see LockstepStatus
  bool is_strict_;              // the first label ends the run
  bool ends_together_ = false;  // the lines of this round are nobody's
  std::string reason_;          // of the end
  bool poll_due_ = false;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H
