// The data that the parts of a session share.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "clock/scaled_clock.h"
#include "connections.h"
#include "interruption.h"
#include "kept_messages.h"
#include "labels.h"
#include "lockstep/chaos/chaos.h"
#include "lockstep/chaos/starts.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/rounds/settings.h"
#include "lockstep/routing/router.h"
#include "member.h"
#include "message.h"
#include "parameters.h"
#include "radio_traffic.h"
#include "round_log.h"
#include "status.h"
#include "stops.h"

namespace move_base_abstract {

/**
 * @return a text such as "chaos seed 7 with delays up to 0.05 s and starts up to 0.5 s late"; ''
 * without chaos.
 */
std::string chaosText(const LockstepSettings& settings);

/**
 * @brief The state of a run of the event-driven clock. Each field has its own rules; the parts of
 * the session change them.
 */
struct LockstepRun {
  LockstepRun(const LockstepSettings& settings, Nanoseconds wall);
  LockstepRun(const LockstepRun&) = delete;
  LockstepRun& operator=(const LockstepRun&) = delete;

  /** @brief Add a carrier, which comes after those that were added before. */
  void addCarrier(std::unique_ptr<Carrier> carrier);
  void addRadio();
  void decideWaiting();
  /** @brief Have what is delivered from now on logged, kept, and seen by the stops. */
  void traceDeliveries();

  const LockstepSettings settings;
  RadioTraffic* radio = nullptr;  // one of the carriers; null: there is no radio
  chaos::Decisions decisions;
  LockstepRounds rounds;
  Stops stops;
  KeptMessages kept;
  RoundLog log;
  Carriage carriage;
  MessageRouter router;
  Nanoseconds wall;  // the latest instant of the limits' clock, see LimitsClock
  Connections connections;
  SessionMembers members;
  ChangedMembers changed;
  StatusText text;
  MessageList messages;
  RunLabels labels;
  ParameterBook parameters;
  Interruption interruption;
  std::set<std::string> looked_at;      // nodes, of which some may not take part
  std::unique_ptr<chaos::Order> order;  // of equal events; null: the stated order

 private:
  void beChaotic();
  void startLate();
  void followArrivals();

  std::unique_ptr<chaos::Starts> starts_;  // null: all start together
};

}  // namespace move_base_abstract
