// The event-driven clock without sockets: bytes of connections in, bytes of connections out.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "departures.h"
#include "grants.h"
#include "joining.h"
#include "run.h"
#include "run_end.h"
#include "silence.h"
#include "turns.h"
#include "walked_turns.h"

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

  /** @brief @p carrier says when messages, calls and responses arrive: with a lookahead, not before
   * that is over. To be called first. */
  void addCarrier(std::unique_ptr<Carrier> carrier) { run_.addCarrier(std::move(carrier)); }

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
  std::size_t strangers() const { return run_.connections.strangers(); }
  /** @return of the connections that owe the round's report, the one granted last; 0: none. */
  ConnectionId lastAwaited() { return grants_.lastAwaited(); }

  /** @return whether a participant is at the other end, also if it is about to leave. */
  bool takesPart(ConnectionId connection) const {
    return run_.connections.memberOf(connection) != 0;
  }
  std::uint64_t rounds() const { return run_.rounds.clock().rounds; }
  /** @return how many have not reported in the present round. */
  std::size_t owing() const { return run_.rounds.members().owing(); }
  bool ended() const { return run_.rounds.ended(); }

  Nanoseconds now() const { return run_.rounds.now(); }  // simulated
  std::uint32_t microstep() const { return run_.rounds.clock().microstep; }
  LockstepPhase phase() const { return run_.rounds.phase(run_.wall); }
  LockstepStatus status() const;

  /** @return log lines since the last call, by time, round and (rank, sub, name, number). */
  std::vector<LockstepLogEntry> takeLog() { return run_.log.take(); }
  /** @return how the links of the radio are; none if that is as at the last call, or there is none.
   */
  std::vector<LinkState> takeLinks() {
    return run_.radio != nullptr && run_.radio->takeNews() ? run_.radio->links(now())
                                                           : std::vector<LinkState>();
  }
  std::vector<LockstepMessage> takeMessages() { return run_.messages.take(); }
  /** @return what chaos has decided otherwise than the stated order since the last call. */
  std::vector<chaos::Decision> takeDecisions() { return run_.decisions.take(); }
  /** @return what the ROS master is to be told before the output of the latest poll() is sent. */
  std::vector<ParameterChange> takeParameters() { return run_.parameters.take(); }
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
  void end(const std::string& reason) { end_.end(reason); }
  /** @brief end(), because the wall clock or somebody outside says so; see LockstepStatus::cut. */
  void endFromOutside(const std::string& reason) { end_.endFromOutside(reason); }
  /** @brief End, and label, a run that has lost its ROS master. */
  void loseRosMaster(const std::string& how) { end_.loseRosMaster(how); }

 private:
  void take(ConnectionId id, const Connection& connection, std::string_view frame);
  void takeReport(MemberId id, std::string_view frame);
  void takeKnock(MemberId id);
  void drop(ConnectionId id, const Connection& connection, const std::string& reason);
  void finishRound();
  void handleEvents();
  void handle(const LockstepRounds::Event& event);
  void handleStandstill(const LockstepRounds::Event& event);
  void nameMissing();
  void labelIf(const std::string& why);
  void keepEnd();

  LockstepRun run_;
  RunEnd end_;
  Departures departures_;
  Joining joining_;
  Turns turns_;
  WalkedTurns walked_;
  Grants grants_;
  Silence silence_;
  const Nanoseconds began_;
  Nanoseconds missing_due_;  // wall
  bool poll_due_ = false;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_SESSION_H
