#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "sw/cli/add_command.h"
#include "sw/cli/commands.h"
#include "sw/cli/diff_text.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/json_option.h"
#include "sw/cli/typed_option.h"
#include "sw/cli/verdict_colours.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/frame_alignment.h"
#include "sw/runs/recorded_run.h"
#include "sw/stats/run_comparison.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kDiffFooter =
    "Both are run again from their config.yaml and run.json, after a check of every input by its\n"
    "SHA-256, and must give the figures of their stats.json. What is not the same is printed;\n"
    "differences are B - A. A row of results is whole with the write of its last word. Its cycles are\n"
    "those since the row above was whole, those of the top row since the frame began; in the table of\n"
    "rows they are sums over the frames. The last line says which run is faster, and where the difference\n"
    "arises.";

struct DiffOptions {
  Typed a;
  Typed b;
  Typed csv_option;
  JsonOption json;

  void add_to(CLI::App& command) {
    a.add_to(command, "A", " ", "A folder that run --out has written");
    b.add_to(command, "B", " ", "Another one");
    csv_option.add_to(command, "--csv", "F.csv", "Write the cycles and waits of every frame and row of both");
    json.add_to(command);
  }

  // Set by check_usage().
  std::optional<std::string> csv;

  void check_usage() {
    process::Problems problems;
    for (const auto& [name, run] : {std::pair("A", &a), std::pair("B", &b)}) {
      if (run->text.empty())
        problems.add(fmt::format("{}: missing: a folder that run --out has written", name));
    }
    if (csv_option.is_given()) csv = csv_option.text;
    if (csv && std::filesystem::path(*csv).extension() != ".csv")
      problems.add(fmt::format("--csv '{}': must end in .csv", *csv));
    problems.check();
  }
};

int diff(const DiffOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  const auto a = runs::load_recorded_run("A", options.a.text, problems);
  const auto b = runs::load_recorded_run("B", options.b.text, problems);
  problems.check();
  for (const runs::RecordedRun& run : {std::cref(*a), std::cref(*b)}) runs::open_again(run, problems);
  const runs::DiffLimits limits(*a, *b);
  std::unique_ptr<stats::RowsCsv> csv;
  if (options.csv) {
    if (!limits.rows.empty()) problems.add(fmt::format("--csv: rows cannot be compared: {}", limits.rows));
    try {
      csv = std::make_unique<stats::RowsCsv>(*options.csv);
    } catch (const std::runtime_error& error) {
      problems.add(fmt::format("--csv {}", error.what()));
    }
  }
  problems.check();
  runs::FrameAlignment aligned(*a, *b, limits, csv.get());
  if (!aligned.run()) {
    process::say("note", "interrupted: nothing is compared");
    return kInterrupted;
  }
  if (csv) csv->commit();
  if (options.json.is_given) {
    print_json(diff_document(*a, *b, aligned, limits));
  } else {
    process::print(with_coloured_sentence(diff_text(*a, *b, aligned, limits)));
  }
  return kDone;
}

}  // namespace

void add_diff(CLI::App& program, Action& action) {
  add_command(program, action, "diff", "Compare two runs, frame by frame and row by row", diff, kDiffFooter);
}

}  // namespace stereotlm::cli
