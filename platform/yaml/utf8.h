#pragma once

#include <cstddef>
#include <string_view>

namespace stereotlm::platform {

// A character of a text, and its length in bytes. If the text is not UTF-8 there, `bytes` is 0.
struct Utf8Character {
  char32_t code = 0;
  std::size_t bytes = 0;
};

// The character at the beginning of the text, which is not empty.
Utf8Character first_character(std::string_view text);

bool is_utf8(std::string_view text);

// Whether this byte is one of a character that an earlier byte begins.
constexpr bool continues_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

}  // namespace stereotlm::platform
