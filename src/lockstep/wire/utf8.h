// Checks whether a text is UTF-8.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_UTF8_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_UTF8_H

#include <string_view>

namespace move_base_abstract {

/** @return whether @p text is well-formed UTF-8 (RFC 3629: nothing overlong, no surrogates). */
bool isUtf8(std::string_view text);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_UTF8_H
