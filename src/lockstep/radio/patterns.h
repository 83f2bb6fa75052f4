// Patterns for the names of nodes and hosts, with `*` and `**`.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace move_base_abstract::radio {

/**
 * @return nothing if @p name does not match @p pattern. Otherwise the text that its first `*`
 * stands for; '' if it has none. `*` matches any text without a '/', also an empty one; `**`
 * matches any text.
 */
std::optional<std::string> matched(std::string_view pattern, std::string_view name);

/** @return @p pattern with @p text in place of its first `*`. */
std::string filled(std::string_view pattern, std::string_view text);

}  // namespace move_base_abstract::radio
