#include "sw/runs/verification.h"

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string_view>

#include "models/binder.h"
#include "sw/process/streams.h"
#include "sw/runs/sources/open_source.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::runs {
namespace {

constexpr std::size_t kMostLines = 10;
constexpr std::chrono::milliseconds kPollInterval{100};

struct Interrupted {};

// The result of a frame as one line; short, because the lines of all frames are kept.
std::string line_of(const Result& result, bool with_pixels) {
  std::string line = fmt::format("camera frame {}, done at {} ps", result.number, result.time_ps);
  if (with_pixels) {
    const auto& pixels = result.disparity.pixels;
    const std::string_view bytes(reinterpret_cast<const char*>(pixels.data()), pixels.size());
    line += fmt::format(", pixels {:016x}", std::hash<std::string_view>()(bytes));
  }
  return line;
}

// The text of stats.json, with the same name of the fidelity for both runs.
std::string stats_text(platform::Statistics statistics) {
  statistics.fidelity = "both";
  return stats::stats_json(statistics, std::nullopt);
}

void run_other(const RunInput& input, const process::Child::Tell& tell) {
  process::Problems problems;
  auto pictures = static_cast<const InputPictures&>(input.described);
  std::unique_ptr<PairSource> pairs = open_source(pictures, &input.board, problems).pairs;
  if (!problems.empty())
    throw std::runtime_error("the pictures cannot be read any more: " + problems.in_one_line());
  if (input.timing_only) pairs = blank_pairs(input.board);
  Binder binder;
  RunMode mode = input.mode();
  mode.recorded_frames = 0;
  mode.fidelity = input.fidelity(!input.fast);
  // Pairs of a client cannot be opened again; this process has a copy of them.
  const auto simulation =
      make_simulation(input.board, input.tables, pairs ? *pairs : *input.pairs, mode, binder);
  simulation->run([&] {
    for (const Result& result : simulation->take_results()) tell(line_of(result, !input.timing_only));
  });
  tell(stats_text(simulation->statistics()));
}

}  // namespace

Verification::Verification(const RunInput& input)
    : input_(input), other_([&input](const process::Child::Tell& tell) { run_other(input, tell); }) {}

void Verification::add(const Result& result) { results_.push_back(line_of(result, !input_.timing_only)); }

// The next message of the other run; nullopt after the last. Polls for interrupts while it waits, and throws
// Interrupted after one.
std::optional<std::string> Verification::next_of_other(ProgressLine& progress, std::size_t frames_compared) {
  do {
    if (process::interrupted()) throw Interrupted();
    progress.show(frames_compared, results_.size(), [&](double seconds) {
      return "verifying: " + progress_text(frames_compared, results_.size(), "frames", seconds);
    });
  } while (!other_.has_news(kPollInterval));
  return other_.next();
}

std::optional<std::vector<std::string>> Verification::compare(const platform::Statistics& statistics) {
  const std::string ours = input_.fast ? "fast" : "cycle";
  const std::string other = input_.fast ? "cycle" : "fast";
  std::vector<std::string> lines;
  ProgressLine progress("the run is repeated at fidelity " + other);
  try {
    for (std::size_t frame = 0; frame < results_.size(); ++frame) {
      const std::string theirs = next_of_other(progress, frame).value_or("nothing");
      if (theirs != results_[frame])
        lines.push_back(fmt::format("frame {}: {}: {}; {}: {}", frame, ours, results_[frame], other, theirs));
    }
    const std::string theirs = next_of_other(progress, results_.size()).value_or("{}");
    for (const std::string& difference :
         stats::stats_differences(stats_text(statistics), theirs, ours, other))
      lines.push_back("stats.json: " + difference);
  } catch (const Interrupted&) {
    return std::nullopt;
  } catch (const std::runtime_error& error) {
    return {{fmt::format("--verify: the run at fidelity {}: {}", other, error.what())}};
  }
  if (lines.size() > kMostLines) {
    const std::string rest = fmt::format("{} more lines", lines.size() - kMostLines);
    lines.resize(kMostLines);
    lines.push_back(rest);
  }
  for (std::string& line : lines) line.insert(0, "the fidelities differ: ");
  return lines;
}

}  // namespace stereotlm::runs
