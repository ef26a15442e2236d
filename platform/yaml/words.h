#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stereotlm::platform {

// Joins words: "a, b or c".
std::string listed(const std::vector<std::string>& words);

// The edit distance of a word from a known word: the least number of characters to change, add, remove or
// swap with a neighbour. Nullopt if the known word was probably not meant. It was probably meant if at most a
// third of the characters is edited, or if `word` is the known word without its last part, such as a unit.
std::optional<std::size_t> likely_distance(std::string_view word, std::string_view known);

// "; nearest: WORD" with the word of least edit distance, the first of equals; empty if no word is near.
std::string nearest_text(std::string_view word, const std::vector<std::string>& words);

}  // namespace stereotlm::platform
