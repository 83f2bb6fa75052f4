// Where robots are at any instant, as they have told it: in closed form.
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

/** @brief How a robot moves from an instant on: place, speed and acceleration at that instant. */
struct Piece {
  Nanoseconds begin;  // simulated
  double x, y;        // m
  double vx, vy;      // m/s
  double ax, ay;      // m/s^2
};

/** @brief A robot's motion: pieces, one behind the other; the last one goes on for ever. */
class Motion {
 public:
  Motion() = default;
  /** @param pieces at least one, their begins ascending. */
  explicit Motion(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {}

  /** @return where it is; before its first piece, where that begins. */
  Place at(Nanoseconds now) const;
  /** @return the first instant from which on it stands for good as far as it is known: kNever. */
  Nanoseconds end() const;

 private:
  std::vector<Piece> pieces_;
};

/**
 * @return the pieces that @p bytes hold: for each an i64 and six f64, little endian.
 * @throws std::invalid_argument if they are none: empty, cut, not finite, not in order.
 */
std::vector<Piece> piecesOf(std::string_view bytes);

}  // namespace move_base_abstract::radio

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_MOTIONS_H
