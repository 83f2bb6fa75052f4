// The machine's clocks: the monotonic one, and the one that people set.
#pragma once

#include <chrono>

#include "clock/scaled_clock.h"

namespace move_base_abstract {

inline Nanoseconds wallNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

inline Nanoseconds machineNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace move_base_abstract
