// The event-driven clock without sockets: it takes and gives the bytes of connections.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "departures.h"
#include "grants.h"
#include "joining.h"
#include "lockstep/rounds/limits_clock.h"
#include "run.h"
#include "run_end.h"
#include "silence.h"
#include "turns.h"
#include "walked_turns.h"

namespace move_base_abstract {

/**
 * @brief A run of the event-driven clock: its rounds, its messages, and the connections of its
 * participants.
 *
 * Call connect(), received() and disconnected() for inputs, then call poll() and send the bytes
 * that it returns. Call poll() at nextWake(), too, even without an input. Every `wall` is a
 * monotonic wall instant in ns. Nothing is decided outside poll(). The result does not depend on
 * the order of the inputs before one poll(), except for the ids of participants that are not named
 * in the settings.
 */
class LockstepSession {
 public:
  using Output = ConnectionOutput;

  /** @throws std::invalid_argument if some settings do not go together. */
  LockstepSession(const LockstepSettings& settings, Nanoseconds wall);
  LockstepSession(const LockstepSession&) = delete;
  LockstepSession& operator=(const LockstepSession&) = delete;

  /**
   * @brief Add a carrier, which decides when messages, calls and responses arrive; with a
   * lookahead, not before that is over. Call this first.
   */
  void addCarrier(std::unique_ptr<Carrier> carrier) { run_.addCarrier(std::move(carrier)); }

  /** @brief Take a new connection. It has 10 wall seconds to say HELLO. */
  void connect(ConnectionId connection, Nanoseconds wall);
  /** @brief Take any piece of a connection's bytes. Bytes of unknown connections are ignored. */
  void received(ConnectionId connection, std::string_view bytes, Nanoseconds wall);
  /** @brief Note that a connection is lost or closed, also if the session has closed it. */
  void disconnected(ConnectionId connection, Nanoseconds wall);
  /** @brief Decide what can be decided. @return the bytes to send, one entry per connection. */
  std::vector<Output> poll(Nanoseconds wall);
  /** @return the wall instant [ns] at which to call poll() even without an input, or kNever. */
  Nanoseconds nextWake() const;

  /** @return the number of connections that have not said HELLO yet. */
  std::size_t strangers() const { return run_.connections.strangers(); }
  /**
   * @return the connection that was granted last, of those that still owe a report of this round;
   * 0: none.
   */
  ConnectionId lastAwaited() { return grants_.lastAwaited(); }

  /** @return whether the connection is that of a participant, also if it is about to leave. */
  bool takesPart(ConnectionId connection) const {
    return run_.connections.memberOf(connection) != 0;
  }
  std::uint64_t rounds() const { return run_.rounds.clock().rounds; }
  /** @return the number of participants that still owe a report of this round. */
  std::size_t owing() const { return run_.rounds.members().owing(); }
  bool ended() const { return run_.rounds.ended(); }

  Nanoseconds now() const { return run_.rounds.now(); }  // simulated
  std::uint32_t microstep() const { return run_.rounds.clock().microstep; }
  LockstepPhase phase() const { return run_.rounds.phase(run_.wall); }
  /** @return the instant [ns] of the clock by which limits count, which stands at a stop. */
  Nanoseconds limitsNow(Nanoseconds wall) {
    setWall(wall);
    return run_.wall;
  }
  LockstepStatus status() const;

  /**
   * @return the log lines since the last call, sorted by time, round and (rank, sub, name, number).
   */
  std::vector<LockstepLogEntry> takeLog() { return run_.log.take(); }
  /**
   * @return the states of the radio's links; empty if nothing has changed since the last call, or
   * there is no radio.
   */
  std::vector<LinkState> takeLinks() {
    return run_.radio != nullptr && run_.radio->takeNews() ? run_.radio->links(now())
                                                           : std::vector<LinkState>();
  }
  std::vector<LockstepMessage> takeMessages() { return run_.messages.take(); }
  /**
   * @return the decisions by which chaos has departed from the stated order since the last call.
   */
  std::vector<chaos::Decision> takeDecisions() { return run_.decisions.take(); }
  /**
   * @return the changes that the ROS master is to be told before the output of the latest poll() is
   * sent.
   */
  std::vector<ParameterChange> takeParameters() { return run_.parameters.take(); }
  /** @brief Note that a node which does not take part has set or deleted a ROS parameter. */
  void parameterChangedOutside(const std::string& name);
  /** @brief Note that the ROS master has not accepted a participant's change of a parameter. */
  void parameterNotTaken(const ParameterChange& change);

  // ---- the gate: it stops leaps of time, but not the present instant. See RoundGate. ----
  void pause();
  void resume();
  Nanoseconds step(Nanoseconds duration);
  void runUntil(Nanoseconds target);
  void setLimit(double factor);
  /**
   * @brief Run until @p condition is met, and stop after the round in which it is. Whatever leaves
   * the stop, the run is as if it had not stopped.
   * @return the number that this stop will have, see LockstepStatus::stops.
   */
  std::uint64_t stopWhen(const StopCondition& condition);
  /** @brief Note that somebody looks at a node in a debugger, or does so no more. */
  void look(const std::string& node, bool is_looking);
  /** @brief See KeptMessages::recent(). @throws std::invalid_argument if none are kept. */
  std::vector<KeptMessages::One> recent(const std::string& name, const std::string& node,
                                        std::size_t most) const;
  /** @brief Let time stand at the present instant, for nodes that do not take part; see release().
   * @param what the text that says so, for the state. */
  void holdForOthers(const std::string& what) {
    run_.rounds.gate().holdForOthers(true);
    held_for_ = what;
  }
  /** @brief End this. @param why a label, if something that is waited for has not come; else ''. */
  void release(const std::string& why) {
    run_.rounds.gate().holdForOthers(false);
    labelIf(why);
    poll_due_ = true;
  }
  /** @return what participants want of others; nothing while the present instant goes on. When the
   * run has ended, they want nothing any more. */
  std::optional<MessageRouter::Wanted> wanted() const {
    if (run_.rounds.ended()) {
      return MessageRouter::Wanted();
    }
    // Reports that have come count when they have been applied.
    const bool is_over = run_.rounds.started() && run_.rounds.settled() && !poll_due_ &&
                         !run_.rounds.gate().stopped();
    std::optional<MessageRouter::Wanted> found;
    if (is_over) {
      found = run_.router.wanted();
    }
    if (found && run_.rounds.members().isAnyToBegin()) {
      found->services.clear();  // a participant that starts late may offer them
    }
    return found;
  }

  /**
   * @brief Send END to all participants, with the next poll(), because the wall clock or a user
   * says so, see LockstepStatus::cut. Reports of an unfinished round are lost.
   */
  void endFromOutside(const std::string& reason) { end_.endFromOutside(reason); }
  /** @brief End and label a run that has lost its ROS master. @param how the reason, for people. */
  void loseRosMaster(const std::string& how) { end_.loseRosMaster(how); }

 private:
  /** @return why the run has ended, stands or has stopped, or what time stands for at the start. */
  std::string reason() const;
  void take(ConnectionId id, const Connection& connection, std::string_view frame);
  void takeReport(MemberId id, std::string_view frame);
  void takeKnock(MemberId id);
  void drop(ConnectionId id, const Connection& connection, const std::string& reason);
  void setWall(Nanoseconds wall);
  void letLimitsStand();
  void finishRound();
  void applyRound();
  bool stopsHere();
  void tellLeap(Nanoseconds from);
  void handleEvents();
  void handle(const LockstepRounds::Event& event);
  void handleStandstill(const LockstepRounds::Event& event);
  void nameMissing();
  void labelIf(const std::string& why);
  void keepEnd();

  LimitsClock limits_;
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
  std::string held_for_;     // what time stands for, in words; see holdForOthers()
  bool poll_due_ = false;
  bool leap_told_ = false;
};

}  // namespace move_base_abstract
