#include "sw/cli/text.h"

#include <unistd.h>

#include <algorithm>
#include <sstream>

namespace stereotlm::cli {

std::string paragraph(const std::string& head, std::size_t indent, const std::string& text) {
  std::string lines;
  std::string line = head;
  line.resize(std::max(indent, head.size()), ' ');
  bool has_word = false;
  std::istringstream words(text);
  for (std::string word; words >> word; has_word = true) {
    if (has_word && line.size() + 1 + word.size() > kTextColumns) {
      lines += line + '\n';
      line.assign(indent, ' ');
      has_word = false;
    }
    line += (has_word ? " " : "") + word;
  }
  return lines + line + '\n';
}

std::string with_coloured_words(std::string text, std::size_t from,
                                const std::vector<std::pair<std::string, process::Colour>>& words) {
  for (const auto& [word, colour] : words) {
    const std::size_t size = word.find('\n');  // a line ends without colour
    std::string coloured = process::coloured(STDOUT_FILENO, colour, word.substr(0, size));
    if (size != std::string::npos) coloured += word.substr(size);
    for (std::size_t at = from; (at = text.find(word, at)) != std::string::npos; at += coloured.size())
      text.replace(at, word.size(), coloured);
  }
  return text;
}

}  // namespace stereotlm::cli
