// Makes texts from other programs fit for a terminal and a log.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace move_base_abstract {

/** @brief The most bytes that are shown of a text from another program. */
constexpr std::size_t kMostShown = 2000;
/**
 * @brief The most bytes that a participant's or a holder's name may have. ROS itself has no limit.
 */
constexpr std::size_t kLongestName = 255;

/**
 * @return whether @p text has characters that control a terminal, or that change how the text after
 * them is displayed.
 */
bool hasControlCharacters(std::string_view text);

/**
 * @return @p text [UTF-8] with control characters replaced by their codes ("\x1b", "\u202e"). A
 * text of more than @p most bytes is cut, and its full length is added.
 */
std::string shown(std::string_view text, std::size_t most = kMostShown);

}  // namespace move_base_abstract
