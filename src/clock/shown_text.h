// Texts that others have written, made fit for a terminal and a log.
#ifndef MOVE_BASE_ABSTRACT_CLOCK_SHOWN_TEXT_H
#define MOVE_BASE_ABSTRACT_CLOCK_SHOWN_TEXT_H

#include <cstddef>
#include <string>
#include <string_view>

namespace move_base_abstract {

/** @brief How many bytes of a text of somebody else's are shown. */
constexpr std::size_t kMostShown = 2000;
/** @brief Bytes of a name: of a participant, of a holder. ROS itself has no limit. */
constexpr std::size_t kLongestName = 255;

/** @return whether @p text has characters that command a terminal, or move what stands after. */
bool hasControlCharacters(std::string_view text);

/**
 * @return @p text [UTF-8] with those characters as their codes ("\x1b", "\u202e"), and without its
 * end where it is longer than @p most bytes; then it says how long it was.
 */
std::string shown(std::string_view text, std::size_t most = kMostShown);

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_CLOCK_SHOWN_TEXT_H
