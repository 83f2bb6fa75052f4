// Reads a list of texts from a command line. No ROS, no state.
#pragma once

#include <cstddef>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace move_base_abstract {

/** @return the texts of a list such as "[a, 'b', "c"]"; nothing if @p text is not such a list. */
inline std::optional<std::vector<std::string>> listOfTexts(const std::string& text) {
  const auto trimmed = [](const std::string& part) {
    const std::size_t begin = part.find_first_not_of(" \t\n");
    return begin == std::string::npos
               ? std::string()
               : part.substr(begin, part.find_last_not_of(" \t\n") - begin + 1);
  };
  const std::string whole = trimmed(text);
  if (whole.size() < 2 || whole.front() != '[' || whole.back() != ']') {
    return std::nullopt;
  }
  std::vector<std::string> texts;
  std::istringstream parts(whole.substr(1, whole.size() - 2));
  for (std::string part; std::getline(parts, part, ',');) {
    std::string one = trimmed(part);
    if (one.size() >= 2 && one.front() == one.back() && (one[0] == '\'' || one[0] == '"')) {
      one = one.substr(1, one.size() - 2);
    }
    if (one.empty() || one.find_first_of("[]{}'\"") != std::string::npos) {
      return std::nullopt;
    }
    texts.push_back(one);
  }
  return texts;
}

}  // namespace move_base_abstract
