// Random numbers that follow from a key alone: they are the same on every computer, in whichever
// order they are drawn.
#pragma once

#include <cstdint>
#include <string_view>

namespace move_base_abstract::radio {

/** @brief What a number is drawn for. Each purpose has numbers of its own. */
enum class Purpose : std::uint64_t { kLoss = 1, kDelay = 2 };

/** @return @p bits, mixed by the output function of SplitMix64 (Steele, Lea, Flood 2014). */
inline std::uint64_t stirred(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
  return bits ^ (bits >> 31U);
}

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;  // SplitMix64's step

/**
 * @return the key of a link from one host to another. It depends on their names, not on their
 * numbers.
 */
inline std::uint64_t linkKey(std::uint64_t seed, std::string_view from, std::string_view to) {
  std::uint64_t key = stirred(seed + kGolden);
  for (const std::string_view name : {from, to}) {
    for (const char letter : name) {
      key = stirred(key + kGolden + static_cast<unsigned char>(letter));
    }
    key = stirred(key + kGolden + 256U);  // "ab" to "c" is another link than "a" to "bc"
  }
  return key;
}

/**
 * @return 64 uniform bits for the attempt number @p attempt at message number @p number of a link.
 */
inline std::uint64_t draw(std::uint64_t link, std::uint64_t number, std::uint32_t attempt,
                          Purpose purpose) {
  const std::uint64_t of_message = stirred(link + kGolden * (number + 1U));
  return stirred(of_message +
                 kGolden * (4U * std::uint64_t{attempt} + static_cast<std::uint64_t>(purpose)));
}

/**
 * @return whether an event of @p probability [0, 1] happens, by 53 of @p bits: 0 never, 1 always.
 */
inline bool happens(std::uint64_t bits, double probability) {
  return static_cast<double>(bits >> 11U) * 0x1p-53 < probability;
}

/** @return a whole number from @p low to @p high, both included (Lemire's product, 128 bits). */
inline std::int64_t between(std::uint64_t bits, std::int64_t low, std::int64_t high) {
  __extension__ using Wide = unsigned __int128;
  const Wide count = static_cast<Wide>(high - low) + 1U;
  return low + static_cast<std::int64_t>((count * bits) >> 64U);
}

}  // namespace move_base_abstract::radio
