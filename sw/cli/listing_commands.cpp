#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "sw/cli/add_command.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/text.h"
#include "sw/cli/typed_option.h"
#include "sw/process/problems.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

// The purpose of a preset: its file begins with a comment line that states it.
std::string description(std::string_view file) {
  const std::string line(file.substr(0, file.find('\n')));
  return line.substr(std::min(line.size(), line.find_first_not_of("# ")));
}

int list_boards() {
  const auto names = platform::preset_names();
  std::size_t width = 0;
  for (const std::string& name : names) width = std::max(width, name.size());
  std::string text;
  for (const std::string& name : names)
    text += paragraph(name, width + 2, description(platform::preset_text(name)));
  process::print(text);
  return kDone;
}

int show_board(const std::string& name) {
  const auto names = platform::preset_names();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    process::refuse(fmt::format("--show = {}: not a preset{}; presets: {}", name,
                                platform::nearest_text(name, names), platform::listed(names)));
  }
  process::print(platform::preset_text(name));
  return kDone;
}

int list_keys() {
  const auto keys = platform::keys();
  std::size_t path_width = 0;
  std::size_t unit_width = 0;
  for (const auto& key : keys) {
    path_width = std::max(path_width, key.path.size());
    unit_width = std::max(unit_width, key.unit.size());
  }
  const std::size_t indent = path_width + unit_width + 4;
  const auto head = [&](const std::string& path, const std::string& unit) {
    return fmt::format("{:<{}}  {:<{}}", path, path_width, unit, unit_width);
  };
  std::string text = paragraph(head("key", "unit"), indent, "meaning; below it the range or allowed values");
  for (const auto& key : keys) {
    text += paragraph(head(key.path, key.unit), indent, key.meaning) + paragraph("", indent, key.range);
  }
  process::print(text);
  return kDone;
}

}  // namespace

void add_boards(CLI::App& program, Action& action) {
  const auto show = std::make_shared<Typed>();
  const auto parsed = [show, &action] {
    action = [is_one = show->is_given(), show] { return is_one ? show_board(show->text) : list_boards(); };
  };
  show->add_to(add_command(program, "boards", "List the preset boards, or show one", parsed), "--show",
               "NAME", "Print the file of this preset");
}

void add_keys(CLI::App& program, Action& action) {
  add_command(program, "keys", "List every key of a board file with its meaning, unit and range",
              [&action] { action = list_keys; });
}

}  // namespace stereotlm::cli
