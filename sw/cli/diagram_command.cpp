#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/typed_option.h"
#include "sw/files/output_file.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/report/chart/memory_chart.h"
#include "sw/runs/recorded_run.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kDiagramFooter =
    "The block diagram of the board as it is configured: cameras, capture boards, PCI bus, bridge, ports\n"
    "and stages of the FPGA, and the banks with their buffers. The links have their peak MB/s.\n"
    "BOARD may be a folder that run --out has written: then the links have the MB/s of that run, as\n"
    "their width, and as their colour in % of the peak.";

const std::vector<std::string> kExtents = {"camera", "preloaded"};  // the first is the default

struct DiagramOptions {
  BoardOptions board;
  Typed source;
  Typed out_option;

  void add_to(CLI::App& command) {
    board.add_to(command);
    source.add_to(command, "--source", fmt::format("{}", fmt::join(kExtents, "|")),
                  "camera (the default): the whole computer; preloaded: the board alone. A run has its own");
    out_option.add_to(command, "--out", "F.svg", "The file to write");
  }

  // Set by check_usage().
  bool is_run = false;
  report::ChartExtent extent = report::ChartExtent::kComputer;
  std::filesystem::path out;

  void check_usage() {
    process::Problems problems;
    board.check_given(problems);
    const std::vector<std::string> presets = platform::preset_names();
    std::error_code error;
    is_run = std::find(presets.begin(), presets.end(), board.name()) == presets.end() &&
             std::filesystem::is_directory(board.name(), error);
    if (is_run && (source.is_given() || board.changes_board()))
      problems.add(fmt::format(
          "'{}': a run has its board: --source, --set and --calibration do not go with it", board.name()));
    if (source.is_given() && is_one_of(kExtents, "--source", source.text, problems) &&
        source.text != kExtents.front())
      extent = report::ChartExtent::kBoard;
    if (!out_option.is_given()) problems.add("--out: missing: the file to write, F.svg");
    out = out_option.text;
    if (out_option.is_given() && out.extension() != ".svg")
      problems.add(fmt::format("--out '{}': must end in .svg", out_option.text));
    problems.check();
  }
};

std::string chart_of_run(const std::string& folder, process::Problems& problems) {
  const auto run = runs::read_recorded_run(
      "RUN", folder, "BOARD must be a board, or a folder that run --out has written: ", problems);
  return run ? report::memory_chart_svg(run->board, report::chart_traffic(run->board, run->statistics)) : "";
}

std::string chart_of_board(const DiagramOptions& options, process::Problems& problems) {
  const auto board = options.board.load(problems);
  options.board.load_calibration(board ? &*board : nullptr, problems);
  return board ? report::memory_chart_svg(*board, options.extent) : "";
}

int diagram(const DiagramOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  const std::string chart =
      options.is_run ? chart_of_run(options.board.name(), problems) : chart_of_board(options, problems);
  problems.check();
  try {
    files::OutputFile file(options.out,
                           files::marked_kind("chart of stereotlm diagram", {{0, report::kChartMark}}));
    file.write(chart);
    file.complete();
    if (process::interrupted()) {
      process::say("note", "interrupted: no chart is written");
      return kInterrupted;
    }
    file.commit();
  } catch (const std::runtime_error& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  }
  process::print(fmt::format("{}: the memory chart of {}\n", options.out.string(), options.board.name()));
  return kDone;
}

}  // namespace

void add_diagram(CLI::App& program, Action& action) {
  add_command(program, action, "diagram", "Draw the block diagram of a board, or of a run with its traffic",
              diagram, kDiagramFooter);
}

}  // namespace stereotlm::cli
