#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "platform/figures/bounds.h"
#include "platform/yaml/yaml_tree.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/files/output_file.h"
#include "sw/files/whole_file.h"
#include "sw/process/client.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string summary(const std::string& name, const platform::BoardConfig& board) {
  return fmt::format("{}: ok: {}x{}, window {}x{}, {} disparities, {} banks, {} MHz\n{}\n{}", name,
                     board.image.width, board.image.height, board.matcher.window, board.matcher.window,
                     board.matcher.disparities, board.banks.size(), board.fpga.clock_mhz,
                     platform::device_text(board), platform::local_bus_remark(board));
}

Json json_of(const platform::YamlNode& value) {
  Json json = value.is_map() ? Json::object() : Json::array();
  for (const platform::YamlNode& item : value.items) json.push_back(json_of(item));
  for (const platform::YamlNode::Entry& entry : value.entries) json[entry.key.text] = json_of(entry.value);
  if (!value.is_scalar()) return json;
  const auto number = integer_of(value);
  return number ? Json(*number) : Json(value.text);
}

// The values of a board by their paths; lists and maps as such.
Json values_document(const platform::BoardConfig& board) {
  Json values = Json::object();
  for (const platform::BoardValue& value : platform::values_of(board)) {
    std::visit([&](const auto& its) { values[value.path] = its; }, value.value);
    if (const auto* const text = std::get_if<std::string>(&value.value);
        text != nullptr && value.path != "name" && (text->front() == '[' || text->front() == '{'))
      values[value.path] = json_of(platform::parse_flow_value(*text, platform::Place::kBoard));
  }
  return values;
}

// `board`: null if it has problems.
Json document_of(const std::string& name, const platform::BoardConfig* board,
                 const process::Problems& problems) {
  Json document = {{"schema", 1}, {"board", name}, {"ok", problems.empty()}};
  Json& list = document["problems"] = Json::array();
  for (const platform::Diagnostic& problem : problems.diagnostics())
    list.push_back(problem_document(problem));
  if (!problems.empty() || board == nullptr) return document;
  document["image"] = {{"width", board->image.width}, {"height", board->image.height}};
  document["window"] = board->matcher.window;
  document["disparities"] = board->matcher.disparities;
  document["banks"] = board->banks.size();
  document["clock_mhz"] = board->fpga.clock_mhz;
  const area::Area area = platform::area_of(*board);
  document["device"] = board->fpga.device;
  document["fits"] = area.fits();
  if (const area::Device* const smallest = area::smallest_device(area))
    document["smallest_device"] = smallest->name;
  document["pins"] = platform::pins_of(*board);
  document["values"] = values_document(*board);
  const std::vector<std::string> presets = platform::preset_names();
  const bool is_preset = std::find(presets.begin(), presets.end(), name) != presets.end();
  const auto [preset, sets] =
      is_preset ? std::pair(name, platform::sets_between(platform::load_board(name), *board))
                : platform::sets_of_nearest_preset(*board);
  document["preset"] = preset;
  document["sets"] = sets;
  return document;
}

// Sends the client the content of each file that was read, so that it can send the same to other commands.
void send_files(const LoadedBoard& loaded, const process::FileContents& sent) {
  process::FileContents files;
  if (loaded.calibration) files = loaded.calibration->contents;
  if (!loaded.file_text.empty()) files["board.yaml"] = loaded.file_text;
  for (const auto& [name, bytes] : files) {
    if (sent.count(name) == 0) process::client->send({name, {bytes.size()}, bytes});
  }
}

struct CheckOptions : BoardCommandOptions {
  using BoardCommandOptions::BoardCommandOptions;

  Option write = Option(this, "--write", "F.yaml", "Write the board as a board file", {ends_in(".yaml")});
};

// Replaces no file but one of the same bytes.
void write_board(const CheckOptions& options, const std::string& text) {
  const files::FileKind kind = {"file of this board",
                                [&](const auto& file) { return files::read_whole_file(file) == text; }};
  const std::vector<files::NamedFile> read = {{"BOARD", options.board.argument.text()}};
  std::optional<files::OutputFile> file;
  process::attempt_or_refuse("--write ", [&] { file.emplace(options.write.text(), kind, read); });
  file->write(text);
  file->commit();
}

int check(const CheckOptions& options) {
  process::Problems problems;
  const LoadedBoard loaded = options.board.load(problems);
  if (problems.empty()) loaded.say_clock_remark();
  if (problems.empty() && process::client != nullptr) send_files(loaded, options.board.sent);
  if (problems.empty() && options.write.is_given()) write_board(options, platform::to_yaml(*loaded.board));
  if (options.json.is_given()) {
    process::print(json_text(
        document_of(options.board.argument.text(), loaded.board ? &*loaded.board : nullptr, problems)));
    if (process::client != nullptr) process::client->refuse(problems.diagnostics());
    return problems.empty() ? kDone : kRefused;
  }
  problems.check();
  process::print(summary(options.board.argument.text(), *loaded.board));
  return kDone;
}

}  // namespace

// The text of a platform::Diagnostic is `key = value: rule`, `key: missing: rule`, or a rule alone. The value
// ends at the first colon with a blank behind it that is outside of brackets and quotes; a shortened one
// ends in `...`.
nlohmann::ordered_json problem_document(const platform::Diagnostic& problem) {
  static const std::regex form(
      R"(([\w.-]+)(?:: (missing: .*)| = ((?:"[^"]*"|'[^']*'|\[[^\]]*\]|\{(?:[^{}]|\{[^{}]*\})*\}|)"
      R"([^"'\[\]{}:]|:(?! ))*|.*?[.]{3}): (.*)))");
  Json json = {{"place", problem.place}};
  std::smatch parts;
  const bool has_key = std::regex_match(problem.text, parts, form);
  if (has_key) json["key"] = parts.str(1);
  if (has_key && parts.length(3) > 0) json["value"] = parts.str(3);
  json["rule"] = has_key ? parts.str(2) + parts.str(4) : problem.text;
  json["message"] = problem.text;
  if (problem.is_between_keys) json["between_keys"] = true;
  return json;
}

void add_check(Commands& commands) {
  add_command(
      commands, "check", "Validate a board, and write it as a file", check,
      "With --json the problems of the board are printed as a list to standard output. The exit status\n"
      "is 2 then too.");
}

}  // namespace stereotlm::cli
