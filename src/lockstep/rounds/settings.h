// What a run of the event-driven clock can be told beforehand.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_SETTINGS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_SETTINGS_H

#include <cstdint>
#include <string>
#include <vector>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

enum class OnDeath { kGoOn, kEnd };
enum class OnSilence { kWait, kDrop };

struct LockstepSettings {
  double start_time = 1.0;                // s simulated, 1e-6 to 2e9
  std::vector<std::string> participants;  // the clock starts when all of these are there
  double settle =
      2.0;  // wall s without a new participant until it starts where none is named, 0-3600
  // s simulated, 1e-6 to 1000, that all takes from one participant to another; 0: none
  double lookahead = 0.0;
  double limit = 0.0;  // simulated s per wall s at most, 0.01 to 1e6; 0: none
  bool start_paused = false;
  std::uint32_t max_microsteps = 100'000;  // at one instant, at least 1
  double silence_limit = 10.0;             // wall s that a report may take, 0.001 to 86400; 0: any
  OnDeath on_death = OnDeath::kGoOn;
  OnSilence on_silence = OnSilence::kWait;
  bool end_when_idle = false;
  double end_at = 0.0;                  // s simulated, start_time to 2147483647; 0: no end
  std::vector<std::string> end_with;    // the run ends when one of these leaves, or dies
  std::vector<std::string> idle_nodes;  // whose threads wait for work, whatever they wait for
  bool strict = false;                  // the first label ends the run
  bool log_messages = false;  // messages and calls between participants go into the log too
  bool keeps_bytes = false;   // what was sent is in the lines for the log
  std::vector<std::string> excluded_topics;  // that do not go through the time master
  // "TOPIC" or "NODE=TOPIC": what is heard there is handed over with the next grant there is anyway
  std::vector<std::string> stored_topics;
  // Of a radio between hosts, as radio/network.h has them; none: there is no radio.
  std::vector<std::string> network;
  bool keep_unread = true;  // what roscpp programs look at by themselves is; false: for comparing
  std::vector<std::string> not_covered;  // why the log does not say all: labels of the run
  std::string secret;                    // that a HELLO must have; empty: none
  // Another legal order of equal events, as this says; 0: the stated one. Not with a lookahead.
  std::uint32_t chaos_seed = 0;
  double chaos_delay = 0.0;  // s simulated, that messages are under way at most, 0 to 1000
  std::string chaos_only;    // the decisions that are applied, see chaos::decisionsOf()
  bool keeps_decisions = false;
};

/** @return @p settings. @throws std::invalid_argument if one is out of its range. */
LockstepSettings checkedSettings(LockstepSettings settings);

/**
 * @return a speed limit in billionths; 0: none.
 * @throws std::invalid_argument unless @p factor is from 0.01 to 1e6, or 0.
 */
FactorUnits checkedLimit(double factor);

/** @return @p seconds in whole nanoseconds. */
Nanoseconds toNanoseconds(double seconds);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_SETTINGS_H
