// What a seed decides otherwise than the stated order, each decision with a name. No ROS.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_CHAOS_DECISIONS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_CHAOS_DECISIONS_H

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"

namespace move_base_abstract::chaos {

/** @brief One that was applied. */
struct Decision {
  std::string name;  // 12 hexadecimal digits
  Nanoseconds time;  // simulated
  std::string what;  // "order", "turns" or "delay"
  std::string says;  // in words
};

/**
 * @return the names in @p text, separated by commas; nothing for '': all decisions count. "none" is
 * no name.
 * @throws std::invalid_argument if one is not 12 hexadecimal digits.
 */
std::optional<std::set<std::uint64_t>> decisionsOf(const std::string& text);

/** @return the name of a decision: the same in each run in which its link comes to it. */
std::string nameOf(std::uint64_t number);

/**
 * @brief Draws for each choice that there is, and keeps what was decided.
 *
 * A choice is known by what it is about (a link, as a number) and how many of that there have been:
 * whether others are applied does not change its draw.
 */
class Decisions {
 public:
  using Said = std::function<std::string()>;

  /** @param only if given, no others are applied. @param are_kept whether taken() is wanted. */
  Decisions(std::uint64_t seed, std::optional<std::set<std::uint64_t>> only, bool are_kept)
      : seed_(seed), only_(std::move(only)), are_kept_(are_kept) {}

  /**
   * @return a number from 1 to @p most if this choice about @p link is another than the stated one,
   * else 0. One of 2, 4, 8 or 16 is, as the seed says.
   */
  std::uint64_t draw(std::uint64_t link, std::uint64_t most);
  /** @brief Keep the latest draw(), which was applied. */
  void note(Nanoseconds time, const char* what, const Said& says);

  std::vector<Decision> take() { return std::exchange(taken_, {}); }

 private:
  const std::uint64_t seed_;
  const std::optional<std::set<std::uint64_t>> only_;
  const bool are_kept_;
  std::unordered_map<std::uint64_t, std::uint64_t> counts_;  // of choices, by link; never iterated
  std::uint64_t latest_ = 0;
  std::vector<Decision> taken_;
};

}  // namespace move_base_abstract::chaos

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_CHAOS_DECISIONS_H
