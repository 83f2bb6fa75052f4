// Patterns for the names of nodes and hosts, with `*` and `**`.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_PATTERNS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_PATTERNS_H

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

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_PATTERNS_H
