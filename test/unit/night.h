// How many times something is done by day, and by night (as test/night.py says for Python).
#pragma once

#include <cstdlib>

namespace move_base_abstract {

/** @brief Return ``night`` if the environment variable NIGHT is a number of 1 or more, else
 * ``day``. */
inline int times(int day, int night) {
  const char* asked = std::getenv("NIGHT");
  return asked != nullptr && std::atof(asked) >= 1.0 ? night : day;
}

}  // namespace move_base_abstract
