// Numbers as bytes, the lowest one first, as in frames, in ROS messages and in payloads with slots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace move_base_abstract {

/** @return the integer, or the double, of the bytes that begin at @p bytes. */
template <typename Number>
Number numberAt(const char* bytes) {
  std::uint64_t bits = 0;
  for (std::size_t k = sizeof(Number); k-- > 0;) {
    bits = bits << 8U | static_cast<unsigned char>(bytes[k]);
  }
  if constexpr (std::is_same_v<Number, double>) {
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  } else {
    return static_cast<Number>(bits);
  }
}

/** @brief Write the bytes of @p value, an integer or a double, from @p bytes on. */
template <typename Number>
void putNumber(char* bytes, Number value) {
  std::uint64_t bits = 0;
  if constexpr (std::is_same_v<Number, double>) {
    std::memcpy(&bits, &value, sizeof(bits));
  } else {
    bits = static_cast<std::uint64_t>(value);
  }
  for (std::size_t k = 0; k < sizeof(Number); ++k) {
    bytes[k] = static_cast<char>(bits >> (8 * k) & 0xFFU);
  }
}

}  // namespace move_base_abstract
