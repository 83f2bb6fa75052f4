// Which rule of lockstep is broken: the sources with mutants ask it.
#pragma once

#include <string_view>

namespace move_base_abstract {

inline std::string_view broken_rule;  // '': none, the sources are the product's

inline bool isBroken(std::string_view rule) { return broken_rule == rule; }

/** @brief Breaks one rule as long as it lives. */
struct Broken {
  explicit Broken(std::string_view rule) { broken_rule = rule; }
  ~Broken() { broken_rule = {}; }
  Broken(const Broken&) = delete;
  Broken& operator=(const Broken&) = delete;
};

}  // namespace move_base_abstract
