#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "sw/cli/board_options.h"
#include "sw/cli/command.h"
#include "sw/cli/explanation_report.h"
#include "sw/explore/store/store.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/explanation.h"

namespace stereotlm::cli {
namespace {

struct ExplainOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    if (!frames.is_given()) return;
    const bool camera = source.is_camera();
    const platform::IntegerRule rule =
        camera
            ? platform::IntegerRule{runs::Explanation::kLeastComputerFrames, 1'000'000}
            : platform::IntegerRule{runs::Explanation::kCoreFrames, 999'996, runs::Explanation::kCoreFrames};
    if (!rule.allows(frames.number<std::int64_t>().value_or(0)))
      problems.add(fmt::format(
          "--frames = {}: {}{}", frames.text(), rule.text(),
          camera ? ", so that every board has a steady rate" : ", whole turns of the lists of every board"));
  }

  BoardOptions board{this};
  SourceOption source{this};
  Option frames = Option(this, "--frames", "N",
                         fmt::format("Frames of each board; by default {}, of the whole computer {}",
                                     runs::Explanation::kCoreFrames, runs::Explanation::kComputerFrames));
  JsonOption json{this};
};

int explain(const ExplainOptions& options) {
  process::Problems problems;
  const LoadedBoard loaded = options.board.load(problems);
  const auto& board = loaded.board;
  check_temporary_folder(problems);
  if (const auto problem = board ? explore::bank_names_problem(*board) : std::nullopt)
    problems.add(fmt::format("{}: {}", options.board.name(), *problem));
  problems.check();
  loaded.say_clock_remark();
  const platform::Tables tables = loaded.tables();
  process::catch_interrupts();
  runs::Explanation explanation(*board, tables, options.source.is_camera(),
                                options.frames.number<std::uint64_t>().value_or(0));
  if (!explanation.simulate(loaded.simulator())) return kInterrupted;
  if (options.json.is_given()) {
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
