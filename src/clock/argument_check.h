// Arguments that are refused, with what was got and what is allowed.
#ifndef MOVE_BASE_ABSTRACT_CLOCK_ARGUMENT_CHECK_H
#define MOVE_BASE_ABSTRACT_CLOCK_ARGUMENT_CHECK_H

#include <stdexcept>
#include <string>

#include "number_text.h"

namespace move_base_abstract {

[[noreturn]] inline void refuse(const std::string& text) { throw std::invalid_argument(text); }

/**
 * @brief Refuse a value outside [low, high]. The condition is written so that it refuses NaN too.
 */
inline double checked(const char* name, double value, double low, double high, const char* unit) {
  if (!(value >= low && value <= high)) {
    refuse(std::string(name) + " must be from " + numberText(low) + " to " + numberText(high) +
           unit + ", got " + numberText(value));
  }
  return value;
}

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_CLOCK_ARGUMENT_CHECK_H
