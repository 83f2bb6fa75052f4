// The radio between hosts: whether a message arrives, and when. No ROS, no clock of its own.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_RADIO_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_RADIO_H

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hosts.h"

namespace move_base_abstract::radio {

/** @brief A message's number, of whoever sends it over the radio. */
using Ticket = std::uint64_t;

/** @brief Why a message is lost, as the event log has it. */
namespace lost_by {
constexpr const char* kNoLink = "no_link";  // the network has none between the two hosts
constexpr const char* kRange = "range";     // out of reach
constexpr const char* kPlace = "no_place";  // the robot of one of both has not told where it is
constexpr const char* kLoss = "loss";       // by chance
constexpr const char* kBuffer = "buffer";   // too much waits to be sent
}  // namespace lost_by

/**
 * @brief Messages between hosts, with range, loss, delay and rate.
 *
 * Each direction of a link sends one message after the other, and they arrive in this order. What
 * chance decides follows from the seed, the names of the two hosts and the number of the message
 * among those of its direction.
 */
class Radio {
 public:
  struct Outcome {
    enum class Kind { kArrives, kLost, kWaits };
    Kind kind;
    Nanoseconds at;      // simulated; when it arrives
    const char* reason;  // one of lost_by, of what is lost
  };
  struct Decided {
    Ticket ticket;
    Outcome outcome;
  };

  explicit Radio(Network network) : hosts_(std::move(network)) {}

  Hosts& hosts() { return hosts_; }
  const Hosts& hosts() const { return hosts_; }

  /** @brief Send @p bytes. What waits is decided on by look(), in its order. @pre from != to */
  Outcome send(HostId from, HostId to, std::size_t bytes, Ticket ticket, Nanoseconds now);
  /** @brief A host has begun to move otherwise: what waits for that is looked at again. */
  void moved(HostId host, Nanoseconds now);
  /** @return the instant at which to look() at what waits; kNever: as long as nothing else is. */
  Nanoseconds nextLook() const { return looks_.empty() ? kNever : looks_.begin()->first; }
  /** @return what is decided at @p now of what has waited. */
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
    Nanoseconds free = 0;      // all before has been sent then
    Nanoseconds latest = 0;    // arrival
    std::deque<Waiting> waiting;
    std::size_t waiting_bytes = 0;
    Nanoseconds look = kNever;  // at the first of them
    bool sleeps = false;        // until one of both moves
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

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_RADIO_H
