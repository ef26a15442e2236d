#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "sw/cli/command.h"
#include "sw/cli/key_schema.h"
#include "sw/stats/document_schemas.h"
#include "sw/stats/figures.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

// The purpose of a preset: its file begins with a comment line that states it.
std::string description(std::string_view file) {
  const std::string line(file.substr(0, file.find('\n')));
  return line.substr(std::min(line.size(), line.find_first_not_of("# ")));
}

std::string boards_text(const Names& names) {
  std::size_t width = 0;
  for (const std::string& name : names) width = std::max(width, name.size());
  std::string text;
  for (const std::string& name : names)
    text += paragraph(name, width + 2, description(platform::preset_text(name)));
  return text;
}

std::string boards_json(const Names& names) {
  Json boards = Json::array();
  for (const std::string& name : names) {
    const std::string_view file = platform::preset_text(name);
    boards.push_back({{"name", name}, {"description", description(file)}, {"file", file}});
  }
  return json_text({{"schema", 1}, {"boards", std::move(boards)}});
}

struct BoardsOptions : Options {
  using Options::Options;

  Option show = Option(this, "--show", "NAME", "Print the file of this preset");
  JsonOption json{this};
};

int print_boards(const BoardsOptions& options) {
  Names names = platform::preset_names();
  const std::string& shown = options.show.text();
  if (options.show.is_given()) {
    if (std::find(names.begin(), names.end(), shown) == names.end()) {
      process::refuse(fmt::format("--show = {}: not a preset{}; presets: {}", shown,
                                  platform::nearest_text(shown, names), platform::listed(names)));
    }
    names = {shown};
  }
  process::print(options.json.is_given()   ? boards_json(names)
                 : options.show.is_given() ? std::string(platform::preset_text(shown))
                                           : boards_text(names));
  return kDone;
}

std::vector<std::string> schema_names() {
  std::vector<std::string> names = stats::document_names();
  names.insert(names.begin(), {"board", "plan"});
  return names;
}

Json schema_of(const std::string& name) {
  if (name == "board") return board_schema();
  return name == "plan" ? plan_schema() : stats::document_schema(name);
}

struct KeysOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    if (!schema.is_given()) return;
    for (const Option* const other : {&figures, static_cast<Option*>(&json), &word}) {
      if (other->is_given()) problems.add("--schema: does not go with " + other->name());
    }
  }

  Option word = Option(this, "WORD", " ", "Only those with this text in their name, meaning or unit");
  Option figures = Option(this, "--figures", "",
                          "List the figures of the points of a sweep instead: the columns of its database "
                          "that are no keys; NAME is that of a bank, port or buffer");
  Option schema = Option(this, "--schema", "NAME",
                         "Print a JSON Schema: of board files (`board`) or plans (`plan`), for editors, or "
                         "of what this command prints with --json",
                         {one_of(schema_names())});
  JsonOption json{this};
};

// The keys, or with --figures the figures, which have no rule.
std::vector<platform::Key> listed_keys(const KeysOptions& options) {
  std::vector<platform::Key> all;
  if (options.figures.is_given()) {
    for (const stats::Figure& figure : stats::figures())
      all.push_back({figure.name, figure.meaning, figure.unit, {}});
  } else {
    all = platform::keys();
  }
  const std::string& word = options.word.text();
  std::vector<platform::Key> found;
  for (platform::Key& key : all) {
    const std::string text = fmt::format("{}\n{}\n{}", key.path, key.meaning, key.unit);
    if (text.find(word) != std::string::npos) found.push_back(std::move(key));
  }
  if (found.empty()) {
    process::refuse(fmt::format(
        "WORD = {}: {}", word,
        options.figures.is_given() ? stats::unknown_figure_text(word) : platform::unknown_key_text(word)));
  }
  return found;
}

std::string keys_json(const KeysOptions& options) {
  const bool is_figures = options.figures.is_given();
  Json list = Json::array();
  for (const auto& key : listed_keys(options)) {
    Json json = {{is_figures ? "figure" : "key", key.path}, {"meaning", key.meaning}};
    if (!key.unit.empty()) json["unit"] = key.unit;
    if (!is_figures) json["range"] = key.rule.text;
    list.push_back(std::move(json));
  }
  return json_text({{"schema", 1}, {is_figures ? "figures" : "keys", std::move(list)}});
}

std::string keys_text(const KeysOptions& options) {
  const bool is_figures = options.figures.is_given();
  const auto keys = listed_keys(options);
  std::size_t path_width = 0;
  std::size_t unit_width = 4;
  for (const auto& key : keys) {
    path_width = std::max(path_width, key.path.size());
    unit_width = std::max(unit_width, key.unit.size());
  }
  const std::size_t indent = path_width + unit_width + 4;
  const auto head = [&](const std::string& path, const std::string& unit) {
    return fmt::format("{:<{}}  {:<{}}", path, path_width, unit, unit_width);
  };
  std::string text =
      is_figures ? paragraph(head("figure", "unit"), indent, "meaning")
                 : paragraph(head("key", "unit"), indent, "meaning; below it the range or allowed values");
  for (const auto& key : keys) {
    text += paragraph(head(key.path, key.unit), indent, key.meaning);
    if (!is_figures) text += paragraph("", indent, key.rule.text);
  }
  return text;
}

int print_keys(const KeysOptions& options) {
  process::print(options.schema.is_given() ? json_text(schema_of(options.schema.text()))
                 : options.json.is_given() ? keys_json(options)
                                           : keys_text(options));
  return kDone;
}

}  // namespace

void add_boards(Commands& commands) {
  add_command(commands, "boards", "List the preset boards, or show one", print_boards);
}

void add_keys(Commands& commands) {
  add_command(commands, "keys",
              "List every key of a board file, or every figure of a sweep, with its meaning", print_keys);
}

}  // namespace stereotlm::cli
