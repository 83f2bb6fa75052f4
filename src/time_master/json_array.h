// Checks whether a text can be a value in the event log. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_JSON_ARRAY_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_JSON_ARRAY_H

#include <string_view>

namespace move_base_abstract {

/** @return whether @p text is one JSON array (RFC 8259), nested at most 100 deep, and nothing else.
 */
bool isJsonArray(std::string_view text);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_JSON_ARRAY_H
