// A window of simulated time, through which a participant goes by itself.
#pragma once

#include <deque>
#include <string>
#include <string_view>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {

class Window {
 public:
  /**
   * @brief If @p grant has a window, take it out of the grant, and keep the mail that arrives later
   * in it. @return whether it has a window.
   */
  bool take(wire::Grant* grant);

  /**
   * @return the time [ns] that a message takes to another participant, and its answer as well; 0: a
   * round.
   */
  Nanoseconds lookahead() const { return lookahead_; }
  /** @return the instant of the first arrival that is kept, or kNever. */
  Nanoseconds firstArrival() const { return arrivals_.empty() ? kNever : arrivals_.front().at; }
  /**
   * @param wish the instant at which the program wants to go on.
   * @param now the instant of its last turn.
   * @return the instant of its next turn in the window; kNever: there is none.
   */
  Nanoseconds next(Nanoseconds wish, Nanoseconds now);
  /**
   * @return the mail that arrives up to @p now, as the frame of a grant without its length; '':
   * none.
   */
  std::string arrived(Nanoseconds now);

 private:
  struct Arrival {
    Nanoseconds at;
    std::string frame;
  };

  bool is_open_ = false;
  Nanoseconds end_ = 0;
  Nanoseconds lookahead_ = 0;
  unsigned repeats_ = 0;  // turns at the same instant
  std::deque<Arrival> arrivals_;
};

}  // namespace move_base_abstract::lockstep::internal
