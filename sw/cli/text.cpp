#include "sw/cli/text.h"

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

}  // namespace stereotlm::cli
