// The hosts of a radio: the nodes on each host, the hosts' places, and how they reach each other.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/motion.h"
#include "network.h"

namespace move_base_abstract::radio {

/** @brief A host's number, from 1 on, in the order in which hosts first appeared; 0: none. */
using HostId = std::uint32_t;

/** @brief The period [ns, simulated] of looks at a link while one of its hosts moves. */
constexpr Nanoseconds kLookPeriod = kNanosecondsPerSecond / 10;

/** @return the first multiple of kLookPeriod after @p now. */
constexpr Nanoseconds nextLookAfter(Nanoseconds now) {
  return (now / kLookPeriod + 1) * kLookPeriod;
}

class Hosts {
 public:
  explicit Hosts(Network network) : network_(std::move(network)) {}

  const Network& network() const { return network_; }
  /** @return the host that @p node is on; 0: none. */
  HostId of(std::string_view node);
  std::size_t count() const { return hosts_.size(); }
  const std::string& name(HostId id) const { return hosts_[id - 1].name; }
  /** @return the first link rule that fits both hosts; null: there is none. */
  const LinkRule* rule(HostId one, HostId other) const;

  /** @brief Set how the robot moves from now on. @return the host that moves with it; 0: none. */
  HostId move(const std::string& robot, const motion::Motion& motion);
  bool isFixed(HostId id) const { return hosts_[id - 1].rule->at.has_value(); }
  /** @return the host's place; nothing if it moves with a robot that has not reported a motion. */
  std::optional<Place> place(HostId id, Nanoseconds now) const;
  /** @return the instant from which on the host stands, as far as is known; kNever: it moves on. */
  Nanoseconds standsFrom(HostId id) const;

  /** @brief The connection between two hosts at an instant. */
  struct Reach {
    bool is_up;      // a message may get through
    double loss;     // the probability that it does not
    bool is_placed;  // false: both places matter, and one is not known
  };
  /** @return whether the host's place matters for a link, but is not known. */
  bool lacksPlace(HostId id) const;
  /** @return whether no node is on a host of @p rule, which is a rule of this network. */
  bool isWithoutNodes(const HostRule& rule) const;
  Reach reach(const LinkRule& rule, HostId one, HostId other, Nanoseconds now) const;

 private:
  struct Host {
    std::string name;
    const HostRule* rule;
  };

  HostId add(const std::string& name, const HostRule& rule);

  const Network network_;
  std::vector<Host> hosts_;
  std::map<std::string, HostId, std::less<>> ids_;
  std::map<std::string, motion::Motion, std::less<>> motions_;  // by robot
};

}  // namespace move_base_abstract::radio
