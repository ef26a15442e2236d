#include <fmt/format.h>

#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

std::string summary(const std::string& name, const platform::BoardConfig& board) {
  return fmt::format("{}: ok: {}x{}, window {}x{}, {} disparities, {} banks, {} MHz\n", name,
                     board.image.width, board.image.height, board.matcher.window, board.matcher.window,
                     board.matcher.disparities, board.banks.size(), board.fpga.clock_mhz);
}

int check(const BoardOptions& options) {
  process::Problems problems;
  const auto board = options.load(problems);
  options.load_calibration(board ? &*board : nullptr, problems);
  problems.check();
  process::print(summary(options.name(), *board));
  return kDone;
}

}  // namespace

void add_check(CLI::App& program, Action& action) {
  add_command(program, action, "check", "Validate a board and nothing else", check);
}

}  // namespace stereotlm::cli
