// A window of simulated time through which a participant goes by itself.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_WINDOW_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_WINDOW_H

#include <deque>
#include <string>
#include <string_view>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {

class Window {
 public:
  /**
   * @brief If @p grant gives one, take it out of the grant, and keep what arrives later in it.
   * @return whether it gives one.
   */
  bool take(wire::Grant* grant);

  /** @return how long it takes until others know, and as long for their answer; 0: a round [ns]. */
  Nanoseconds lookahead() const { return lookahead_; }
  /** @return when what was kept first arrives, or kNever. */
  Nanoseconds firstArrival() const { return arrivals_.empty() ? kNever : arrivals_.front().at; }
  /**
   * @param wish the instant at which the program wants to go on. @param now that of its last turn.
   * @return the instant of its next turn in the window, or kNever: there is none.
   */
  Nanoseconds next(Nanoseconds wish, Nanoseconds now);
  /** @return what arrives not after @p now, as a frame of a grant without its length; '': nothing.
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
  unsigned repeats_ = 0;  // of an instant
  std::deque<Arrival> arrivals_;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_WINDOW_H
