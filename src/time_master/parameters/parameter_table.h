// The table of the time master's parameters. The node and the documentation page both use it.
#pragma once

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>

namespace move_base_abstract {

/**
 * @brief The description of one parameter. Numbers are held to the range in `allowed`,
 * "[0, ]LOW to HIGH"; the other checks are in parameters.h.
 */
struct ParameterRow {
  const char* name;
  const char* type;
  const char* unit;
  const char* standard;
  const char* allowed;
  const char* what;
};

constexpr ParameterRow kParameterTable[] = {
    {"mode", "text", "", "scaled", "scaled, lockstep", "Mode at the start."},
    {"factor", "number", "simulated s per wall s", "1", "0.01 to 1e6",
     "Factor at the start; for scaled only."},
    {"busy_factor", "number", "simulated s per wall s", "1", "0, 0.01 to 1e6",
     "Upper limit of the factor while a node holds the clock; 0 freezes it; for scaled only."},
    {"finest_step", "number", "s, simulated", "0.01", "1e-6 to 3600",
     "Least step between two times on `/clock`, except at a stop or a freeze; for scaled only."},
    {"max_clock_rate", "number", "Hz, wall", "500", "1 to 10000",
     "Upper limit of the rate of `/clock`; in lockstep only onlookers hear it, so the default is "
     "200."},
    {"start_time", "number", "s, simulated", "1", "1e-6 to 2e9", "The first instant."},
    {"start_paused", "true or false", "", "false", "true, false",
     "Whether time stands still until resume, step, run_until or stop_when."},
    {"start_stopped", "true or false", "", "false", "true, false",
     "Whether the run is stopped before its first round, until resume, step, run_until or "
     "stop_when; for lockstep only."},
    {"repeat_rate", "number", "Hz, wall", "20", "1 to 1000",
     "Rate at which the last time is repeated while there is no new one."},
    {"longest_gap", "number", "s, wall", "0.25", "0.2 to 3e9",
     "If the time master did not run for longer than this, only this much counts, and a warning "
     "says so; for scaled only."},
    {"state_rate", "number", "Hz, wall", "2", "0.1 to 100",
     "Rate at which the state is sent; it is also sent on each change."},
    {"participants", "list of texts", "", "[]", "list of node names",
     "Time starts when all of these nodes take part; names without a leading `/` are below the "
     "root."},
    {"settle", "number", "s, wall", "2", "0 to 3600",
     "If no participants are named, time starts when no node has joined for this time; the run is "
     "then not repeatable."},
    {"lookahead", "number", "s, simulated", "0", "0, 1e-6 to 1000",
     "Time that every message takes from one participant to another; each participant goes through "
     "windows of this length by itself."},
    {"chaos_seed", "whole number", "", "0", "0 to 2147483647",
     "Seed of another legal order of equal events; 0 is the stated order."},
    {"chaos_delay", "number", "s, simulated", "0", "0 to 1000",
     "With a `chaos_seed`, messages take up to this time."},
    {"chaos_starts", "number", "s, simulated", "0", "0 to 1000",
     "With a `chaos_seed`, nodes start up to this time late, and connections up to a tenth of it."},
    {"chaos_only", "list of texts", "", "[]", "list of texts: 12 hexadecimal digits each, or none",
     "Names of the decisions that are applied, 12 hexadecimal digits each, or `none`; empty: all."},
    {"chaos_decisions", "text", "", "", "path of a new file",
     "New file for the decisions that were applied, written when the run ends."},
    {"speed_limit", "number", "simulated s per wall s", "0", "0, 0.01 to 1e6",
     "Upper limit of the speed of the run; 0: no limit."},
    {"sim_time_factor_is_limit", "true or false", "", "false", "true, false",
     "Whether `/sim_time_factor` sets the speed limit in lockstep."},
    {"silence_limit", "number", "s, wall", "10", "0, 0.001 to 86400",
     "A participant that works longer than this on one instant is named in the log; 0: never."},
    {"longest_leap", "number", "s, simulated", "86400", "1e-6 to 2147483647",
     "A longer leap of time is a warning that names who has asked for it, and a label if it leads "
     "to the machine's own time; for lockstep only."},
    {"on_silence", "text", "", "wait", "wait, drop",
     "Whether time waits for a silent participant, or drops it as if it had died."},
    {"on_death", "text", "", "go_on", "go_on, end",
     "Whether the run goes on when a participant dies (labelled degraded), or ends."},
    {"max_microsteps", "whole number", "", "100000", "1 to 1e8",
     "Number of rounds at one instant that count as a zero-delay loop, which is named and "
     "stopped."},
    {"event_log", "text", "", "", "path ending in .jsonl or .csv",
     "File for the events of the run; '': none."},
    {"excluded_topics", "list of texts", "", "[]", "list of topics",
     "Topics that do not count: participants leave them to the connections of ROS."},
    {"lockstep_secret_file", "text", "", "", "path of a file of mode 0600",
     "File of mode 0600 with a secret that participants must have; '': none."},
    {"lockstep_secret", "text", "", "", "1 to 1024 bytes",
     "The same secret as a parameter, which everybody who reaches the ROS master can read."},
    {"not_covered", "list of texts", "", "[]", "list of texts",
     "Reasons why the log does not cover the whole run, which is then not called repeatable."},
    {"onlookers", "list of texts", "", "[]", "list of node names",
     "Nodes that do not take part, and whose topics and services participants may need at once: "
     "time stands at its first instant until they are there, for at most 5 s of wall time."},
    {"message_bytes", "text", "", "", "path of a new file",
     "New file for the bytes of the messages between participants, at most 256 MiB; `verify` reads "
     "it."},
    {"note_of_start", "text", "", "", "path of a new file",
     "New empty file that appears when time has started."},
    {"note_of_end", "text", "", "", "path of a new file",
     "New file of JSON that appears when the run has ended and the log is written: `ended_by`, "
     "`at_ns`, `rounds`, `leaps`, `messages`."},
    {"log_messages", "true or false", "", "false", "true, false",
     "Whether messages and calls between participants are events of the log, too."},
    {"keep_messages", "whole number", "", "0", "0 to 100000",
     "Number of the latest messages of each topic and service that are kept for `~recent`, at most "
     "16 MiB of each; for lockstep only."},
    {"event_log_of_ends", "true or false", "", "false", "true, false",
     "Whether the log has only its end and the events of uncaught exceptions."},
    {"strict", "true or false", "", "false", "true, false",
     "Whether the first reason not to call the run repeatable ends it with exit code 1."},
    {"end_when_idle", "true or false", "", "false", "true, false",
     "Whether the run ends when no participant has anything left to do: exit code 0, or 1 for a "
     "deadlock or a zero-delay loop."},
    {"network", "list of texts", "", "[]", "lines",
     "Lines of a radio network, as the launcher makes them of the network's file; not with a "
     "lookahead."},
    {"stored_topics", "list of texts", "", "[]", "list of TOPIC, NODE=TOPIC",
     "Topics that nodes only store; they are handed over with the next thing that a node does, "
     "after 1 s at the latest."},
    {"keep_unread", "true or false", "", "true", "true, false",
     "Whether messages for a roscpp program that looks at its queues only at its own ticks are "
     "kept until then."},
    {"idle_nodes", "list of texts", "", "[]", "list of node names",
     "Nodes whose waiting threads always count as waiting for work when a run is called idle or a "
     "deadlock."},
    {"end_at", "number", "s, simulated", "0", "0, 1e-6 to 2147483647",
     "The run ends at this instant, which is not before `start_time`, with exit code 0; 0: no "
     "end."},
    {"end_with", "list of texts", "", "[]", "list of node names",
     "The run ends with the round in which the first of these nodes leaves (exit code 0) or dies "
     "(1)."},
    {"cores", "text", "", "one", "one, all, auto",
     "Cores of their computer on which participants run: `one`, or `all`, as always with a "
     "lookahead; `auto` is an old word for `one`; events do not depend on them."},
    {"shared_memory", "true or false", "", "true", "true, false",
     "Whether participants in C++ on this computer may report through memory that they share with "
     "the time master; events do not depend on it."},
    {"lockstep_port", "whole number", "", "0", "0 to 65535",
     "TCP port for participants; 0: any free one."},
};

/** @return whether the table has a row for @p name. */
inline bool isParameter(const std::string& name) {
  return std::any_of(std::begin(kParameterTable), std::end(kParameterTable),
                     [&](const ParameterRow& row) { return name == row.name; });
}

/** @throws std::invalid_argument unless @p value is in the range that its row allows. */
inline void checkRange(const std::string& name, double value) {
  const ParameterRow* const row =
      std::find_if(std::begin(kParameterTable), std::end(kParameterTable),
                   [&](const ParameterRow& each) { return name == each.name; });
  const std::string allowed = row->allowed;
  const bool or_zero = allowed.rfind("0, ", 0) == 0;
  double low = 0.0;
  double high = 0.0;
  const char* const range = row->allowed + (or_zero ? 3 : 0);
  if (std::sscanf(range, "%lf to %lf", &low, &high) != 2 || (or_zero && value == 0.0) ||
      (value >= low && value <= high)) {
    return;
  }
  std::ostringstream text;
  text.precision(9);
  text << name << " must be from " << low << " to " << high << (*row->unit != '\0' ? " " : "")
       << row->unit << (or_zero ? ", or 0" : "") << ", got " << value;
  throw std::invalid_argument(text.str());
}

}  // namespace move_base_abstract
