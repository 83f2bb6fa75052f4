// The radio between hosts, which decides whether a message arrives, and when. No ROS, no clock of
// its own.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hosts.h"

namespace move_base_abstract::radio {

/** @brief A message's number, which the sender chooses. */
using Ticket = std::uint64_t;

/** @brief The reasons why a message is lost, as the event log names them. */
namespace lost_by {
constexpr const char* kNoLink = "no_link";  // the network has no link between the two hosts
constexpr const char* kRange = "range";     // out of reach
constexpr const char* kPlace = "no_place";  // a host's robot has not reported its place
constexpr const char* kLoss = "loss";       // by chance
constexpr const char* kBuffer = "buffer";   // too many bytes wait to be sent
}  // namespace lost_by

/**
 * @brief Messages between hosts, with range, loss, delay and rate.
 *
 * Each direction of a link sends one message after the other, and they arrive in this order. What
 * is drawn follows from the seed, the names of the two hosts, and the number of the message in its
 * direction.
 */
class Radio {
 public:
  struct Outcome {
    enum class Kind { kArrives, kLost, kWaits };
    Kind kind;
    Nanoseconds at;      // simulated; when it arrives, or is lost
    const char* reason;  // one of lost_by, if it is lost
  };
  struct Decided {
    Ticket ticket;
    Outcome outcome;
  };

  explicit Radio(Network network) : hosts_(std::move(network)) {}

  Hosts& hosts() { return hosts_; }
  const Hosts& hosts() const { return hosts_; }

  /**
   * @brief Send a message of @p bytes. If it has to wait, a later look() decides on it. @pre from
   * != to
   */
  Outcome send(HostId from, HostId to, std::size_t bytes, Ticket ticket, Nanoseconds now);
  /**
   * @brief A host has begun to move in another way, so messages that wait for this are looked at
   * again.
   */
  void moved(HostId host, Nanoseconds now);
  /**
   * @return the instant at which to look() at the waiting messages; kNever: not before send() or
   * moved() changes that.
   */
  Nanoseconds nextLook() const { return looks_.empty() ? kNever : looks_.begin()->first; }
  /** @return the waiting messages that are decided at @p now, with their outcomes. */
  std::vector<Decided> look(Nanoseconds now);

 private:
  struct Waiting {
    Ticket ticket;
    std::size_t bytes;
    std::uint64_t number;
    std::uint32_t attempt;
  };
  struct Channel {
    HostId from, to;
    const LinkRule* rule;
    std::uint64_t key;
    std::uint64_t number = 0;  // of the next message
    Nanoseconds free = 0;      // when all earlier messages have been sent
    Nanoseconds latest = 0;    // arrival so far
    std::deque<Waiting> waiting;
    std::size_t waiting_bytes = 0;
    Nanoseconds look = kNever;  // when to look at the first of them
    bool sleeps = false;        // until one of the hosts moves
  };

  Channel& channel(HostId from, HostId to);
  bool isFull(const Channel& channel, std::size_t bytes, Nanoseconds now) const;
  Outcome attempt(Channel& channel, Waiting& message, Nanoseconds now);
  Outcome fail(Channel& channel, Waiting& message, const char* reason, Nanoseconds now);
  void setLook(Channel& channel, Nanoseconds look);

  Hosts hosts_;
  std::deque<Channel> channels_;
  std::map<std::pair<HostId, HostId>, std::size_t> numbers_;
  std::set<std::pair<Nanoseconds, std::size_t>> looks_;
};

}  // namespace move_base_abstract::radio
