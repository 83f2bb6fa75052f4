// Arguments that are refused, with what was got and what is allowed.
#pragma once

#include <stdexcept>
#include <string>

#include "number_text.h"

namespace move_base_abstract {

[[noreturn]] inline void refuse(const std::string& text) { throw std::invalid_argument(text); }

/**
 * @return @p factor. The condition is written so that it refuses NaN too.
 * @param or_else the text about other values that are allowed; may be ''.
 */
inline double checkedFactor(const char* name, double factor, const char* or_else = "") {
  if (!(factor >= 0.01 && factor <= 1e6)) {
    refuse(std::string(name) + " must be from 0.01 to 1000000 simulated seconds per wall second" +
           or_else + ", got " + numberText(factor));
  }
  return factor;
}

/** @return the target of a step of @p duration from @p from on. */
inline Nanoseconds checkedStep(Nanoseconds from, Nanoseconds duration) {
  if (duration <= 0 || duration > kLastInstant - from) {
    refuse("step: duration must be more than 0 and at most " + secondsText(kLastInstant - from) +
           " from " + secondsText(from) + " on, got " + secondsText(duration));
  }
  return from + duration;
}

/** @return @p target, at which a run that is at @p present is to pause. */
inline Nanoseconds checkedTarget(Nanoseconds present, Nanoseconds target) {
  if (target < present || target > kLastInstant) {
    refuse("run_until: target must be from the present, " + secondsText(present) + ", to " +
           secondsText(kLastInstant) + ", got " + secondsText(target));
  }
  return target;
}

}  // namespace move_base_abstract
