// The settings of a run of the event-driven clock.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

enum class OnDeath { kGoOn, kEnd };
enum class OnSilence { kWait, kDrop };

struct LockstepSettings {
  double start_time = 1.0;                // s simulated, 1e-6 to 2e9
  std::vector<std::string> participants;  // time starts when all of these have joined
  double settle =
      2.0;  // wall s without a new participant until time starts if none is named, 0-3600
  // s simulated, 1e-6 to 1000, that everything takes from one participant to another; 0: none
  double lookahead = 0.0;
  double limit = 0.0;  // simulated s per wall s at most, 0.01 to 1e6; 0: none
  bool start_paused = false;
  bool start_stopped = false;              // stopped before the first round
  std::uint32_t max_microsteps = 100'000;  // at one instant, at least 1
  double silence_limit = 10.0;             // wall s that a report may take, 0.001 to 86400; 0: any
  double longest_leap = 86400.0;           // s simulated; a longer leap of time is told
  Nanoseconds machine_clock = 0;           // less the monotonic instants; 0: not known
  OnDeath on_death = OnDeath::kGoOn;
  OnSilence on_silence = OnSilence::kWait;
  bool end_when_idle = false;
  double end_at = 0.0;                  // s simulated, start_time to 2147483647; 0: no end
  std::vector<std::string> end_with;    // the run ends when one of these leaves, or dies
  std::vector<std::string> idle_nodes;  // all waiting threads of these wait for work
  bool strict = false;                  // the first label ends the run
  bool log_messages = false;            // messages and calls between participants are logged, too
  bool keeps_bytes = false;             // log entries have the bytes that were sent
  int keep_messages = 0;                // messages of each topic to keep, see KeptMessages
  std::vector<std::string> excluded_topics;  // do not go through the time master
  // "TOPIC" or "NODE=TOPIC": messages there are no reason for a grant, and come with the next one
  std::vector<std::string> stored_topics;
  // The lines of a network, see radio/network.h; none: there is no radio.
  std::vector<std::string> network;
  bool keep_unread = true;               // see Keep::kUnread; false: to compare runs
  std::vector<std::string> not_covered;  // reasons why the log is not complete: labels of the run
  std::vector<std::string> onlookers;    // time starts when these are there, too, see OnlookerWait
  std::string secret;                    // which each HELLO must have; empty: none
  // The seed of another legal order of equal events; 0: the stated order. Not with a lookahead.
  std::uint32_t chaos_seed = 0;
  double chaos_delay = 0.0;   // s simulated, the longest delay of a message, 0 to 1000
  double chaos_starts = 0.0;  // s simulated, the longest lateness of a node's start, 0 to 1000
  std::string chaos_only;     // the decisions to apply, see chaos::decisionsOf()
  bool keeps_decisions = false;
};

/**
 * @return @p settings, each of which is within its range.
 * @throws std::invalid_argument if some do not go together.
 */
LockstepSettings checkedSettings(LockstepSettings settings);

/**
 * @return the speed limit in billionths; 0: none.
 * @throws std::invalid_argument unless @p factor is from 0.01 to 1e6, or 0.
 */
FactorUnits checkedLimit(double factor);

/** @return @p seconds in whole nanoseconds. */
Nanoseconds toNanoseconds(double seconds);

}  // namespace move_base_abstract
