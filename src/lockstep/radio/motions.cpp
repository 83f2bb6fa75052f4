#include "motions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace move_base_abstract::radio {
namespace {

constexpr std::size_t kNumbers = 6;
constexpr std::size_t kPieceSize = 8 * (1 + kNumbers);  // bytes

std::uint64_t littleEndian(std::string_view bytes, std::size_t begin) {
  std::uint64_t value = 0;
  for (std::size_t index = 8; index-- > 0;) {
    value = value << 8U | static_cast<unsigned char>(bytes[begin + index]);
  }
  return value;
}

}  // namespace

Place Motion::at(Nanoseconds now) const {
  const auto next =
      std::upper_bound(pieces_.begin() + 1, pieces_.end(), now,
                       [](Nanoseconds instant, const Piece& one) { return instant < one.begin; });
  const Piece& piece = *(next - 1);
  const double elapsed = now > piece.begin ? static_cast<double>(now - piece.begin) * 1e-9 : 0.0;
  return {piece.x + (piece.vx + 0.5 * piece.ax * elapsed) * elapsed,
          piece.y + (piece.vy + 0.5 * piece.ay * elapsed) * elapsed};
}

Nanoseconds Motion::end() const {
  const Piece& last = pieces_.back();
  const bool stands = last.vx == 0.0 && last.vy == 0.0 && last.ax == 0.0 && last.ay == 0.0;
  return stands ? last.begin : kNever;
}

std::vector<Piece> piecesOf(std::string_view bytes) {
  if (bytes.empty() || bytes.size() % kPieceSize != 0) {
    throw std::invalid_argument("a motion must have pieces of " + std::to_string(kPieceSize) +
                                " bytes, got " + std::to_string(bytes.size()) + " bytes");
  }
  std::vector<Piece> pieces;
  for (std::size_t begin = 0; begin < bytes.size(); begin += kPieceSize) {
    std::array<double, kNumbers> numbers;
    for (std::size_t index = 0; index < kNumbers; ++index) {
      const std::uint64_t bits = littleEndian(bytes, begin + 8 * (index + 1));
      std::memcpy(&numbers[index], &bits, sizeof(bits));
    }
    const auto start = static_cast<Nanoseconds>(littleEndian(bytes, begin));
    const bool in_order = pieces.empty() ? start >= 0 : start > pieces.back().begin;
    if (!in_order || !std::all_of(numbers.begin(), numbers.end(),
                                  [](double number) { return std::isfinite(number); })) {
      throw std::invalid_argument(
          "a motion must have finite numbers, and instants that ascend, got others in piece " +
          std::to_string(pieces.size()));
    }
    pieces.push_back(
        {start, numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]});
  }
  return pieces;
}

}  // namespace move_base_abstract::radio
