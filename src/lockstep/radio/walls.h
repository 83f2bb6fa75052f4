// The walls of a map, and the number of walls between two places.
#pragma once

#include <cstdint>
#include <vector>

namespace move_base_abstract::radio {

struct Place {
  double x;  // m, in the global frame
  double y;
};

/** @brief The cells of a map, some of which are wall. */
class Walls {
 public:
  Walls() = default;
  /**
   * @param corner [m] the lowest corner of cell (0, 0), in the global frame.
   * @param cell [m] the length of a cell's sides.
   * @param width, height of the map, in cells.
   */
  Walls(Place corner, double cell, std::int32_t width, std::int32_t height);

  /**
   * @brief Make the cells of @p row from @p begin to before @p end wall. @throws
   * std::invalid_argument if they are not within the map.
   */
  void add(std::int32_t row, std::int32_t begin, std::int32_t end);

  /**
   * @return the number of walls on the straight line: runs of wall cells that it goes through, cell
   * by cell (J. Amanatides, A. Woo, Eurographics 1987). Outside of the map there are no walls.
   */
  int between(Place from, Place to) const;

 private:
  bool isWall(double column, double row) const;

  Place corner_{0.0, 0.0};
  double cell_ = 1.0;
  std::int32_t width_ = 0;
  std::int32_t height_ = 0;
  std::vector<bool> cells_;
};

}  // namespace move_base_abstract::radio
