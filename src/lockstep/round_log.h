// The lines that one round adds to the event log, in their stated order.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "lockstep/rounds/order.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/routing/router.h"

namespace move_base_abstract {

/** @brief A line of the event log. */
struct LockstepLogEntry {
  Nanoseconds time;    // simulated
  std::string robot;   // for a message or call: the topic's or service's name
  std::string kind;    // with log_messages also "message", "call", "response"
  std::string values;  // a JSON array
  std::string type;    // of a message, and
  std::string bytes;   // its bytes, if they are kept
};

/** @brief Collects the lines of a round, and puts them in order at its end. */
class RoundLog {
 public:
  using NameOf = MessageRouter::Delivery::NameOf;
  using Seen = std::function<void(const LockstepLogEntry&)>;

  /**
   * @param rounds the rounds, for their instant; must outlive this object.
   * @param keeps_bytes whether entries have the bytes that were sent.
   * @param seen is called for each line, in the log's order.
   */
  RoundLog(const LockstepRounds& rounds, bool keeps_bytes, Seen seen)
      : rounds_(rounds), keeps_bytes_(keeps_bytes), seen_(std::move(seen)) {}

  /** @brief Add a line that a participant writes itself. */
  void add(const MailOrder& order, const wire::Log& log);
  /** @brief Add a line about a message, call or response between participants. */
  void add(const MessageRouter::Delivery& delivery, const NameOf& name_of);
  /** @brief Add a line about something that was sent at @p order. */
  void add(const MailOrder& order, LockstepLogEntry entry) {
    round_.push_back({order, std::move(entry)});
  }
  /** @brief Set a function that gives the lines up to now that come before those of a round. */
  void setBefore(std::function<std::vector<LockstepLogEntry>()> before) {
    before_ = std::move(before);
  }
  void closeRound();
  /** @brief Forget the lines of the round. */
  void dropRound() { round_.clear(); }

  /** @return the lines of the rounds closed since the last call. */
  std::vector<LockstepLogEntry> take();

 private:
  void addBefore();
  void append(LockstepLogEntry&& line);

  struct Line {
    MailOrder order;
    LockstepLogEntry entry;
  };

  const LockstepRounds& rounds_;
  const bool keeps_bytes_;
  const Seen seen_;
  std::function<std::vector<LockstepLogEntry>()> before_;
  std::vector<Line> round_;
  std::vector<LockstepLogEntry> log_;
};

}  // namespace move_base_abstract
