#include "motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "clock/little_endian.h"

namespace move_base_abstract::motion {
namespace {

constexpr std::size_t kNumbers = 9;
constexpr std::size_t kPieceSize = 8 * (1 + kNumbers);  // bytes

}  // namespace

Motion::Motion(std::string_view bytes) {
  if (bytes.empty() || bytes.size() % kPieceSize != 0) {
    throw std::invalid_argument("a motion must have pieces of " + std::to_string(kPieceSize) +
                                " bytes, got " + std::to_string(bytes.size()) + " bytes");
  }
  for (std::size_t begin = 0; begin < bytes.size(); begin += kPieceSize) {
    const auto start = numberAt<Nanoseconds>(&bytes[begin]);
    double numbers[kNumbers];
    bool is_whole = pieces_.empty() ? start >= 0 : start > pieces_.back().begin;
    for (std::size_t index = 0; index < kNumbers; ++index) {
      numbers[index] = numberAt<double>(&bytes[begin + 8 * (index + 1)]);
      is_whole = is_whole && std::isfinite(numbers[index]);
    }
    if (!is_whole) {
      throw std::invalid_argument(
          "a motion must have finite numbers, and instants that ascend, got others in piece " +
          std::to_string(pieces_.size()));
    }
    const auto& [x, y, yaw, ux, uy, v, a, w, k] = numbers;
    pieces_.push_back({start, x, y, yaw, ux, uy, v, a, w, k});
  }
}

const Piece& Motion::pieceAt(Nanoseconds now) const {
  const auto next =
      std::upper_bound(pieces_.begin() + 1, pieces_.end(), now,
                       [](Nanoseconds instant, const Piece& one) { return instant < one.begin; });
  return *(next - 1);
}

Pose Motion::poseAt(Nanoseconds now) const {
  const Piece& piece = pieceAt(now);
  return poseOf(piece, std::max(now, piece.begin));
}

Velocity Motion::velocityAt(Nanoseconds now) const {
  const Piece& piece = pieceAt(now);
  return now < piece.begin ? Velocity{} : velocityOf(piece, now);
}

Nanoseconds Motion::end() const {
  const Piece& last = pieces_.back();
  return last.v == 0.0 && last.a == 0.0 && last.w == 0.0 ? last.begin : kNever;
}

}  // namespace move_base_abstract::motion
