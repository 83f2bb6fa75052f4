// The hosts of a radio: which node is on which, where they are, and how they reach each other.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_HOSTS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_HOSTS_H

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motions.h"
#include "network.h"

namespace move_base_abstract::radio {

/** @brief A host's number: from 1 on, in the order in which they came up; 0: none. */
using HostId = std::uint32_t;

/** @brief Links are looked at so often [ns, simulated] while one of their hosts moves. */
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
  /** @return the first rule of links that fits both; nothing: there is none. */
  const LinkRule* rule(HostId one, HostId other) const;

  /** @brief The robot of this name moves so from now on. @return the host that goes with it; 0. */
  HostId move(const std::string& robot, std::vector<Piece> pieces);
  bool isFixed(HostId id) const { return hosts_[id - 1].rule->at.has_value(); }
  /** @return where it is; nothing of one that goes with a robot which has told nothing. */
  std::optional<Place> place(HostId id, Nanoseconds now) const;
  /** @return the instant from which on it stands, as far as it is known. */
  Nanoseconds standsFrom(HostId id) const;

  /** @brief What lies between two hosts at an instant. */
  struct Reach {
    bool is_up;      // a message may get through
    double loss;     // the probability that it does not
    bool is_placed;  // else it matters where both are, and nobody has told
  };
  /** @return whether a link of it asks where it is, which nobody has told. */
  bool lacksPlace(HostId id) const;
  /** @return whether no node that is there is on a host of @p rule, one of the network's. */
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
  std::map<std::string, Motion, std::less<>> motions_;  // by robot
};

}  // namespace move_base_abstract::radio

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_HOSTS_H
