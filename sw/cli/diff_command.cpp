#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "sw/cli/command.h"
#include "sw/cli/diff_text.h"
#include "sw/cli/text.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/frame_alignment.h"
#include "sw/runs/recorded_run.h"
#include "sw/stats/run_comparison.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kRunFolder = "a folder that run --out has written";
constexpr const char* kDiffFooter =
    "Both are run again from their config.yaml and run.json, after a check of every input by its\n"
    "SHA-256, and must give the figures of their stats.json. What is not the same is printed;\n"
    "differences are B - A. A row of results is whole with the write of its last word. Its cycles are\n"
    "those since the row above was whole, those of the top row since the frame began; in the table of\n"
    "rows they are sums over the frames. The last line says which run is faster, and where the difference\n"
    "arises.";

struct DiffOptions : Options {
  using Options::Options;

  Option a = Option(this, "A", " ", "A folder that run --out has written", {required(kRunFolder)});
  Option b = Option(this, "B", " ", "Another one", {required(kRunFolder)});
  Option csv{
      this, "--csv", "F.csv", "Write the cycles and waits of every frame and row of both", {ends_in(".csv")}};
  JsonOption json{this};
};

int diff(const DiffOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  const auto a = runs::load_recorded_run("A", options.a.text(), problems);
  const auto b = runs::load_recorded_run("B", options.b.text(), problems);
  problems.check();
  for (const runs::RecordedRun& run : {std::cref(*a), std::cref(*b)}) runs::open_again(run, problems);
  const runs::DiffLimits limits(*a, *b);
  std::unique_ptr<stats::RowsCsv> csv;
  if (options.csv.is_given()) {
    if (!limits.rows.empty()) problems.add(fmt::format("--csv: rows cannot be compared: {}", limits.rows));
    try {
      csv = std::make_unique<stats::RowsCsv>(options.csv.text());
    } catch (const std::runtime_error& error) {
      problems.add(fmt::format("--csv {}", error.what()));
    }
  }
  problems.check();
  runs::FrameAlignment aligned(*a, *b, limits, csv.get());
  if (!aligned.run()) return interrupted("nothing is compared");
  if (csv) csv->commit();
  if (options.json.is_given()) {
    print_json(diff_document(*a, *b, aligned, limits));
  } else {
    const std::string text = diff_text(*a, *b, aligned, limits);
    process::print(with_coloured_words(text, text.rfind("\n\n"),
                                       {{"is faster", process::Colour::kGreen},
                                        {"equally fast", process::Colour::kGreen},
                                        {"are the same", process::Colour::kGreen},
                                        {"differ.", process::Colour::kYellow}}));
  }
  return kDone;
}

}  // namespace

void add_diff(CLI::App& program, Action& action) {
  add_command(program, action, "diff", "Compare two runs, frame by frame and row by row", diff, kDiffFooter);
}

}  // namespace stereotlm::cli
