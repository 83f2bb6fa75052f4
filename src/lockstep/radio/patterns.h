// Names of nodes and hosts with stars.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_PATTERNS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_PATTERNS_H

#include <optional>
#include <string>
#include <string_view>

namespace move_base_abstract::radio {

/**
 * @return nothing if @p name is not as @p pattern says; else what its first `*` stands for, ''
 * without one. `*` is any text without a '/', also none; `**` is any text.
 */
std::optional<std::string> matched(std::string_view pattern, std::string_view name);

/** @return @p pattern with @p text in place of its `*`. */
std::string filled(std::string_view pattern, std::string_view text);

}  // namespace move_base_abstract::radio

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_RADIO_PATTERNS_H
