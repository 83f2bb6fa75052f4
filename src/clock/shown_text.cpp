#include "shown_text.h"

#include <cstdint>
#include <cstdio>

namespace move_base_abstract {
namespace {

struct Character {
  std::uint32_t code;
  std::size_t size;  // bytes
};

unsigned byteAt(std::string_view text, std::size_t at) {
  return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U;
}

/**
 * @return the character at @p at. A byte that is not valid UTF-8 counts as a character by itself.
 */
Character characterAt(std::string_view text, std::size_t at) {
  const unsigned lead = byteAt(text, at);
  const std::size_t size = lead < 0xC2   ? 1
                           : lead < 0xE0 ? 2
                           : lead < 0xF0 ? 3
                           : lead < 0xF5 ? 4
                                         : 1;
  std::uint32_t code = size == 1 ? lead : lead & (0x7FU >> size);
  for (std::size_t k = 1; k < size; ++k) {
    const unsigned next = byteAt(text, at + k);
    if ((next & 0xC0U) != 0x80U) {
      return {lead, 1};
    }
    code = (code << 6U) | (next & 0x3FU);
  }
  return {code, size};
}

bool isControl(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0)  // C0, DEL, C1
         || (code >= 0x2028 && code <= 0x202E)         // line separators, directions of writing
         || (code >= 0x2066 && code <= 0x2069);        // directions of writing
}

}  // namespace

bool hasControlCharacters(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const Character character = characterAt(text, at);
    if (isControl(character.code)) {
      return true;
    }
    at += character.size;
  }
  return false;
}

std::string shown(std::string_view text, std::size_t most) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const Character character = characterAt(text, at);
    if (at + character.size > most) {
      return result + "... (" + std::to_string(text.size()) + " bytes)";
    }
    if (isControl(character.code)) {
      char code[8];
      std::snprintf(code, sizeof(code), character.code < 0x100 ? "\\x%02x" : "\\u%04x",
                    static_cast<unsigned>(character.code));
      result += code;
    } else {
      result += text.substr(at, character.size);
    }
    at += character.size;
  }
  return result;
}

}  // namespace move_base_abstract
