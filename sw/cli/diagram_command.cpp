#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "platform/config/board_yaml.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/report/chart/memory_chart.h"
#include "sw/runs/recorded_run.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kDiagramFooter =
    "The block diagram of the board as it is configured: cameras, capture boards, PCI bus, bridge, ports\n"
    "and stages of the FPGA, and the banks with their buffers. The links have their peak MB/s.\n"
    "BOARD may be a folder that run --out has written: then the links have the MB/s of that run, as\n"
    "their width, and as their colour in % of the peak.";

struct DiagramOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    if (is_run() && (source.is_given() || board.changes_board()))
      problems.add(
          fmt::format("'{}': a run has its board: --source, --set and --calibration do not go with it",
                      board.argument.text()));
  }

  // A preset comes before a folder of its name.
  bool is_run() const {
    const std::vector<std::string> presets = platform::preset_names();
    std::error_code error;
    return std::find(presets.begin(), presets.end(), board.argument.text()) == presets.end() &&
           std::filesystem::is_directory(board.argument.text(), error);
  }

  BoardOptions board{this};
  SourceOption source{
      this, "camera (the default): the whole computer; preloaded: the board alone. A run has its own"};
  Option out = Option(this, "--out", "F.svg", "The file to write",
                      {required("the file to write, F.svg"), ends_in(".svg")});
};

std::string chart_of_run(const std::string& folder, process::Problems& problems) {
  const auto run = runs::read_recorded_run(
      "RUN", folder, "BOARD must be a board, or a folder that run --out has written: ", problems);
  if (!run) return "";
  return report::memory_chart_svg({run->board, run->statistics.computer.has_value(), &run->statistics});
}

std::string chart_of_board(const DiagramOptions& options, process::Problems& problems) {
  const LoadedBoard loaded = options.board.load(problems);
  return loaded.board ? report::memory_chart_svg({*loaded.board, options.source.is_camera()}) : "";
}

int diagram(const DiagramOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  const std::string chart = options.is_run() ? chart_of_run(options.board.argument.text(), problems)
                                             : chart_of_board(options, problems);
  problems.check();
  const auto kind = files::marked_kind("chart of stereotlm diagram", {{0, report::kChartMark}});
  if (!write_out(options.out.text(), kind, chart)) return interrupted("no chart is written");
  process::print(
      fmt::format("{}: the memory chart of {}\n", options.out.text(), options.board.argument.text()));
  return kDone;
}

}  // namespace

void add_diagram(Commands& commands) {
  add_command(commands, "diagram", "Draw the block diagram of a board, or of a run with its traffic", diagram,
              kDiagramFooter);
}

}  // namespace stereotlm::cli
