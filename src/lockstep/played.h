// Messages that the time master makes and sends in a participant's place: series of one template.
// No ROS, no sockets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "lockstep/wire/wire.h"
#include "motion/motion.h"

namespace move_base_abstract {

/**
 * @brief The actions of a turn, which wait for the end of the round, and the frame that they point
 * into.
 */
struct PendingTurn {
  std::shared_ptr<const std::string> frame;
  std::vector<wire::ReportItem> items;
};

/** @brief A turn that a participant has had by itself in a window, or that was played in it. */
struct WalkedTurn {
  Nanoseconds at = 0;  // simulated
  PendingTurn turn;
};

/** @brief The series that a participant has played, until its next turn. */
class Played {
 public:
  /** @brief Play nothing any more. How robots move is kept. */
  void stop() {
    series_.clear();
    due_.clear();
    frame_ = nullptr;
  }
  /** @return the instant [ns, simulated] of the next message; kNever: there is none. */
  Nanoseconds next() const { return due_.empty() ? kNever : due_.front().first; }
  /**
   * @brief Take an item of a report, if it says what is to be played, or how a robot moves.
   * @param frame the bytes that @p item points into. @param now the instant of its turn.
   * @return whether the item is done; a robot's MOTION is not if there is a radio, which needs it,
   * too.
   * @throws wire::MalformedFrame if it is no motion, or a series does not begin after @p now, or
   * has wrong slots.
   */
  bool takeItem(const wire::ReportItem& item, const std::shared_ptr<const std::string>& frame,
                Nanoseconds now, bool has_radio);
  /** @brief Append the turns before @p until to @p turns. */
  void takeUntil(Nanoseconds until, std::deque<WalkedTurn>* turns);
  /** @return the turn at next(), in which all messages of that instant are sent. */
  PendingTurn take();

 private:
  struct Slot {
    wire::Slot kind;
    std::size_t place;
    std::uint32_t mover;  // whose motion it shows: the sub, or that of its odometry
  };
  struct Series {
    wire::Play play;
    std::vector<Slot> slots;
  };
  using Due = std::pair<Nanoseconds, std::size_t>;  // the instant, and the place in `series_`

  void move(const wire::Motion& motion);
  void add(const wire::Play& play, const std::shared_ptr<const std::string>& frame,
           Nanoseconds now);
  Slot slotOf(const wire::Play& play, std::size_t begin) const;
  std::vector<Series*> takeDue(Nanoseconds now);
  void fill(char* bytes, const Series& series, Nanoseconds now) const;

  std::map<std::uint32_t, motion::Motion> motions_;  // by sub, or by that of an odometry
  std::vector<Series> series_;
  std::vector<Due> due_;  // a heap, the earliest first
  std::shared_ptr<const std::string> frame_;
};

}  // namespace move_base_abstract
