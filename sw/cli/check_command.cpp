#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "platform/config/board_area.h"
#include "sw/cli/board_options.h"
#include "sw/cli/command.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CheckOptions : Options {
  using Options::Options;

  BoardOptions board{this};
  JsonOption json{this};
};

std::string summary(const std::string& name, const platform::BoardConfig& board) {
  return fmt::format("{}: ok: {}x{}, window {}x{}, {} disparities, {} banks, {} MHz\n{}\n", name,
                     board.image.width, board.image.height, board.matcher.window, board.matcher.window,
                     board.matcher.disparities, board.banks.size(), board.fpga.clock_mhz,
                     platform::device_text(board));
}

// The parts of the text of a platform::Diagnostic. `key = value: rule` has all three, `key: missing: rule`
// has no value, and a rule alone has neither. A part that is absent is empty.
struct ProblemParts {
  std::string key;
  std::string value;
  std::string rule;
};

// The first colon with a blank behind it that is outside of brackets and quotes; npos if there is none.
std::size_t end_of_value(std::string_view text) {
  int depth = 0;
  char quote = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char letter = text[at];
    if (quote != 0) {
      if (letter == quote) quote = 0;
    } else if (letter == '"' || letter == '\'') {
      quote = letter;
    } else if (letter == '[' || letter == '{') {
      ++depth;
    } else if (letter == ']' || letter == '}') {
      --depth;
    } else if (depth == 0 && text.substr(at, 2) == ": ") {
      return at;
    }
  }
  return std::string_view::npos;
}

bool is_key(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '_' || letter == '-' || letter == '.';
  });
}

ProblemParts parts_of(std::string_view text) {
  constexpr std::string_view kMissing = ": missing: ";
  const std::size_t missing = text.find(kMissing);
  if (missing != std::string_view::npos && is_key(text.substr(0, missing)))
    return {std::string(text.substr(0, missing)), "",
            "missing: " + std::string(text.substr(missing + kMissing.size()))};
  const std::size_t equals = text.find(" = ");
  if (equals != std::string_view::npos && is_key(text.substr(0, equals))) {
    const std::string_view rest = text.substr(equals + 3);
    const std::size_t end = end_of_value(rest);
    if (end != std::string_view::npos)
      return {std::string(text.substr(0, equals)), std::string(rest.substr(0, end)),
              std::string(rest.substr(end + 2))};
  }
  return {"", "", std::string(text)};
}

Json json_of(const platform::Diagnostic& problem) {
  const ProblemParts parts = parts_of(problem.text);
  Json json = {{"place", problem.place}};
  if (!parts.key.empty()) json["key"] = parts.key;
  if (!parts.value.empty()) json["value"] = parts.value;
  json["rule"] = parts.rule;
  json["message"] = problem.text;
  return json;
}

// `board`: null if it has problems.
Json document_of(const std::string& name, const platform::BoardConfig* board,
                 const process::Problems& problems) {
  Json document = {{"schema", 1}, {"board", name}, {"ok", problems.empty()}};
  Json& list = document["problems"] = Json::array();
  for (const platform::Diagnostic& problem : problems.diagnostics()) list.push_back(json_of(problem));
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
  return document;
}

int check(const CheckOptions& options) {
  process::Problems problems;
  const LoadedBoard loaded = options.board.load(problems);
  if (problems.empty()) loaded.say_clock_remark();
  if (options.json.is_given()) {
    print_json(document_of(options.board.name(), loaded.board ? &*loaded.board : nullptr, problems));
    return problems.empty() ? kDone : kRefused;
  }
  problems.check();
  process::print(summary(options.board.name(), *loaded.board));
  return kDone;
}

}  // namespace

void add_check(CLI::App& program, Action& action) {
  add_command(
      program, action, "check", "Validate a board and nothing else", check,
      "With --json the problems of the board are printed as a list to standard output. The exit status\n"
      "is 2 then too.");
}

}  // namespace stereotlm::cli
