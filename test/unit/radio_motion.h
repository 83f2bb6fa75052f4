// A piece of a robot's motion, as robots tell it to the time master for the radio.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @return the bytes of a piece that begins then [ns]; what @p numbers are is the wire's matter. */
inline std::string piece(Nanoseconds begin, const std::vector<double>& numbers) {
  std::string bytes(8 + 8 * numbers.size(), '\0');
  std::memcpy(bytes.data(), &begin, 8);  // the tests run on little endian computers
  std::memcpy(bytes.data() + 8, numbers.data(), 8 * numbers.size());
  return bytes;
}

/** @return that of a robot at (x [m], 0) which drives along x at @p speed [m/s]. */
inline std::string piece(Nanoseconds begin, double x, double speed) {
  return piece(begin, {x, 0.0, 0.0, 1.0, 0.0, speed, 0.0, 0.0, 0.0});
}

}  // namespace move_base_abstract
