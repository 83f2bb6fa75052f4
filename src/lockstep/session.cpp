#include "session.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "clock/number_text.h"
#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

constexpr Nanoseconds kMissingGap = 5 * kNanosecondsPerSecond;  // wall

}  // namespace

LockstepSession::LockstepSession(const LockstepSettings& settings, Nanoseconds wall)
    : limits_(wall),
      run_(settings, wall),
      end_(run_),
      departures_(run_, end_),
      joining_(run_, departures_),
      turns_(run_, end_, departures_),
      walked_(run_, end_, departures_, turns_),
      grants_(run_),
      silence_(run_, departures_),
      began_(wall),
      missing_due_(settings.participants.empty() ? kNever : wall + kMissingGap) {
  keepEnd();
}

// ---- inputs ----------------------------------------------------------------------------------

void LockstepSession::connect(ConnectionId connection, Nanoseconds wall) {
  setWall(wall);
  run_.connections.add(connection, run_.wall + Connections::kHelloLimit);
  if (run_.rounds.ended()) {
    run_.connections.close(connection, end_.reason());
  }
}

void LockstepSession::received(ConnectionId id, std::string_view bytes, Nanoseconds wall) {
  setWall(wall);
  Connection* const connection = run_.connections.open(id);
  if (connection == nullptr) {
    return;
  }
  poll_due_ = true;
  try {
    connection->buffer.append(bytes);
    while (const auto frame = connection->buffer.next(
               connection->member == 0 ? wire::kLargestHello : wire::kLargestFrame)) {
      take(id, *connection, *frame);
      if (connection->close) {
        return;
      }
    }
  } catch (const wire::MalformedFrame& error) {
    drop(id, *connection, error.what());
  }
}

void LockstepSession::take(ConnectionId id, const Connection& connection, std::string_view frame) {
  const bool greeted = connection.member != 0;
  const auto member = run_.members.find(connection.member);
  if (greeted && (member == run_.members.end() || member->second.departing)) {
    return;  // it has left; its further frames do not count
  }
  // A report is decoded in its final place, since its items point into its bytes.
  if (greeted && wire::isReport(frame)) {
    return takeReport(connection.member, frame);
  }
  const wire::ParticipantFrame decoded = wire::decodeFromParticipant(frame);
  if (const auto* greeting = std::get_if<wire::Hello>(&decoded); greeting && !greeted) {
    joining_.greet(id, *greeting);
  } else if (std::holds_alternative<wire::Knock>(decoded) && greeted) {
    takeKnock(connection.member);
  } else if (const auto* leave = std::get_if<wire::Leave>(&decoded); leave && greeted) {
    departures_.leave(connection.member, *leave);
  } else if (const auto* stopping = std::get_if<wire::Stopping>(&decoded); stopping && greeted) {
    departures_.toldToEnd(connection.member, *stopping);
  } else if (std::holds_alternative<wire::Crashing>(decoded) && greeted) {
    member->second.crashing = true;
  } else if (const auto* busy = std::get_if<wire::Busy>(&decoded); busy && greeted) {
    silence_.takeBusy(connection.member, *busy);
  } else if (const auto* looked = std::get_if<wire::Looked>(&decoded); looked && greeted) {
    if (looked->is_looked_at || run_.looked_at.count(member->second.name) != 0) {
      look(member->second.name, looked->is_looked_at);
    }
  } else {
    throw wire::MalformedFrame(greeted ? "HELLO must come once, got another"
                                       : "the first frame must be HELLO, got another type");
  }
}

void LockstepSession::disconnected(ConnectionId id, Nanoseconds wall) {
  setWall(wall);
  if (!run_.connections.contains(id)) {
    return;
  }
  poll_due_ = true;
  run_.interruption.lost(id, run_.wall);
  if (const MemberId member = run_.connections.remove(id); member != 0) {
    departures_.lose(member);
  }
}

/** @brief Drop a connection whose bytes cannot be trusted any more. */
void LockstepSession::drop(ConnectionId id, const Connection& connection,
                           const std::string& reason) {
  if (connection.member == 0) {
    joining_.refuse(id, reason);
    return;
  }
  run_.connections.close(id, reason);
  departures_.die(connection.member, "it was dropped: " + reason);
}

void LockstepSession::takeReport(MemberId id, std::string_view frame) {
  const auto bytes = std::make_shared<const std::string>(frame);
  auto report = std::get<wire::Report>(wire::decodeFromParticipant(*bytes));
  const MemberState& state = *run_.rounds.members().find(id);
  if (!state.owes || state.round != report.round) {
    throw wire::MalformedFrame("REPORT must be of the round that was granted, " +
                               (state.owes ? std::to_string(state.round) : "none") + ", got " +
                               std::to_string(report.round));
  }
  const bool is_last = report.leaving;
  if (run_.rounds.windows().areThere()) {
    walked_.take(id, std::move(report), bytes);
  } else {
    turns_.take(id, std::move(report), bytes);
  }
  run_.changed.add(id, run_.members.at(id));
  if (is_last) {
    departures_.reportedLast(id);
  }
}

void LockstepSession::takeKnock(MemberId id) {
  SessionMember& member = run_.members.at(id);
  run_.rounds.knock(id);
  if (run_.rounds.started() && !member.input_told) {
    member.input_told = true;
    const std::string why = quote(member.name) + " had input from outside" + run_.text.at();
    if (run_.interruption.isActive()) {
      run_.interruption.knocked(id);
      run_.interruption.keep({Interruption::Label::Kind::kInput, id, why});  // it has to wait
    } else {
      run_.labels.addNotRepeatable(why);
    }
  }
}

// ---- the end of a round ----------------------------------------------------------------------

std::vector<LockstepSession::Output> LockstepSession::poll(Nanoseconds wall) {
  setWall(wall);
  letLimitsStand();  // or go on, from here on
  poll_due_ = false;
  if (!run_.rounds.ended()) {
    run_.rounds.watch(run_.wall);
    handleEvents();
    end_.endIfLabelled();
    if ((run_.rounds.isFinishing() || !departures_.holdTime()) && run_.rounds.settled()) {
      finishRound();
    }
    nameMissing();
    joining_.dropSilentStrangers();
  }
  letLimitsStand();
  return run_.connections.flush();
}

void LockstepSession::applyRound() {
  if (run_.rounds.windows().areThere()) {
    walked_.apply();
  } else {
    turns_.apply();
  }
  end_.endIfLabelled();
  end_.endIfSomebodyHasGone();
  turns_.noteChangedParameters();
  run_.rounds.setOwed(run_.router.goals().count() + run_.router.openCalls());
}

/** @brief Finish the round, and the rounds after it in which all turns were reported beforehand. */
void LockstepSession::finishRound() {
  do {
    if (departures_.areTogether()) {
      run_.rounds.gate().leaveStop();
    } else if (run_.rounds.gate().stopped()) {
      return;  // what has come meanwhile counts when the run goes on
    }
    applyRound();
    if (stopsHere()) {
      return;
    }
    const Nanoseconds before = now();
    grants_.send(run_.rounds.decide(run_.wall));
    tellLeap(before);
    if (!grants_.tooMuch().empty()) {
      end_.endAtOnce(grants_.tooMuch());
    }
    if (!run_.rounds.mail().isWaiting()) {
      turns_.forgetApplied();
    }
    departures_.sayGone();
    handleEvents();
    end_.endIfLabelled();
    end_.closeIfOver();
  } while ((!run_.changed.empty() || run_.rounds.isFinishing()) && run_.rounds.settled() &&
           !run_.rounds.ended());
}

/** @brief Tell who has asked for a long leap of time from @p from, the first time, and label a leap
 * to the machine's own time. */
void LockstepSession::tellLeap(Nanoseconds from) {
  const Nanoseconds longest = toNanoseconds(run_.settings.longest_leap);
  if (now() - from <= longest || owing() == 0) {
    return;  // nobody is woken by a leap to the end of the run
  }
  std::string who;
  for (const MemberId id : run_.rounds.latestRound()) {
    who += (who.empty() ? "" : ", ") + run_.text.quoted(id);
  }
  if (!std::exchange(leap_told_, true)) {
    run_.messages.say(LockstepMessage::Level::kWarn,
                      "time leaps by " + secondsText(now() - from) + " to " + secondsText(now()) +
                          ", for which " + who + " has asked. If that is not meant, look there " +
                          "for a stamp of the wall clock, or a wrong unit; longest_leap is " +
                          secondsText(longest) + ". Later leaps are not told");
  }
  const Nanoseconds machine = run_.settings.machine_clock;
  if (machine != 0 && std::abs(now() - limits_.wall() - machine) < longest) {
    labelIf("time leaps to the machine's own time, for which " + who + " has asked");
  }
}

// ---- events ----------------------------------------------------------------------------------

void LockstepSession::handleEvents() {
  for (const LockstepRounds::Event& event : run_.rounds.takeEvents()) {
    handle(event);
  }
}

void LockstepSession::handle(const LockstepRounds::Event& event) {
  using Kind = LockstepRounds::Event::Kind;
  switch (event.kind) {
    case Kind::kStarted:
      missing_due_ = kNever;
      if (run_.settings.participants.empty()) {
        run_.labels.addNotRepeatable(
            "no participants are named: the participants at the start depend on the wall clock");
      }
      run_.messages.say(LockstepMessage::Level::kInfo,
                        "the clock starts" + run_.text.at() + " with " +
                            countText(run_.members.size(), "participant"));
      break;
    case Kind::kSilent:
    case Kind::kAnswered:
      silence_.handle(event);
      break;
    case Kind::kTargetReached:
      run_.messages.say(LockstepMessage::Level::kDebug,
                        "reached " + secondsText(run_.rounds.now()) + ", paused");
      if (run_.settings.end_at != 0.0 && run_.rounds.now() >= toNanoseconds(run_.settings.end_at)) {
        end_.endAsWished("the run was to end" + run_.text.at(), ended_by::kEndAt);
      }
      break;
    case Kind::kIdle:
    case Kind::kDeadlock:
    case Kind::kZeroDelayLoop:
      handleStandstill(event);
      break;
  }
}

void LockstepSession::handleStandstill(const LockstepRounds::Event& event) {
  using Kind = LockstepRounds::Event::Kind;
  if (event.kind == Kind::kIdle) {
    run_.messages.say(LockstepMessage::Level::kDebug, run_.text.idle());
    if (run_.settings.end_when_idle) {
      end_.endAsWished(run_.text.idle(), ended_by::kIdle);
    }
    return;
  }
  run_.messages.say(event.kind == Kind::kDeadlock ? LockstepMessage::Level::kWarn
                                                  : LockstepMessage::Level::kError,
                    end_.reason());
  if (run_.settings.end_when_idle) {
    end_.end(end_.reason());
  }
}

void LockstepSession::nameMissing() {
  if (run_.rounds.started() || run_.wall < missing_due_) {
    return;
  }
  missing_due_ = run_.wall + kMissingGap;
  if (run_.rounds.missing().empty()) {
    return;  // it is stopped
  }
  run_.messages.say(LockstepMessage::Level::kInfo,
                    "the clock does not start without " + run_.text.missing());
}

Nanoseconds LockstepSession::nextWake() const {
  if (poll_due_ || run_.connections.hasOutput()) {
    return limits_.wall();
  }
  return run_.rounds.ended()
             ? kNever
             : limits_.wallOf(std::min({run_.rounds.nextWake(), missing_due_,
                                        run_.connections.helloDue(), run_.interruption.due()}));
}

// ---- parameters ------------------------------------------------------------------------------

/**
 * @brief Label the run, if a participant depends on the parameter. A change before the first round
 * does not count. During an interruption the label is kept back: who is told to end sets at once.
 */
void LockstepSession::parameterChangedOutside(const std::string& name) {
  // Nodes that are told to end delete their parameters, which does not matter when all have gone.
  const bool anybody = std::any_of(run_.members.begin(), run_.members.end(),
                                   [](const auto& entry) { return !entry.second.departing; });
  if (!run_.rounds.started() || run_.rounds.ended() || !anybody) {
    return;
  }
  const std::string why = run_.parameters.changedOutside(name);
  if (!why.empty() && run_.interruption.isActive()) {
    run_.interruption.keep({Interruption::Label::Kind::kInput, 0, why});
  } else {
    labelIf(why);
  }
}

void LockstepSession::parameterNotTaken(const ParameterChange& change) {
  labelIf("the ROS master has not taken parameter " + change.name + " of " + change.by);
}

void LockstepSession::labelIf(const std::string& why) {
  if (!why.empty()) {
    run_.labels.addNotRepeatable(why);
    poll_due_ = true;  // the first label may end the run
  }
}

// ---- status ----------------------------------------------------------------------------------

LockstepStatus LockstepSession::status() const {
  LockstepStatus status;
  status.phase = phase();
  status.time = run_.rounds.now();
  status.microstep = run_.rounds.clock().microstep;
  status.paused = run_.rounds.gate().paused();
  if (!run_.rounds.ended()) {
    status.waiting_for = run_.text.waitingFor(began_, run_.interruption, run_.router);
    for (LockstepStatus::Waiting& waiting : status.waiting_for) {
      waiting.since += limits_.wall() - run_.wall;
    }
  }
  status.participants = run_.text.participants();
  status.not_repeatable = run_.labels.notRepeatable();
  status.degraded = run_.labels.degraded();
  status.departures = departures_.list();
  status.open_goals = run_.text.openGoals(run_.router.goals());
  status.reason = reason();
  status.ended_by = end_.code();
  status.ended_with = end_.node();
  status.ended_as_wished = end_.isAsWished();
  status.cut = end_.isCut();
  status.limit = run_.rounds.gate().limit();
  status.run_until = run_.rounds.gate().target();
  status.rounds = run_.rounds.clock().rounds - run_.rounds.clock().played;
  status.leaps = run_.rounds.clock().leaps;
  status.messages = run_.router.messages();
  status.chaos = chaosText(run_.settings);
  status.rows = run_.stops.rows();
  status.stops = run_.stops.count();
  status.stop_row = run_.stops.row();
  status.looked_at.assign(run_.looked_at.begin(), run_.looked_at.end());
  return status;
}

}  // namespace move_base_abstract
