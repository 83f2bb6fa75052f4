#include "lockstep_mode.h"

#include <ros/console.h>
#include <ros/network.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "clock/shown_text.h"
#include "new_file.h"
#include "parameters/chaos_parameters.h"

namespace move_base_abstract {
namespace {

constexpr const char* kAddressParameter = "/time_master/lockstep_address";
constexpr Nanoseconds kLookGap = kNanosecondsPerSecond / 50;  // wall, between two work()s
constexpr Nanoseconds kFlushGap = kNanosecondsPerSecond / 2;  // wall
// The kinds of events about uncaught exceptions of nodes, by which a run is judged.
constexpr std::array<std::string_view, 3> kOfEnds = {"uncaught", "unasked", "asked"};
constexpr int kSightings = 2;  // so that a node that joins has time to do so

bool moves(LockstepPhase phase) {
  return phase == LockstepPhase::kRunning || phase == LockstepPhase::kWaiting ||
         phase == LockstepPhase::kLimited;
}

LockstepSettings sessionSettings(const NodeParameters& parameters, Nanoseconds begin) {
  LockstepSettings settings = parameters.lockstep;
  settings.machine_clock = machineNow() - wallNow();
  if (begin > 0) {
    settings.start_time = secondsNotBefore(begin);
  }
  return settings;
}

void log(const LockstepMessage& message) {
  switch (message.level) {
    case LockstepMessage::Level::kDebug:
      ROS_DEBUG("%s", message.text.c_str());
      break;
    case LockstepMessage::Level::kInfo:
      ROS_INFO("%s", message.text.c_str());
      break;
    case LockstepMessage::Level::kWarn:
      ROS_WARN("%s", message.text.c_str());
      break;
    case LockstepMessage::Level::kError:
      ROS_ERROR("%s", message.text.c_str());
      break;
  }
}

/** @brief Log an error. @param problem '': none. */
void complain(const std::string& problem) {
  if (!problem.empty()) {
    ROS_ERROR("%s", problem.c_str());
  }
}

Participant toRosMessage(const LockstepStatus::Participant& participant) {
  Participant message;
  message.name = participant.name;
  message.node_uri = participant.node_uri;
  message.id = participant.id;
  message.rank = participant.rank;
  message.working = participant.owes;
  message.never = !participant.next.has_value();
  message.next = toRos(std::max<Nanoseconds>(participant.next.value_or(0), 0));
  message.knocked = participant.knocked;
  message.mail = static_cast<std::uint32_t>(participant.mail);
  message.open = participant.open;
  message.waits_for = participant.waits_for;
  message.tells = participant.tells;
  return message;
}

void describeCounts(const LockstepStatus& status, TimeState* state) {
  state->repeatable = status.not_repeatable.empty();
  state->not_repeatable_because = status.not_repeatable;
  state->degraded_because = status.degraded;
  state->rounds = status.rounds;
  state->leaps = status.leaps;
  state->messages = status.messages;
  state->chaos = status.chaos;
  state->rows = status.rows;
  state->stops = status.stops;
  state->stop_row = status.stop_row;
  state->looked_at = status.looked_at;
}

}  // namespace

LockstepMode::LockstepMode(const NodeParameters& parameters, const ros::Publisher& clock,
                           Nanoseconds begin)
    : parameters_(parameters) {
  const LockstepSettings settings = sessionSettings(parameters, begin);
  if (!parameters.event_log.empty()) {
    const auto start = static_cast<Nanoseconds>(std::llround(settings.start_time * 1e9));
    try {
      event_log_ = std::make_unique<EventLogWriter>(parameters.event_log, start,
                                                    settings.stored_topics, chaosHead(settings));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("event_log " + std::string(error.what()));
    }
  }
  if (!parameters.message_bytes.empty()) {
    message_bytes_ = std::make_unique<MessageBytes>(parameters.message_bytes);
  }
  clock_ = std::make_unique<ClockPublisher>(clock, begin, parameters.master.max_clock_rate,
                                            parameters.master.repeat_rate);
  server_ = std::make_unique<LockstepServer>(
      settings, ros::network::getHost(), parameters.lockstep_port,
      LockstepServer::Local{parameters.uses_all_cores, parameters.shared_memory}, listeners());
  ros_master_ = std::make_unique<RosMasterWatch>();
  onlookers_.begin(*server_, settings.onlookers);
  try {
    parameters_of_ros_.listen([this](const std::string& name) {
      server_->with([&](LockstepSession& session) { session.parameterChangedOutside(name); });
    });
    setParameter(kAddressParameter, server_->address());
  } catch (const std::runtime_error& error) {
    // The ROS master may have died after it gave the address to a node. So the run has begun, and
    // it ends properly.
    ended_ = End{false, error.what()};
  }
  ROS_INFO("lockstep: participants are expected at %s", server_->address().c_str());
}

LockstepServer::Listeners LockstepMode::listeners() {
  LockstepServer::Listeners listeners;
  listeners.time = [this, is_first = true](Nanoseconds time) mutable {
    if (is_first) {
      parameters_of_ros_.remember();
      noteStart();
      is_first = false;
    }
    clock_->set(time);
  };
  listeners.event = [this](const LockstepLogEntry& entry) {
    if (event_log_ && (!parameters_.event_log_of_ends ||
                       std::find(kOfEnds.begin(), kOfEnds.end(), entry.kind) != kOfEnds.end())) {
      event_log_->add(entry.time, entry.robot, entry.kind, entry.values);
    }
    if (message_bytes_ &&
        (entry.kind == "message" || entry.kind == "call" || entry.kind == "response")) {
      message_bytes_->add(entry.type, entry.bytes);
    }
  };
  listeners.parameters = [this](const std::vector<ParameterChange>& changes) {
    return parameters_of_ros_.apply(changes);
  };
  return listeners;
}

/** @brief Write the file that tells the program which started this node that time has started. */
void LockstepMode::noteStart() const {
  if (!parameters_.note_of_start.empty()) {
    complain(writeNewFile("note_of_start", parameters_.note_of_start, ""));
  }
}

/** @brief Write the file that tells the program which started this node how the run has ended. */
void LockstepMode::noteEnd(const LockstepStatus& status) const {
  if (!parameters_.note_of_end.empty()) {
    complain(writeNewFile("note_of_end", parameters_.note_of_end,
                          "{\"ended_by\":\"" + status.ended_by +
                              "\",\"at_ns\":" + std::to_string(status.time) +
                              ",\"rounds\":" + std::to_string(status.rounds) +
                              ",\"leaps\":" + std::to_string(status.leaps) +
                              ",\"messages\":" + std::to_string(status.messages) + "}\n"));
  }
}

LockstepMode::~LockstepMode() { finish("the time master ends"); }

bool LockstepMode::finish(const std::string& reason) {
  if (finished_) {
    return !event_log_failed_;
  }
  finished_ = true;
  server_->finish(reason);
  parameters_of_ros_.stop();
  logMessages();
  if (const std::string& path = parameters_.chaos_decisions; !path.empty()) {
    complain(writeDecisions(
        path, server_->with([](LockstepSession& session) { return session.takeDecisions(); })));
  }
  if (ros_master_->gone().empty()) {
    deleteParameter(kAddressParameter);
  }
  const LockstepStatus status = server_->status();
  finishLog(status, reason);
  noteEnd(status);
  return !event_log_failed_;
}

void LockstepMode::finishLog(const LockstepStatus& status, const std::string& reason) {
  if (event_log_) {
    const std::string why = status.reason.empty() ? reason : status.reason;
    EventLogWriter::End end{why, status.not_repeatable, status.degraded, ended_ && !ended_->good,
                            status.cut ? std::make_optional(status.time) : std::nullopt};
    for (const LockstepStatus::Departure& one : status.departures) {
      end.departures.push_back({one.name, one.time, one.died});
    }
    for (const LockstepStatus::OpenGoals& one : status.open_goals) {
      end.open_goals.push_back({one.client, one.action, one.count});
    }
    end.ended_by = status.ended_by;
    end.ended_with = status.ended_with;
    end.at_ns = status.time;
    const std::string error = event_log_->finish(end);
    complain(error);
    event_log_failed_ = event_log_failed_ || !error.empty();
  }
}

bool LockstepMode::work() {
  const Nanoseconds wall = wallNow();
  logMessages();
  if (event_log_ && wall >= flush_due_) {
    event_log_->flush();
    flush_due_ = wall + kFlushGap;
    if (!event_log_failed_ && !event_log_->error().empty()) {
      event_log_failed_ = true;
      ROS_ERROR("%s", event_log_->error().c_str());
    }
  }
  const LockstepStatus status = server_->status();
  radio_.work(*server_, wall);
  onlookers_.work(*server_, wall);
  look(status, wall);
  updateBystanders(status);
  lookForEnd(status);
  const std::string seen = notable(status);
  const bool changed = seen != notable_;
  notable_ = seen;
  return changed;
}

Nanoseconds LockstepMode::nextWork() const { return wallNow() + kLookGap; }

void LockstepMode::logMessages() {
  for (const LockstepMessage& message : server_->takeMessages()) {
    log(message);
  }
}

void LockstepMode::lookForEnd(const LockstepStatus& status) {
  if (ended_) {
    return;
  }
  const std::string gone = ros_master_->gone();
  if (!gone.empty()) {
    server_->with([&](LockstepSession& session) { session.loseRosMaster(gone); });
    ended_ = End{false, gone};
  } else if (status.phase == LockstepPhase::kEnded) {
    // Before finish(), only the session itself ends the run: as wished, or by a death or a
    // deadlock.
    ended_ = End{status.ended_as_wished, status.reason};
  }
}

/**
 * @brief Return a text that changes when a state message should be sent at once. It does not change
 * with each round or leap.
 */
std::string LockstepMode::notable(const LockstepStatus& status) const {
  std::string all = moves(status.phase) ? "moving" : phaseName(status.phase);
  all += status.phase == LockstepPhase::kWaiting ? " waiting " : " ";
  all += std::to_string(status.paused) + " " + std::to_string(status.stops) + " " +
         joined(status.looked_at) + " " + std::to_string(status.not_repeatable.size()) + " " +
         std::to_string(status.degraded.size()) + " " + status.reason;
  for (const LockstepStatus::Participant& participant : status.participants) {
    all += " " + std::to_string(participant.id);
  }
  return all + " " + joined(bystanders_) + (event_log_failed_ ? " without a log" : "");
}

void LockstepMode::look(const LockstepStatus& status, Nanoseconds wall) {
  const bool is_held = status.phase == LockstepPhase::kLimited;
  achieved_.look(wall, status.time, is_held ? status.limit : 0.0, moves(status.phase));
}

void LockstepMode::updateBystanders(const LockstepStatus& status) {
  const bool asked = ros_master_->answers() != answers_;
  answers_ = ros_master_->answers();
  std::set<std::string> others = ros_master_->clockSubscribers();
  others.erase("/rosout");  // it uses the clock only to stamp lines of the log
  std::set<std::string> participants;
  for (const LockstepStatus::Participant& participant : status.participants) {
    others.erase(participant.name);
    participants.insert(participant.name);
  }
  ros_master_->setKnown(std::move(participants));
  bystanders_.assign(others.begin(), others.end());
  if (status.phase == LockstepPhase::kWaitingForParticipants || !asked) {
    return;
  }
  std::map<std::string, int> sightings;
  std::vector<std::string> fresh;
  for (const std::string& name : others) {
    sightings[name] = sightings_[name] + 1;
    if (sightings[name] == kSightings && warned_.insert(name).second) {
      fresh.push_back(name);
    }
  }
  sightings_ = sightings;
  if (!fresh.empty()) {
    ROS_WARN("lockstep: time does not wait for %s: %s simulated time (/clock) and %s not take part",
             shown(joined(fresh)).c_str(), fresh.size() == 1 ? "it uses" : "they use",
             fresh.size() == 1 ? "does" : "do");
  }
}

void LockstepMode::describe(TimeState& state) {
  const LockstepStatus status = server_->status();
  const Nanoseconds wall = wallNow();
  if (status.paused && event_log_) {
    event_log_->flush();  // who hears of it may read the file up to here
  }
  state.paused = status.paused;
  state.sim_time = toRos(status.time);
  state.wanted_factor = status.limit;
  state.effective_factor = status.paused ? 0.0 : status.limit;
  state.achieved_factor = achieved_.at(wall);
  state.run_until = toRos(status.run_until.value_or(0));
  state.phase = phaseName(status.phase);
  state.reason = status.reason;
  state.microstep = status.microstep;
  for (const LockstepStatus::Waiting& waiting : status.waiting_for) {
    Waiting message;
    message.name = waiting.name;
    message.owes = waiting.owes;
    message.where = waiting.where;
    message.told = waiting.told;
    message.since = static_cast<double>(std::max<Nanoseconds>(wall - waiting.since, 0)) / 1e9;
    state.waiting_for.push_back(message);
  }
  for (const LockstepStatus::Participant& participant : status.participants) {
    state.participants.push_back(toRosMessage(participant));
  }
  describeCounts(status, &state);
  state.bystanders = bystanders_;
  state.cores = server_->cores();
  state.event_log = parameters_.event_log;
  state.event_log_error = event_log_ ? event_log_->error() : "";
}

std::string LockstepMode::inUse() const {
  std::vector<std::string> names;
  for (const LockstepStatus::Participant& participant : server_->status().participants) {
    names.push_back(participant.name);
  }
  return names.empty() ? "" : "takes part: " + joined(names);
}

std::string LockstepMode::setFactor(double factor) {
  server_->with([&](LockstepSession& session) { session.setLimit(factor); });
  const std::string done = factor == 0.0
                               ? "no speed limit"
                               : "at most " + text(factor) + " simulated seconds per wall second";
  ROS_INFO("%s, from %s on", done.c_str(), text(now()).c_str());
  return done;
}

std::string LockstepMode::pause() {
  server_->with([](LockstepSession& session) { session.pause(); });
  return "paused: " + text(now()) + " is finished, and time stands still there";
}

std::string LockstepMode::resume() {
  server_->with([](LockstepSession& session) { session.resume(); });
  return "running from " + text(now()) + " on";
}

Nanoseconds LockstepMode::step(Nanoseconds duration) {
  return server_->with([&](LockstepSession& session) { return session.step(duration); });
}

void LockstepMode::runUntil(Nanoseconds target) {
  server_->with([&](LockstepSession& session) { session.runUntil(target); });
}

std::string LockstepMode::hold(const std::string& holder, double) {
  throw std::invalid_argument(
      "hold by '" + holder +
      "': there are no holds in lockstep, where time stands still anyway while a participant "
      "works; if work should take simulated time, the participant charges it (see charge)");
}

std::string LockstepMode::release(const std::string& holder) {
  throw std::invalid_argument("release: '" + holder +
                              "' does not hold: there are no holds in lockstep");
}

}  // namespace move_base_abstract
