// Late starts: nodes whose programs begin later, and links that are up later. No ROS, no sockets.
#pragma once

#include <string>
#include <string_view>

#include "clock/scaled_clock.h"
#include "decisions.h"

namespace move_base_abstract::chaos {

/**
 * @brief Lateness of nodes and of links, up to a bound: as if processes started at any time.
 *
 * A link has a tenth of the bound. A connection of ROS takes some hundredths of the time that a
 * process takes to start.
 */
class Starts {
 public:
  /** @param most ns, simulated. */
  Starts(Decisions& decisions, Nanoseconds most) : decisions_(decisions), most_(most) {}

  /** @return how much later than @p now, the start of time, the program of @p node begins. */
  Nanoseconds ofNode(Nanoseconds now, const std::string& node);
  /** @return how much later than @p now, when both ends are there, a link is up. */
  Nanoseconds ofLink(Nanoseconds now, std::string_view publisher, std::string_view subscriber,
                     std::string_view topic);

 private:
  Decisions& decisions_;
  const Nanoseconds most_;
};

}  // namespace move_base_abstract::chaos
