// The walls of a map, and how many of them lie between two places.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_WALLS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_WALLS_H

#include <cstdint>
#include <vector>

namespace move_base_abstract::radio {

struct Place {
  double x;  // m, in the global frame
  double y;
};

/** @brief Cells of a map, of which some are wall. */
class Walls {
 public:
  Walls() = default;
  /** @param corner [m] of cell (0, 0). @param cell [m] the length of its sides. */
  Walls(Place corner, double cell, std::int32_t width, std::int32_t height);

  /** @brief Cells @p begin to before @p end of @p row are wall. @throws std::invalid_argument */
  void add(std::int32_t row, std::int32_t begin, std::int32_t end);

  /**
   * @return how many walls lie on the straight line: runs of wall cells that it goes through, cell
   * by cell (J. Amanatides, A. Woo, Eurographics 1987). Outside of the map there are none.
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

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_WALLS_H
