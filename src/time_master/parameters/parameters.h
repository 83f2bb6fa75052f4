// Reads and checks the time master node's private parameters.
#pragma once

#include <ros/ros.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "chaos_parameters.h"
#include "clock/shown_text.h"
#include "clock/time_master.h"
#include "common/run_secret.h"
#include "lockstep/radio/network.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/routing/stored_topics.h"
#include "parameter_reader.h"

namespace move_base_abstract {

/** @brief The largest rate of /clock in lockstep [Hz, wall]. Only onlookers listen to it there. */
constexpr double kLockstepClockRate = 200.0;
constexpr double kUsualGap = 0.25;  // wall s; the node's loop takes up to 0.1

/** @return the topics that participants leave to ROS's own connections; made a list and checked. */
inline std::vector<std::string> readExcludedTopics(ParameterReader& reader) {
  const char* const key = "excluded_topics";
  std::vector<std::string> topics;
  reader.read(key, topics);
  for (const std::string& topic : topics) {
    std::string error;
    if (topic.empty() || !ros::names::validate(topic, error)) {
      throw std::invalid_argument(std::string(key) + " must be a list of names of topics, got '" +
                                  shown(topic) + "'");
    }
  }
  reader.replaceText(key, topics);
  return topics;
}

struct NodeParameters {
  TimeMaster::Settings master;
  double state_rate = 2.0;   // state messages per wall second, 0.1 to 100; one more on each change
  bool in_lockstep = false;  // mode at the start
  bool sim_time_factor_is_limit = false;  // whether /sim_time_factor counts in lockstep
  LockstepSettings lockstep;
  int lockstep_port = 0;           // 0: any free one
  bool uses_all_cores = false;     // whether the run is kept on no few cores
  bool shared_memory = true;       // whether participants may offer it
  std::string event_log;           // path, .jsonl or .csv; '': none
  bool event_log_of_ends = false;  // it has only its end and uncaught exceptions
  // Paths of new files; '': none.
  std::string message_bytes, note_of_start, note_of_end, chaos_decisions;
};

/** @return the least number of seconds that is not before @p time [ns] when converted back. */
inline double secondsNotBefore(Nanoseconds time) {
  double seconds = static_cast<double>(time) / 1e9;
  while (std::llround(seconds * 1e9) < time) {
    seconds = std::nextafter(seconds, std::numeric_limits<double>::infinity());
  }
  return seconds;
}

/**
 * @return the names of nodes as absolute names. A name without a leading '/' is below the root.
 * @throws std::invalid_argument if a name is not valid, or comes twice.
 */
inline std::vector<std::string> absoluteNames(const std::string& key,
                                              const std::vector<std::string>& names) {
  std::vector<std::string> absolute;
  for (const std::string& name : names) {
    std::string error;
    if (name.empty() || name == "/" || !ros::names::validate(name, error) || name[0] == '~') {
      throw std::invalid_argument(key + " must be a list of node names, got '" + shown(name) + "'" +
                                  (error.empty() ? "" : " (" + shown(error) + ")"));
    }
    const std::string full = ros::names::clean(name[0] == '/' ? name : "/" + name);
    if (std::find(absolute.begin(), absolute.end(), full) != absolute.end()) {
      throw std::invalid_argument(key + " must name each node once, got '" + full + "' twice");
    }
    absolute.push_back(full);
  }
  return absolute;
}

inline void readEnd(ParameterReader& reader, NodeParameters& parameters) {
  reader.read("note_of_start", parameters.note_of_start);
  reader.read("note_of_end", parameters.note_of_end);
  LockstepSettings& lockstep = parameters.lockstep;
  reader.read("end_at", lockstep.end_at);
  reader.read("end_with", lockstep.end_with);
  lockstep.end_with = absoluteNames("end_with", lockstep.end_with);
  reader.read("end_when_idle", lockstep.end_when_idle);
  reader.read("strict", lockstep.strict);
  reader.read("idle_nodes", lockstep.idle_nodes);
  lockstep.idle_nodes = absoluteNames("idle_nodes", lockstep.idle_nodes);
}

inline void readTopics(ParameterReader& reader, LockstepSettings& lockstep) {
  lockstep.excluded_topics = readExcludedTopics(reader);
  reader.read("not_covered", lockstep.not_covered);
  reader.read("onlookers", lockstep.onlookers);
  lockstep.onlookers = absoluteNames("onlookers", lockstep.onlookers);
  reader.read("stored_topics", lockstep.stored_topics);
  lockstep.stored_topics = checkedStoredTopics(lockstep.stored_topics);
  reader.read("keep_unread", lockstep.keep_unread);
}

inline void readNetwork(ParameterReader& reader, NodeParameters& parameters) {
  reader.read("network", parameters.lockstep.network);
  radio::networkOf(parameters.lockstep.network);  // throws if it is wrong
  if (!parameters.lockstep.network.empty() && !parameters.in_lockstep) {
    throw std::invalid_argument("network must be [] in mode scaled, where messages go over ROS");
  }
}

inline void readCores(ParameterReader& reader, NodeParameters& parameters) {
  const std::map<std::string, std::string> words{{"all", "all"}, {"auto", "auto"}, {"one", "one"}};
  std::string cores = "one";
  reader.choose("cores", words, cores);
  if (cores == "auto") {
    ROS_WARN(
        "parameter cores: auto measures no more and means one; "
        "set one, or all for nodes that compute for milliseconds; the next release refuses auto");
  }
  parameters.uses_all_cores = cores == "all";
  reader.read("shared_memory", parameters.shared_memory);
}

inline void readLookahead(ParameterReader& reader, NodeParameters& parameters) {
  double& lookahead = parameters.lockstep.lookahead;
  reader.read("lookahead", lookahead);
  if (lookahead == 0.0) {
    return;
  }
  if (!parameters.in_lockstep) {
    throw std::invalid_argument("lookahead must be 0 in mode scaled, where no node waits; got " +
                                shown(std::to_string(lookahead)));
  }
  if (!parameters.lockstep.stored_topics.empty()) {
    throw std::invalid_argument("stored_topics must be [] with a lookahead, where all takes time");
  }
}

inline void readLockstepParameters(ParameterReader& reader, NodeParameters& parameters) {
  LockstepSettings& lockstep = parameters.lockstep;
  int max_microsteps = static_cast<int>(lockstep.max_microsteps);
  reader.read("participants", lockstep.participants);
  reader.read("settle", lockstep.settle);
  reader.read("speed_limit", lockstep.limit);
  reader.read("silence_limit", lockstep.silence_limit);
  reader.read("longest_leap", lockstep.longest_leap);
  reader.choose("on_silence", {{"wait", OnSilence::kWait}, {"drop", OnSilence::kDrop}},
                lockstep.on_silence);
  reader.choose("on_death", {{"go_on", OnDeath::kGoOn}, {"end", OnDeath::kEnd}}, lockstep.on_death);
  reader.read("max_microsteps", max_microsteps);
  readEnd(reader, parameters);
  reader.read("log_messages", lockstep.log_messages);
  reader.read("start_stopped", lockstep.start_stopped);
  reader.read("keep_messages", lockstep.keep_messages);
  reader.read("sim_time_factor_is_limit", parameters.sim_time_factor_is_limit);
  reader.read("lockstep_port", parameters.lockstep_port);
  readCores(reader, parameters);
  reader.read("event_log", parameters.event_log);
  reader.read("message_bytes", parameters.message_bytes);
  lockstep.keeps_bytes = !parameters.message_bytes.empty();
  reader.read("event_log_of_ends", parameters.event_log_of_ends);
  std::string secret, secret_file;
  reader.read("lockstep_secret", secret);
  reader.read("lockstep_secret_file", secret_file);
  lockstep.secret = runSecret(secret, secret_file);
  readTopics(reader, lockstep);
  lockstep.participants = absoluteNames("participants", lockstep.participants);
  lockstep.max_microsteps = static_cast<std::uint32_t>(max_microsteps);
  lockstep.start_time = parameters.master.start_time;
  lockstep.start_paused = parameters.master.start_paused;
}

/** @throws std::invalid_argument if a parameter is wrong; the text begins with its key. */
inline NodeParameters readParameters(const ros::NodeHandle& node) {
  NodeParameters parameters;
  ParameterReader reader(node);
  reader.choose("mode", {{"scaled", false}, {"lockstep", true}}, parameters.in_lockstep);
  reader.read("factor", parameters.master.factor);
  reader.read("busy_factor", parameters.master.busy_factor);
  reader.read("finest_step", parameters.master.finest_step);
  if (parameters.in_lockstep) {  // each message slows the run down
    parameters.master.max_clock_rate = kLockstepClockRate;
  }
  reader.read("max_clock_rate", parameters.master.max_clock_rate);
  reader.read("start_time", parameters.master.start_time);
  reader.read("start_paused", parameters.master.start_paused);
  reader.read("repeat_rate", parameters.master.repeat_rate);
  parameters.master.longest_gap = kUsualGap;
  reader.read("longest_gap", parameters.master.longest_gap);
  reader.read("state_rate", parameters.state_rate);
  readLockstepParameters(reader, parameters);
  readLookahead(reader, parameters);
  readNetwork(reader, parameters);
  readChaos(reader, parameters.in_lockstep, parameters.lockstep, parameters.chaos_decisions);
  reader.warnOfUnknown();
  return parameters;
}

}  // namespace move_base_abstract
