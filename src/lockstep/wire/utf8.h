// Checks whether a text is UTF-8.
#pragma once

#include <string_view>

namespace move_base_abstract {

/** @return whether @p text is well-formed UTF-8 (RFC 3629: nothing overlong, no surrogates). */
bool isUtf8(std::string_view text);

}  // namespace move_base_abstract
