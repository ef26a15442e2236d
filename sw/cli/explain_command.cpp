#include <fmt/format.h>

#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/explanation_json.h"
#include "sw/cli/explanation_text.h"
#include "sw/cli/json_option.h"
#include "sw/cli/temporary_files.h"
#include "sw/cli/typed_option.h"
#include "sw/explore/store/bank_names.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/explanation.h"

namespace stereotlm::cli {
namespace {

struct ExplainOptions {
  BoardOptions board;
  Typed source;
  Typed frames;
  JsonOption json;
  bool camera = true;             // set by check_usage()
  std::uint64_t frame_count = 0;  // the same; 0: the default

  void add_to(CLI::App& command) {
    board.add_to(command);
    source.add_to(command, "--source", "camera|preloaded",
                  "The whole computer, the default, or the core alone, fed by an ideal host");
    frames.add_to(command, "--frames", "N",
                  fmt::format("Frames of each board; by default {}, of the whole computer {}",
                              runs::Explanation::kCoreFrames, runs::Explanation::kComputerFrames));
    json.add_to(command);
  }

  void check_usage() {
    process::Problems problems;
    board.check_given(problems);
    if (source.is_given() && is_one_of({"camera", "preloaded"}, "--source", source.text, problems)) {
      camera = source.text == "camera";
    }
    if (frames.is_given()) {
      const platform::IntegerRule rule =
          camera ? platform::IntegerRule{runs::Explanation::kLeastComputerFrames, 1'000'000}
                 : platform::IntegerRule{runs::Explanation::kCoreFrames, 999'996,
                                         runs::Explanation::kCoreFrames};
      const auto number = number_of<std::int64_t>(frames.text);
      if (!number || !rule.allows(*number))
        problems.add(fmt::format("--frames = {}: {}{}", frames.text, rule.text(),
                                 camera ? ", so that every board has a steady rate"
                                        : ", whole turns of the lists of every board"));
      frame_count = static_cast<std::uint64_t>(number.value_or(0));
    }
    problems.check();
  }
};

int explain(const ExplainOptions& options) {
  process::Problems problems;
  const auto board = options.board.load(problems);
  const auto calibration = options.board.load_calibration(board ? &*board : nullptr, problems);
  temporary_folder(problems);  // the simulations need one: reports now if it cannot be created
  if (const auto problem = board ? explore::bank_names_problem(*board) : std::nullopt)
    problems.add(fmt::format("{}: {}", options.board.name(), *problem));
  problems.check();
  say_clock_remark(*board);
  const platform::Tables tables = runs::tables_of(*board, calibration);
  process::catch_interrupts();
  runs::Explanation explanation(*board, tables, options.camera, options.frame_count);
  if (!explanation.simulate(calibration ? runs::PointSimulator(tables) : runs::PointSimulator())) {
    return kInterrupted;
  }
  if (options.json.is_given) {
    print_json(explanation_document(*board, explanation));
  } else {
    process::print(explanation_text(*board, explanation));
  }
  return kDone;
}

}  // namespace

void add_explain(CLI::App& program, Action& action) {
  add_command(
      program, action, "explain", "Say what limits a board, and what each single change gains or costs",
      explain,
      "The board is simulated, and then once more for each change: one key one step up or down, such as a\n"
      "cycle, a MHz, a place in a queue, a word of a burst, a buffer or a bank. The changes are sorted by\n"
      "their frame rate. FPGA % (of the slices) and RAMs are what a change takes of the FPGA, or frees. A\n"
      "bank more is the best way to give one buffer a new bank of its own, a bank less the best way to\n"
      "move all buffers of one bank into another. The size of the images, the depth of banks and the\n"
      "device stay.");
}

}  // namespace stereotlm::cli
