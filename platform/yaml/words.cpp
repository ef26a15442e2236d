#include "platform/yaml/words.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace stereotlm::platform {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> above_last(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    above_last.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({row[j - 1] + 1, above[j] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      const bool is_exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_exchanged) row[j] = std::min(row[j], above_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::optional<std::size_t> likely_distance(std::string_view word, std::string_view known) {
  const bool is_begin = !word.empty() && word.size() < known.size() && known[word.size()] == '_' &&
                        known.substr(0, word.size()) == word;
  if (is_begin) return 1;
  const auto [shorter, longer] = std::minmax({word.size(), known.size()});
  const std::size_t most = (longer + 2) / 3;
  if (longer - shorter > most) return std::nullopt;
  const std::size_t distance = edit_distance(word, known);
  return distance <= most && distance < longer ? std::optional(distance) : std::nullopt;
}

std::string nearest_text(std::string_view word, const std::vector<std::string>& words) {
  const std::string* nearest = nullptr;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& known : words) {
    const auto distance = likely_distance(word, known);
    if (!distance || *distance >= least) continue;
    nearest = &known;
    least = *distance;
  }
  return nearest == nullptr ? "" : "; nearest: " + *nearest;
}

std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
    out += words[i];
  }
  return out;
}

}  // namespace stereotlm::platform
