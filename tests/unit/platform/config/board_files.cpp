#include "tests/unit/platform/config/board_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

#include "platform/config/board_yaml.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::platform::testing {
namespace {

std::string without(std::string text, const std::string& part) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at)) {
    text.erase(at, part.size());
  }
  return text;
}

}  // namespace

BoardConfig load_text(const std::string& text, const std::vector<std::string>& sets) {
  const test::ScratchFolder folder;
  return load_board(test::write_file(folder.path() / "board.yaml", text), sets);
}

std::string refusal_of(const std::string& text, const std::vector<std::string>& sets) {
  const test::ScratchFolder folder;
  return without(refusal_of_board(test::write_file(folder.path() / "board.yaml", text), sets),
                 folder.path().string() + '/');
}

std::string refusal_of_board(const std::string& board, const std::vector<std::string>& sets) {
  try {
    load_board(board, sets);
  } catch (const BoardError& error) {
    return error.what();
  }
  return "";
}

void expect_refusals(const std::vector<Refusal>& refusals) {
  for (const auto& [text, message, sets] : refusals)
    EXPECT_EQ(refusal_of(text, sets), message) << text << fmt::format("{}", fmt::join(sets, " "));
}

std::string block_board() {
  BoardConfig board;
  for (BankConfig& bank : board.banks) bank.words = 1 << 26;
  board.pci.load = PciLoadConfig();
  return to_yaml(board);
}

ChangedBoard board_with(const std::string& path, const std::string& value) {
  const std::size_t dot = path.rfind('.');
  std::size_t section_end = std::string::npos;  // of the line that begins the section of the key
  int section_line = 0;
  std::istringstream lines(block_board());
  std::vector<std::string> open;  // the keys above the line
  ChangedBoard changed;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::size_t indent = line.find_first_not_of(' ');
    const std::size_t colon = line.find(':');
    open.resize(indent / 2);
    open.push_back(line.substr(indent, colon - indent));
    const std::string here = fmt::format("{}", fmt::join(open, "."));
    if (here.rfind(path + '.', 0) == 0) continue;  // of the map that was there
    if (here == path) {
      changed.place = fmt::format("board.yaml:{}:{}", number, colon + 3);
      line.replace(colon + 1, std::string::npos, ' ' + value);
    }
    changed.text += line + '\n';
    if (here == path.substr(0, dot)) {
      section_end = changed.text.size();
      section_line = number;
    }
  }
  if (changed.place.empty() && section_end != std::string::npos) {  // optional keys are not written
    const std::string name = path.substr(dot + 1);
    changed.text.insert(section_end, fmt::format("  {}: {}\n", name, value));
    changed.place = fmt::format("board.yaml:{}:{}", section_line + 1, name.size() + 5);
  }
  if (changed.place.empty()) throw std::out_of_range(path);
  return changed;
}

}  // namespace stereotlm::platform::testing
