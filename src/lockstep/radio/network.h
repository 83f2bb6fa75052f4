// The description of a network: hosts, links, and the topics and services that are not on the
// radio.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clock/scaled_clock.h"
#include "loss.h"
#include "walls.h"

namespace move_base_abstract::radio {

/** @brief A rule for hosts: the nodes on a host, and its place. */
struct HostRule {
  std::string name;                // with a `*`: one host for each text that it matches
  std::optional<Place> at;         // nothing: the place of the robot of this name
  std::vector<std::string> nodes;  // patterns
};

/** @brief What happens to a message that does not arrive. */
enum class OnLoss {
  kDrop,   // nothing
  kRetry,  // it is sent again after growing times, and later messages wait, as with TCP
  kQueue   // the same at equal intervals, until it arrives
};

/** @brief The properties of a link between two hosts, in each direction. */
struct LinkRule {
  std::string one, other;      // patterns of hosts
  Nanoseconds delay_low = 0;   // simulated; drawn uniformly from this
  Nanoseconds delay_high = 0;  // to this
  Loss loss = 0.0;
  std::int64_t rate = 0;                                   // bit/s, of each direction; 0: any
  std::int64_t buffer = 0;                                 // bytes that may wait to be sent; 0: any
  double range = std::numeric_limits<double>::infinity();  // m
  double wall = 0.0;  // cost of a wall; with a path loss dB, else m
  OnLoss lost = OnLoss::kDrop;
  Nanoseconds retry = kNanosecondsPerSecond / 5;  // simulated; between the first two attempts
  std::uint32_t attempts = 8;                     // for kRetry; then the message is lost

  /** @return whether the places of the hosts matter. */
  bool needsPlaces() const;
};

struct Network {
  std::uint64_t seed = 0;
  std::vector<HostRule> hosts;     // the first one that fits counts
  std::vector<LinkRule> links;     // the same; without a link, hosts do not reach each other
  std::vector<std::string> wired;  // patterns of topics and services
  Walls walls;

  bool isWired(std::string_view name) const;
  /** @return whether there is a link on which a message may be sent again. */
  bool hasWaiting() const;
};

/**
 * @return the network that @p lines describe. The module `move_base_abstract.network` writes these
 * lines, and checks the user's file.
 *
 * `seed N` | `host NAME robot NODES` | `host NAME at X Y NODES` | `wired TOPICS` | `walls X Y CELL
 * WIDTH HEIGHT` | `wall ROW BEGIN END ...` | `link ONE OTHER KEY VALUES ...` with `delay LOW HIGH`
 * [ns], `loss P`, `table COUNT M P ...`, `path POWER SENSITIVITY EXPONENT REFERENCE LOSS
 * SHADOWING`, `rate`, `buffer`, `range`, `wall`, `lost drop|retry|queue`, `retry` [ns], `attempts`.
 * @throws std::invalid_argument that quotes the first line which is not valid.
 */
Network networkOf(const std::vector<std::string>& lines);

}  // namespace move_base_abstract::radio
