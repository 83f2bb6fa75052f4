// The places of robots at any instant, in closed form, from the motions that they have reported.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_MOTIONS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_MOTIONS_H

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clock/scaled_clock.h"
#include "walls.h"

namespace move_base_abstract::radio {

/**
 * @brief A robot's motion from an instant on: place, speed and acceleration at that instant, in the
 * global frame.
 */
struct Piece {
  Nanoseconds begin;  // simulated
  double x, y;        // m
  double vx, vy;      // m/s
  double ax, ay;      // m/s^2
};

/** @brief A robot's motion: pieces, one after the other. The last one goes on for ever. */
class Motion {
 public:
  Motion() = default;
  /** @param pieces at least one, their begins ascending. */
  explicit Motion(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {}

  /** @return the robot's place; before the first piece, the place where that begins. */
  Place at(Nanoseconds now) const;
  /**
   * @return the instant from which on the robot stands, as far as is known; kNever: it moves on.
   */
  Nanoseconds end() const;

 private:
  std::vector<Piece> pieces_;
};

/**
 * @return the pieces in @p bytes. Each piece is an i64 and six f64, little endian, in the order of
 * its members.
 * @throws std::invalid_argument if @p bytes is empty or cut, a number is not finite, or the
 * instants do not ascend.
 */
std::vector<Piece> piecesOf(std::string_view bytes);

}  // namespace move_base_abstract::radio

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_MOTIONS_H
