// A piece of a robot's motion, and the pose and the velocity at any instant, in closed form.
// The same formulas in the same order stand in move_base_abstract/motion/pieces.py: the results are
// the same to the last bit. A table of cases (test/data/pieces.json) holds both to one another.
#pragma once

#include <cmath>

#include "clock/scaled_clock.h"

namespace move_base_abstract::motion {

/**
 * @brief A piece of a motion, until the next one begins: straight with constant acceleration or
 * exponential braking, or a turn, or rest.
 */
struct Piece {
  Nanoseconds begin;  // simulated
  double x, y, yaw;   // m, m, rad: the pose at its begin, in the global frame
  double ux, uy;      // the direction of a forward speed, of length 1
  double v, a, w;     // m/s: forward speed at its begin; m/s^2; rad/s: turn rate at its begin
  double k;           // 1/s: speed and turn rate shrink by this rate; 0: they do not
};

struct Pose {
  double x, y, yaw;  // m, m, rad in (-pi, pi]
};

struct Velocity {
  double forward, turning;  // m/s, rad/s
};

/** @return the angle in (-pi, pi] that is equal to @p angle [rad]. */
inline double normalized(double angle) {
  constexpr double kPi = 3.141592653589793;
  const double wrapped = std::fmod(angle, 2.0 * kPi);
  return -kPi < wrapped && wrapped <= kPi ? wrapped : wrapped - std::copysign(2.0 * kPi, wrapped);
}

/** @return the pose at @p now [ns, simulated], which is not before the piece begins. */
inline Pose poseOf(const Piece& piece, Nanoseconds now) {
  const double e = static_cast<double>(now - piece.begin) / 1e9;
  const double g = piece.k == 0.0 ? e : (1.0 - std::exp(-piece.k * e)) / piece.k;
  const double s = piece.v * g + 0.5 * piece.a * e * e;
  return {piece.x + s * piece.ux, piece.y + s * piece.uy, normalized(piece.yaw + piece.w * g)};
}

/** @return the velocity at @p now [ns, simulated], which is not before the piece begins. */
inline Velocity velocityOf(const Piece& piece, Nanoseconds now) {
  const double e = static_cast<double>(now - piece.begin) / 1e9;
  const double h = piece.k == 0.0 ? 1.0 : std::exp(-piece.k * e);
  return {piece.v * h + piece.a * e, piece.w * h};
}

}  // namespace move_base_abstract::motion
