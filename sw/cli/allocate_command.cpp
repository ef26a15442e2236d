#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "platform/bounds.h"
#include "platform/config/buffer_layout.h"
#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/typed_option.h"
#include "sw/explore/search/allocation_run.h"
#include "sw/explore/search/allocation_search.h"
#include "sw/explore/store/bank_names.h"
#include "sw/explore/store/store.h"
#include "sw/explore/store/store_lock.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/media/synthetic_scene.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/simulate_point.h"

namespace stereotlm::cli {
namespace {

using explore::AllocationSearch;
using explore::BestPlacement;
using explore::Placement;
using platform::BoardConfig;

constexpr double kDefaultKeepPercent = 99;
constexpr const char* kInterruptedNote = "interrupted: run the same command to resume";

struct AllocateOptions {
  BoardOptions board;
  Typed banks_option;
  Typed source;
  Typed keep_option;
  Typed out;

  // Set by check_usage().
  bool camera = true;
  std::optional<int> banks;
  double keep_percent = kDefaultKeepPercent;

  void add_to(CLI::App& command) {
    board.add_to(command);
    banks_option.add_to(command, "--banks", "N", "Banks to use at most: 1 to those of the board");
    source.add_to(command, "--source", "camera|preloaded",
                  "The whole computer, the default, or the core alone, fed by an ideal host");
    keep_option.add_to(command, "--keep-fps", "PERCENT",
                       "Say how few banks keep so much of the best frame rate (default 99)");
    out.add_to(command, "--out", "DB", "The database of the boards that are simulated, written or continued");
  }

  void check_usage() {
    process::Problems problems;
    if (source.is_given() && is_one_of({"camera", "preloaded"}, "--source", source.text, problems)) {
      camera = source.text == "camera";
    }
    board.check_given(problems);
    if (!banks_option.is_given()) problems.add("--banks: missing: the most banks to use");
    if (banks_option.is_given()) {
      banks = number_of<int>(banks_option.text);
      if (!banks || *banks < 1) {
        problems.add(fmt::format("--banks = {}: must be 1 or more", banks_option.text));
      }
    }
    if (keep_option.is_given()) {
      const auto percent = number_of<double>(keep_option.text);
      if (!percent || !(*percent > 0 && *percent <= 100)) {
        problems.add(
            fmt::format("--keep-fps = {}: must be a percentage above 0 and at most 100", keep_option.text));
      } else {
        keep_percent = *percent;
      }
    }
    if (!out.is_given()) problems.add("--out: missing: the database to write, or to continue");
    problems.check();
  }
};

// A different synthetic pair for each frame.
class ScenePairs : public host::FrameSource {
 public:
  explicit ScenePairs(const BoardConfig& board)
      : scene_(1, board.image.width, board.image.height, board.matcher.disparities) {}
  const host::StereoPair& pair(std::uint64_t frame) override {
    auto pictures = scene_.frame(frame);
    pair_ = {std::move(pictures.left), std::move(pictures.right)};
    return pair_;
  }

 private:
  media::SyntheticScene scene_;
  host::StereoPair pair_;
};

// The placement as text: "left_image bank0 bank1, .., right_lut bank0".
std::string text_of(const BoardConfig& board, const Placement& placement) {
  return explore::allocation_text(explore::placed(board, placement));
}

// The parts from which the functions below make the lines of the report: the search, its board, and the upper
// bound of the frame rate of a board.
struct Context {
  const AllocationSearch& search;
  const BoardConfig& board;
  AllocationSearch::BoundOf bound;
};

std::string rate_text(double rate) { return fmt::format("{:.3f}", rate); }

// Two rates that differ, with as many decimals as show it; at least three.
std::pair<std::string, std::string> different_texts(double one, double other) {
  for (int decimals = 3;; ++decimals) {
    std::pair<std::string, std::string> texts = {fmt::format("{:.{}f}", one, decimals),
                                                 fmt::format("{:.{}f}", other, decimals)};
    if (texts.first != texts.second) return texts;
  }
}

std::string table(const Context& context, const std::vector<BestPlacement>& all) {
  const bool camera = context.search.run().camera;
  std::string text = fmt::format("{:>5} {:>12} {:>10} {:>14} {:>10}", "banks", "allocations", "simulated",
                                 "best frames/s", "bound");
  if (camera) text += fmt::format(" {:>8}", "steady");
  text += fmt::format(" {:>10}  one of them\n", "reached by");
  for (const BestPlacement& best : all) {
    text += fmt::format("{:>5} {:>12} {:>10}", best.banks, best.placements, best.known + best.given_up);
    if (best.reached_by == 0) {
      text += fmt::format(" {:>14}\n", best.failed == 0 ? "all lose pixels" : "none");
      continue;
    }
    const BoardConfig one = explore::placed(context.board, best.witness);
    text += fmt::format(" {:>14.3f} {:>10.3f}", best.frames_per_second, context.bound(one));
    if (camera) text += fmt::format(" {:>8.3f}", best.outcome.steady.value_or(0));
    text += fmt::format(" {:>10}  {}\n", best.reached_by, explore::allocation_text(one));
  }
  return text;
}

// Simulates the best allocation for each number of banks, with pixels: an ideal host supplies a different
// pair for each frame. Throws if two allocations compute different disparities. For the core alone, also
// throws if an allocation needs another number of cycles than the search has found. Returns a line with the
// number of allocations; empty if there are none, or after an interrupt.
std::string check_pixels(const Context& context, const platform::Tables& tables,
                         const std::vector<BestPlacement>& all) {
  ScenePairs pairs(context.board);
  const std::uint64_t frames = platform::allocation_period_frames(context.board);
  std::string first;
  const Placement* first_witness = nullptr;
  std::size_t checked = 0;
  for (const BestPlacement& best : all) {
    if (process::interrupted()) return "";
    if (best.reached_by == 0) continue;
    const auto run =
        runs::simulate_pixels(explore::placed(context.board, best.witness), tables, pairs, frames);
    if (checked++ == 0) {
      first = run.disparities_sha256;
      first_witness = &best.witness;
    }
    if (run.disparities_sha256 != first) {
      throw std::runtime_error(fmt::format("the disparities of {} differ from those of {}",
                                           text_of(context.board, best.witness),
                                           text_of(context.board, *first_witness)));
    }
    if (!context.search.run().camera && run.cycles != best.outcome.cycles) {
      throw std::runtime_error(fmt::format("{}: {} cycles with pixels, {} found",
                                           text_of(context.board, best.witness), run.cycles,
                                           best.outcome.cycles));
    }
  }
  if (checked == 0) return "";
  return fmt::format("The disparities of these {} allocations are the same, pixel by pixel, in {} frames.\n",
                     checked, frames);
}

// The lines with the result of the search: the best rate of all, and the fewest banks that keep
// `keep_percent` of it.
std::string certificate(std::vector<BestPlacement> all, double keep_percent) {
  const auto is_out = [](const BestPlacement& best) { return best.reached_by == 0; };
  const bool holds_buffers_only = !all.empty() && is_out(all.front());
  all.erase(std::remove_if(all.begin(), all.end(), is_out), all.end());
  if (all.empty()) return "No allocation counts.\n";
  const auto rate = [](const BestPlacement& best) { return best.frames_per_second; };
  const auto by_rate = [&](const auto& a, const auto& b) { return rate(a) < rate(b); };
  const auto top = std::max_element(all.begin(), all.end(), by_rate);
  std::string top_text = rate_text(rate(*top));
  std::string rest;
  if (top != all.begin()) {
    std::string fewer_text;
    std::tie(top_text, fewer_text) =
        different_texts(rate(*top), rate(*std::max_element(all.begin(), top, by_rate)));
    rest = ": the best with fewer gives " + fewer_text;
  } else {
    rest = holds_buffers_only ? ", the fewest with an allocation that counts"
                              : ", the fewest that hold the buffers";
  }
  std::string text =
      fmt::format("The best of all is {} frames/s, and needs {} banks{}.\n", top_text, top->banks, rest);
  const auto kept = std::find_if(all.begin(), all.end(), [&](const BestPlacement& best) {
    return rate(best) * 100 >= rate(*top) * keep_percent;
  });
  return text +
         fmt::format("{:g} % of it is kept with {} banks ({} frames/s, {:.2f} %), and not with fewer.\n",
                     keep_percent, kept->banks, rate_text(rate(*kept)), 100 * rate(*kept) / rate(*top));
}

// The lines with the numbers of allocations that do not count, because they lose pixels or could not be
// simulated.
std::string not_counted_text(const Context& context, const std::vector<BestPlacement>& all,
                             const std::string& store) {
  std::uint64_t losing = 0;
  std::uint64_t failed = 0;
  for (const BestPlacement& best : all) {
    losing += best.losing;
    failed += best.failed;
  }
  std::string text;
  if (losing > 0)
    text += fmt::format("{} of those simulated to the end lose pixels, and do not count.\n", losing);
  if (failed > 0) {
    text += fmt::format(
        "{} could not be simulated, and do not count. The first:\n  {}\nTo try again:\n"
        "  sqlite3 {} \"DELETE FROM points WHERE status = 'failed'\"\n",
        failed, context.search.first_failure(), store);
  }
  return text;
}

// The lines that state how many allocations were tried, and why no others are needed.
std::string space_text(const Context& context, int banks) {
  const AllocationSearch& search = context.search;
  std::string text =
      fmt::format("{}: {} buffers in at most {} of {} banks: {} different allocations, {} of them fit\n",
                  context.board.name, platform::buffers(context.board).size(), banks,
                  context.board.banks.size(), search.placements(), search.fitting());
  if (search.by_frames()) {
    return text +
           fmt::format(
               "{} boards of one frame are all that has to be simulated: with {} and without "
               "turnaround a\nframe leaves nothing behind, so that its cycles depend on which of its own "
               "buffers share a bank, and on nothing else\n",
               search.size(), context.board.fpga.arbiter.policy);
  }
  text += search.run().camera
              ? fmt::format(
                    "frames/s: {} frames, from time 0 to the last delivery, without losing a pixel; steady: "
                    "between the first and the last\n",
                    explore::frames_of(search.run(), context.board))
              : "a frame leaves arbiters or banks in another state: each allocation is a run of the first "
                "turn of its lists\n";
  return text +
         "an allocation whose bound is below the best rate of as many banks was not simulated, or not to its "
         "end\n";
}

AllocationSearch search_of(const BoardConfig& board, int banks, const explore::PointRun& run,
                           const AllocationSearch::BoundOf& bound) {
  try {
    return AllocationSearch(board, banks, run, bound);
  } catch (const std::length_error& error) {
    process::refuse(
        fmt::format("--banks = {}: {}; give fewer, or a board with fewer buffers or more banks alike", banks,
                    error.what()));
  }
}

// "; with N some do": N is the fewest banks, more than `banks`, into which N allocations fit; empty if there
// are none.
std::string fewest_text(const BoardConfig& board, int banks, const explore::PointRun& run) {
  const auto most = static_cast<int>(board.banks.size());
  const auto no_bound = [](const BoardConfig&) { return 0.0; };
  while (++banks <= most) {
    if (search_of(board, banks, run, no_bound).fitting() > 0) return fmt::format("; with {} some do", banks);
  }
  return "";
}

int allocate(const AllocateOptions& options) {
  process::Problems problems;
  const auto board = options.board.load(problems);
  const auto calibration = options.board.load_calibration(board ? &*board : nullptr, problems);
  if (const auto problem = board ? explore::bank_names_problem(*board) : std::nullopt)
    problems.add(fmt::format("{}: {}", options.board.name(), *problem));
  if (board && *options.banks > static_cast<int>(board->banks.size())) {
    problems.add(
        fmt::format("--banks = {}: must be 1..{}, the banks of the board; --set 'ssram.banks.NEW={{}}' "
                    "gives it one more",
                    *options.banks, board->banks.size()));
  }
  problems.check();
  explore::SweepOptions sweep;
  sweep.store = options.out.text;
  sweep.version = process::kVersion;
  sweep.jobs = std::max(1U, std::thread::hardware_concurrency());
  const platform::Tables tables = runs::tables_of(*board, calibration);
  const explore::PointRun run = {options.camera, 0, calibration ? runs::sha256_of(calibration->tables) : ""};
  const std::uint64_t frames = explore::frames_of(run, *board);
  const platform::FrameAccesses accesses = platform::frame_accesses(*board, tables);
  const platform::FrameBegin first = {0, options.camera ? runs::first_start_s(*board, tables) : 0};
  const auto rate_from = [&](const BoardConfig& one, const platform::FrameBegin& begin) {
    return static_cast<double>(frames) / platform::least_delivery_s(one, accesses, frames, begin);
  };
  const AllocationSearch::BoundOf bound = [&](const BoardConfig& one) {
    return options.camera ? rate_from(one, first) : platform::core_bound(one, accesses, frames).core;
  };
  AllocationSearch search = search_of(*board, *options.banks, run, bound);
  if (search.fitting() == 0) {
    process::refuse(fmt::format("--banks = {}: none of {} allocations fits into so few banks{}",
                                *options.banks, search.placements(),
                                fewest_text(*board, *options.banks, run)));
  }
  std::vector<std::string> names;
  for (const platform::BankConfig& bank : board->banks) names.push_back(bank.name);
  try {
    const explore::StoreLock lock(sweep.store);
    explore::Store(sweep.store, sweep.version).check_banks(names);
  } catch (const explore::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  }
  process::catch_interrupts();
  runs::PointSimulator simulator = calibration ? runs::PointSimulator(tables) : runs::PointSimulator();
  const auto evaluate = [&](const explore::Point& point) {
    const double rate = search.rate_to_reach(point.number);
    return simulator(point,
                     [&](const platform::FrameBegin& last) { return rate_from(*point.board, last) < rate; });
  };
  runs::ProgressLine progress;
  const auto keep_going = [&progress](std::uint64_t done, std::uint64_t left) {
    progress.show([&](double) { return fmt::format("{} boards simulated, {} left at most", done, left); });
    return !process::interrupted();
  };
  const bool is_whole = explore::simulate(search, evaluate, sweep, keep_going);
  progress.erase();
  if (!is_whole) {
    process::say("note", kInterruptedNote);
    return kInterrupted;
  }
  const Context context = {search, *board, bound};
  const std::vector<BestPlacement> all = search.best();
  const std::string pixels = check_pixels(context, tables, all);
  if (process::interrupted()) {
    process::say("note", kInterruptedNote);
    return kInterrupted;
  }
  process::print(space_text(context, *options.banks) + table(context, all) +
                 certificate(all, options.keep_percent) + not_counted_text(context, all, sweep.store) +
                 pixels);
  return kDone;
}

}  // namespace

void add_allocate(CLI::App& program, Action& action) {
  add_command(
      program, action, "allocate", "Find the best allocation of the buffers to banks, and prove it", allocate,
      "Every different way to place the buffers in at most N banks is tried: placements that differ only\n"
      "by an exchange of banks that are alike count as one, and those whose bound is below the best rate\n"
      "of as many banks are not simulated, or not to the end. For each number of banks: how many\n"
      "placements fit, the best frame rate beside its bound, how many reach it, and one that does. An\n"
      "allocation with which captures lose pixels does not count. DB is continued: after an interruption,\n"
      "give the same command.");
}

}  // namespace stereotlm::cli
