// Numbers, times and names as texts, for the errors and messages of the event-driven clock.
#pragma once

#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "scaled_clock.h"

namespace move_base_abstract {

inline std::string numberText(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

/** @return @p time [ns] in seconds, exactly and without needless zeros: "12.5 s". */
inline std::string secondsText(Nanoseconds time) {
  const bool negative = time < 0;
  const auto size =
      negative ? 0 - static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(time);
  std::string text = (negative ? "-" : "") + std::to_string(size / kNanosecondsPerSecond);
  std::string digits = std::to_string(size % kNanosecondsPerSecond);
  digits.insert(0, 9 - digits.size(), '0');
  digits.erase(digits.find_last_not_of('0') + 1);
  return text + (digits.empty() ? "" : "." + digits) + " s";
}

/** @return the count with its noun @p what: "1 message", "3 messages". */
inline std::string countText(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/** @return @p name within quotation marks. */
inline std::string quote(std::string_view name) { return "'" + std::string(name) + "'"; }

/** @return @p parts with commas between. */
inline std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) {
    text += (text.empty() ? "" : ", ") + part;
  }
  return text;
}

}  // namespace move_base_abstract
