// A piece of a robot's motion, and the pose and the velocity at any instant, in closed form.
// The same formulas in the same order stand in move_base_abstract/motion/pieces.py: the results are
// the same to the last bit. A table of cases (test/data/pieces.json) holds both to one another.
#pragma once

#include <cmath>

#include "clock/scaled_clock.h"

namespace move_base_abstract::motion {

/**
 * @brief A piece of a motion, until the next one begins: straight with constant acceleration or
 * exponential braking, or a turn, or rest, or an arc at a constant speed.
 */
struct Piece {
  Nanoseconds begin;  // simulated
  double x, y, yaw;   // m, m, rad: the pose at its begin, in the global frame
  double ux, uy;      // the direction of a forward speed, of length 1
  double v, a, w;     // m/s: forward speed at its begin; m/s^2; rad/s: turn rate at its begin
  double k;  // 1/s: speed and turn rate shrink by this rate; 0: they do not; below 0: an arc
};

struct Pose {
  double x, y, yaw;  // m, m, rad in (-pi, pi]
};

struct Velocity {
  double forward, lateral, turning;  // m/s, m/s, rad/s
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
  if (piece.k < 0.0) {  // the end of the arc's chord, which halves the angle of its turn
    const double half = 0.5 * piece.w * e;
    const double sine = std::sin(half);
    const double cosine = std::cos(half);
    const double chord = half == 0.0 ? piece.v * e : piece.v * e * (sine / half);
    return {piece.x + chord * (piece.ux * cosine - piece.uy * sine),
            piece.y + chord * (piece.uy * cosine + piece.ux * sine),
            normalized(piece.yaw + piece.w * e)};
  }
  const double g = piece.k == 0.0 ? e : (1.0 - std::exp(-piece.k * e)) / piece.k;
  const double s = piece.v * g + 0.5 * piece.a * e * e;
  return {piece.x + s * piece.ux, piece.y + s * piece.uy, normalized(piece.yaw + piece.w * g)};
}

/** @return the velocity at @p now [ns, simulated], which is not before the piece begins. */
inline Velocity velocityOf(const Piece& piece, Nanoseconds now) {
  if (piece.k < 0.0) {
    const auto& [begin, x, y, yaw, ux, uy, v, a, w, k] = piece;
    const double cosine = std::cos(yaw);
    const double sine = std::sin(yaw);
    return ux == cosine && uy == sine  // straight ahead, so that it has the very speed
               ? Velocity{v, 0.0, w}
               : Velocity{v * (ux * cosine + uy * sine), v * (uy * cosine - ux * sine), w};
  }
  const double e = static_cast<double>(now - piece.begin) / 1e9;
  const double h = piece.k == 0.0 ? 1.0 : std::exp(-piece.k * e);
  return {piece.v * h + piece.a * e, 0.0, piece.w * h};
}

}  // namespace move_base_abstract::motion
