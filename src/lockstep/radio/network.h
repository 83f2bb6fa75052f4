// What a radio is told beforehand: hosts, links, what is not on the air.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_NETWORK_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_NETWORK_H

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

/** @brief Which nodes are on a host, and where it is. */
struct HostRule {
  std::string name;                // with a `*`: one host for each text in place of it
  std::optional<Place> at;         // nothing: where the robot of the host's name is
  std::vector<std::string> nodes;  // patterns
};

/** @brief What becomes of a message that does not arrive. */
enum class OnLoss {
  kDrop,   // nothing
  kRetry,  // it is sent again, later and later, and those behind it wait: as TCP does
  kQueue   // the same at even times, until it arrives
};

/** @brief How it is between two hosts, in each direction. */
struct LinkRule {
  std::string one, other;      // patterns of hosts
  Nanoseconds delay_low = 0;   // simulated; evenly from this
  Nanoseconds delay_high = 0;  // to this
  Loss loss = 0.0;
  std::int64_t rate = 0;                                   // bit/s, of each direction; 0: any
  std::int64_t buffer = 0;                                 // bytes that may wait to be sent; 0: any
  double range = std::numeric_limits<double>::infinity();  // m
  double wall = 0.0;  // that a wall costs; of a path loss dB, else m
  OnLoss lost = OnLoss::kDrop;
  Nanoseconds retry = kNanosecondsPerSecond / 5;  // simulated; from a loss to the first other try
  std::uint32_t attempts = 8;                     // of kRetry; then the message is lost

  /** @return whether it matters where its hosts are. */
  bool needsPlaces() const;
};

struct Network {
  std::uint64_t seed = 0;
  std::vector<HostRule> hosts;     // the first that fits is it
  std::vector<LinkRule> links;     // the same; hosts between which there is none hear nothing
  std::vector<std::string> wired;  // patterns of topics and services
  Walls walls;

  bool isWired(std::string_view name) const;
  /** @return whether what does not arrive may be sent again, on any link. */
  bool hasWaiting() const;
};

/**
 * @return the network that @p lines describe: as `move_base_abstract.network` writes them, which
 * checks what a user has written.
 *
 * `seed N` | `host NAME robot NODES` | `host NAME at X Y NODES` | `wired TOPICS` | `walls X Y CELL
 * WIDTH HEIGHT` | `wall ROW BEGIN END ...` | `link ONE OTHER KEY VALUES ...` with `delay LOW HIGH`
 * [ns], `loss P`, `table COUNT M P ...`, `path POWER SENSITIVITY EXPONENT REFERENCE LOSS
 * SHADOWING`, `rate`, `buffer`, `range`, `wall`, `lost drop|retry|queue`, `retry` [ns],
 * `attempts`.
 * @throws std::invalid_argument that says which line is none.
 */
Network networkOf(const std::vector<std::string>& lines);

}  // namespace move_base_abstract::radio

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_NETWORK_H
