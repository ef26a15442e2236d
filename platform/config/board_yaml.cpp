#include "platform/config/board_yaml.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "platform/config/board_draft.h"
#include "platform/config/board_keys.h"

namespace stereotlm::platform {
namespace {

std::string lines_of(const std::vector<Diagnostic>& diagnostics, const std::string& note) {
  std::vector<std::string> lines;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (lines.size() == BoardError::kMostLines) {
      const std::size_t more = diagnostics.size() - lines.size();
      lines.push_back(fmt::format("and {} error{} more", more, more == 1 ? "" : "s"));
      break;
    }
    lines.push_back(diagnostic.place + ": " + diagnostic.text);
  }
  if (!note.empty()) lines.push_back(note);
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace

BoardError::BoardError(std::vector<Diagnostic> diagnostics, const std::string& note)
    : std::runtime_error(lines_of(diagnostics, note)), diagnostics_(std::move(diagnostics)) {}

std::string read_text_file(const std::string& path, const std::string& kind) {
  const auto refuse = [&path](const std::string& rule) { throw BoardError({{path, rule}}); };
  constexpr std::size_t kLargestBytes = std::size_t{1} << 20;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) refuse("a folder, not a " + kind);
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
  std::string text(kLargestBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) refuse("cannot be read: input error");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargestBytes) refuse(fmt::format("larger than {} bytes: not a {}", kLargestBytes, kind));
  return text;
}

BoardConfig load_board(const std::string& board, const std::vector<std::string>& sets) {
  BoardDraft draft(board);
  for (const std::string& set : sets) draft.set(set);
  return draft.read();
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  return names;
}

std::string_view preset_text(std::string_view name) {
  for (const Preset& preset : presets()) {
    if (preset.name == name) return preset.text;
  }
  throw std::out_of_range(fmt::format("{}: not a preset", name));
}

std::vector<KeyInfo> keys() {
  std::vector<KeyInfo> all = {
      {"extends", "the preset that supplies the keys that the file leaves out; optional, the first key", "",
       listed(preset_names())}};
  for (const Key& key : board_keys()) all.push_back({key.path, key.meaning, key.unit, key.rule_text});
  return all;
}

}  // namespace stereotlm::platform
