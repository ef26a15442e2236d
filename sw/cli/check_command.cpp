#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "platform/config/board_area.h"
#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/json_option.h"
#include "sw/cli/problem_parts.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CheckOptions {
  BoardOptions board;
  JsonOption json;

  void add_to(CLI::App& command) {
    board.add_to(command);
    json.add_to(command);
  }
  void check_usage() { board.check_usage(); }
};

std::string summary(const std::string& name, const platform::BoardConfig& board) {
  return fmt::format("{}: ok: {}x{}, window {}x{}, {} disparities, {} banks, {} MHz\n{}\n", name,
                     board.image.width, board.image.height, board.matcher.window, board.matcher.window,
                     board.matcher.disparities, board.banks.size(), board.fpga.clock_mhz,
                     platform::device_text(board));
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
  const auto board = options.board.load(problems);
  options.board.load_calibration(board ? &*board : nullptr, problems);
  if (problems.empty()) say_clock_remark(*board);
  if (options.json.is_given) {
    print_json(document_of(options.board.name(), board ? &*board : nullptr, problems));
    return problems.empty() ? kDone : kRefused;
  }
  problems.check();
  process::print(summary(options.board.name(), *board));
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
