#include "sw/cli/verdict_colours.h"

#include <unistd.h>

#include <array>
#include <sstream>
#include <utility>

#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

using process::Colour;
using ColouredWord = std::pair<const char*, Colour>;

// At the end of a line; a word comes before a word that is its end.
constexpr std::array<ColouredWord, 4> kVerdicts = {{{"  not confirmed", Colour::kRed},
                                                    {"  in part", Colour::kYellow},
                                                    {"  open", Colour::kYellow},
                                                    {"  confirmed", Colour::kGreen}}};
constexpr std::array<ColouredWord, 4> kOutcomes = {{{"is faster", Colour::kGreen},
                                                    {"equally fast", Colour::kGreen},
                                                    {"are the same", Colour::kGreen},
                                                    {"differ.", Colour::kYellow}}};

std::string coloured(const ColouredWord& word) {
  return process::coloured(STDOUT_FILENO, word.second, word.first);
}

std::string with_coloured_end(const std::string& line) {
  for (const ColouredWord& verdict : kVerdicts) {
    const std::string word = verdict.first;
    if (line.size() < word.size() || line.compare(line.size() - word.size(), word.size(), word) != 0)
      continue;
    return line.substr(0, line.size() - word.size()) + coloured(verdict);
  }
  return line;
}

}  // namespace

std::string with_coloured_verdicts(const std::string& summary) {
  std::string text;
  std::istringstream lines(summary);
  for (std::string line; std::getline(lines, line);) text += with_coloured_end(line) + '\n';
  return text;
}

std::string with_coloured_sentence(const std::string& text) {
  const std::size_t sentence = text.rfind("\n\n");
  std::string coloured_text = text;
  for (const ColouredWord& outcome : kOutcomes) {
    const std::string word = outcome.first;
    const std::size_t at = coloured_text.find(word, sentence == std::string::npos ? 0 : sentence);
    if (at != std::string::npos) coloured_text.replace(at, word.size(), coloured(outcome));
  }
  return coloured_text;
}

}  // namespace stereotlm::cli
