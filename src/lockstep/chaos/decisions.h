// The decisions by which a seed departs from the stated order, each with a name. No ROS.
#pragma once

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

/** @brief A decision that was applied. */
struct Decision {
  std::string name;  // 12 hexadecimal digits
  Nanoseconds time;  // simulated
  std::string what;  // "order", "turns", "delay", "start" or "link"
  std::string says;  // in words
};

/**
 * @return the names in @p text, which are separated by commas, as numbers. '' gives nothing: all
 * decisions count. "none" gives an empty set.
 * @throws std::invalid_argument if one is not 12 hexadecimal digits.
 */
std::optional<std::set<std::uint64_t>> decisionsOf(const std::string& text);

/**
 * @return the name of a decision. It is the same in every run in which the link comes to this
 * decision.
 */
std::string nameOf(std::uint64_t number);

/**
 * @brief Draws each choice, and keeps the decisions.
 *
 * A choice is identified by the link that it is about, as a number, and by the count of earlier
 * choices about this link. So its draw does not depend on whether other decisions are applied.
 */
class Decisions {
 public:
  using Said = std::function<std::string()>;

  /**
   * @param only if given, only these decisions are applied.
   * @param are_kept whether decisions are kept for take().
   */
  Decisions(std::uint64_t seed, std::optional<std::set<std::uint64_t>> only, bool are_kept)
      : seed_(seed), only_(std::move(only)), are_kept_(are_kept) {}

  /**
   * @return a number from 1 to @p most if this choice about @p link departs from the stated order,
   * otherwise 0. One of @p share choices does; 0: of 2, 4, 8 or 16, as the seed says.
   */
  std::uint64_t draw(std::uint64_t link, std::uint64_t most, std::uint64_t share = 0);
  /** @brief Keep the decision of the latest draw(), which was applied. */
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
