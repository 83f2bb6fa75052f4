// Texts as JSON strings. This is written by hand for two reasons. Event logs must have the same
// bytes as those of earlier versions, and libraries write some control characters in other forms.
// And a busy run writes thousands of texts a second.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace move_base_abstract {

/** @brief Append @p text [UTF-8] as a JSON string, within quotation marks, to @p json. */
inline void appendJson(std::string& json, std::string_view text) {
  json += '"';
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') {
      json += '\\';
      json += letter;
    } else if (static_cast<unsigned char>(letter) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof(code), "\\u%04x", static_cast<unsigned>(letter));
      json += code;
    } else {
      json += letter;
    }
  }
  json += '"';
}

}  // namespace move_base_abstract
