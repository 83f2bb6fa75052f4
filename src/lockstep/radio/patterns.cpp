#include "patterns.h"

namespace move_base_abstract::radio {

std::optional<std::string> matched(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) {
    return pattern == name ? std::make_optional<std::string>() : std::nullopt;
  }
  if (name.substr(0, star) != pattern.substr(0, star)) {
    return std::nullopt;
  }
  const bool is_any = pattern.substr(star, 2) == "**";
  const std::string_view behind = pattern.substr(star + (is_any ? 2 : 1));
  for (std::size_t end = star; end <= name.size(); ++end) {
    if (const auto rest = matched(behind, name.substr(end))) {
      return is_any ? *rest : std::string(name.substr(star, end - star));
    }
    if (!is_any && end < name.size() && name[end] == '/') {
      break;
    }
  }
  return std::nullopt;
}

std::string filled(std::string_view pattern, std::string_view text) {
  std::string name(pattern);
  const std::size_t star = name.find('*');
  return star == std::string::npos ? name : name.replace(star, 1, text);
}

}  // namespace move_base_abstract::radio
