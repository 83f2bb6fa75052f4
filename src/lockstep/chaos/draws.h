// Random numbers that follow from a key, and are the same on every computer. No ROS, no state.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace move_base_abstract::chaos {

/** @return the next number of SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number
 * generators, OOPSLA 2014) from the state @p x. */
constexpr std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

/** @return one number made of several. Their order counts. */
constexpr std::uint64_t mixed(std::initializer_list<std::uint64_t> parts) {
  std::uint64_t all = 0;
  for (const std::uint64_t part : parts) {
    all = mixed(all ^ part);
  }
  return all;
}

/** @return the FNV-1a hash of @p text, 64 bits. */
constexpr std::uint64_t hashOf(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char byte : text) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001B3U;
  }
  return hash;
}

}  // namespace move_base_abstract::chaos
