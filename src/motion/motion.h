// Where a robot is at any instant, by the pieces of the motion that it has reported.
#pragma once

#include <string_view>
#include <vector>

#include "piece.h"

namespace move_base_abstract::motion {

/** @brief A robot's motion: pieces, one after the other. The last one goes on for ever. */
class Motion {
 public:
  /**
   * @param bytes at least one piece. A piece is an i64 and nine f64, little endian, in the order of
   * its members.
   * @throws std::invalid_argument if @p bytes is empty or cut, a number is not finite, or the
   * instants do not ascend.
   */
  explicit Motion(std::string_view bytes);

  /** @return the pose at @p now; before the first piece, the pose where that begins. */
  Pose poseAt(Nanoseconds now) const;
  /** @return the velocity at @p now; before the first piece, 0. */
  Velocity velocityAt(Nanoseconds now) const;
  /**
   * @return the instant from which on the robot stands, as far as is known; kNever: it moves on.
   */
  Nanoseconds end() const;

 private:
  const Piece& pieceAt(Nanoseconds now) const;

  std::vector<Piece> pieces_;
};

}  // namespace move_base_abstract::motion
