#include "walls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace move_base_abstract::radio {
namespace {

constexpr double kNoBorder = std::numeric_limits<double>::infinity();

/**
 * @brief Clip the way from @p from to @p to, in cells along one axis, to 0 to @p size. @p begin and
 * @p end are the ends of the kept part, as shares of the way.
 */
void clip(double from, double to, double size, double& begin, double& end) {
  const double first = from < to ? 0.0 : size;
  if (from == to) {
    end = from < 0.0 || from > size ? -1.0 : end;
  } else {
    begin = std::max(begin, (first - from) / (to - from));
    end = std::min(end, (size - first - from) / (to - from));
  }
}

/** @brief A walk along one axis: the cell, its next border as a share of the way, and its step. */
struct Axis {
  Axis(double begin, double end)
      : cell(std::floor(begin)),
        left(std::fabs(std::floor(end) - cell)),
        step(end > begin ? 1.0 : -1.0),
        share(end == begin ? kNoBorder : 1.0 / std::fabs(end - begin)),
        border(end == begin ? kNoBorder
                            : share * (step > 0.0 ? cell + 1.0 - begin : begin - cell)) {}
  void go() {
    cell += step;
    left -= 1.0;
    border = left > 0.0 ? border + share : kNoBorder;
  }
  double cell, left, step, share, border;
};

}  // namespace

Walls::Walls(Place corner, double cell, std::int32_t width, std::int32_t height)
    : corner_(corner),
      cell_(cell),
      width_(width),
      height_(height),
      cells_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void Walls::add(std::int32_t row, std::int32_t begin, std::int32_t end) {
  if (row < 0 || row >= height_ || begin < 0 || end <= begin || end > width_) {
    throw std::invalid_argument("a row of walls must lie within the map, got cells " +
                                std::to_string(begin) + " to " + std::to_string(end) + " of row " +
                                std::to_string(row));
  }
  for (std::int32_t column = begin; column < end; ++column) {
    cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column)] = true;
  }
}

bool Walls::isWall(double column, double row) const {
  return column >= 0.0 && row >= 0.0 && column < width_ && row < height_ &&
         cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(column)];
}

int Walls::between(Place from, Place to) const {
  if (cells_.empty()) {
    return 0;
  }
  const Place a{(from.x - corner_.x) / cell_, (from.y - corner_.y) / cell_};
  const Place b{(to.x - corner_.x) / cell_, (to.y - corner_.y) / cell_};
  double begin = 0.0, end = 1.0;  // the walk is never longer than the map
  clip(a.x, b.x, width_, begin, end);
  clip(a.y, b.y, height_, begin, end);
  if (!(begin <= end)) {
    return 0;
  }
  Axis x(a.x + begin * (b.x - a.x), end < 1.0 ? a.x + end * (b.x - a.x) : b.x);
  Axis y(a.y + begin * (b.y - a.y), end < 1.0 ? a.y + end * (b.y - a.y) : b.y);
  bool is_in = isWall(x.cell, y.cell);
  int count = is_in ? 1 : 0;
  while (x.left > 0.0 || y.left > 0.0) {
    // At a corner of four cells, go along x first: either way is next to the line.
    const bool along_x = y.left <= 0.0 || (x.left > 0.0 && x.border <= y.border);
    (along_x ? x : y).go();
    const bool was_in = is_in;
    is_in = isWall(x.cell, y.cell);
    count += is_in && !was_in ? 1 : 0;
  }
  return count;
}

}  // namespace move_base_abstract::radio
