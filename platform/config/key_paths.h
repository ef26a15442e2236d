#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stereotlm::platform {

// The path of `name` below `path`: "image.width" for "image" and "width". The top is "".
std::string below(const std::string& path, const std::string& name);

// Whether the path is one below `section`.
bool is_below(std::string_view path, std::string_view section);

// The names of the keys directly below a path ("" is the top), in order; empty below a single value.
const std::vector<std::string>& child_keys(std::string_view path);

// The keys of child_keys() that are not optional.
const std::vector<std::string>& required_keys(std::string_view path);

// The number of required keys at or below the path, where all banks count as one key. "" is the whole board.
std::size_t required_count(std::string_view path);

// The rule of a key. The rule of a map lists its keys: "a map of width, height".
std::string rule_text(std::string_view path);

// `path` with NAME in place of a bank's name: `ssram.banks.NAME.words` for `ssram.banks.bank0.words`.
std::string schema_path(const std::string& path);

// The message for an unknown path: "unknown key; nearest known key: PATH", or a text that says that no known
// key is near.
std::string unknown_key_text(const std::string& path);

}  // namespace stereotlm::platform
