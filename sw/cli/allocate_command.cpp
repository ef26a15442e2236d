#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "platform/board_rules.h"
#include "platform/bounds.h"
#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/interrupt.h"
#include "sw/cli/progress.h"
#include "sw/cli/streams.h"
#include "sw/cli/typed_option.h"
#include "sw/cli/unbuilt.h"
#include "sw/cli/version.h"
#include "sw/explore/allocation_search.h"
#include "sw/explore/store.h"
#include "sw/explore/sweep.h"
#include "sw/media/synthetic_scene.h"
#include "sw/report/sha256.h"
#include "sw/simulation/simulate_point.h"

namespace stereotlm::cli {
namespace {

using explore::AllocationSearch;
using explore::BestPlacement;
using explore::Placement;
using platform::BoardConfig;

constexpr double kDefaultKeepPercent = 99;

struct AllocateOptions {
  BoardOptions board;
  Typed banks_option;
  Typed source;
  Typed keep_option;
  Typed out;

  // As check_usage() leaves them.
  std::optional<int> banks;
  double keep_percent = kDefaultKeepPercent;

  void add_to(CLI::App& command) {
    board.add_to(command);
    banks_option.add_to(command, "--banks", "N", "Banks to use at most: 1 to those of the board");
    source.add_to(command, "--source", "preloaded", "The core alone");
    keep_option.add_to(command, "--keep-fps", "PERCENT",
                       "Say how few banks keep so much of the best frame rate (default 99)");
    out.add_to(command, "--out", "DB", "The database of the boards that are simulated, written or continued");
  }

  void check_usage() {
    Problems problems;
    if (!source.is_given()) {
      problems.add(std::string("--source camera, the default: ") + kNotInThisVersion + "; built: preloaded");
    } else if (is_one_of({"camera", "preloaded"}, "--source", source.text, problems) &&
               source.text == "camera") {
      problems.add(std::string("--source camera: ") + kNotInThisVersion + "; built: preloaded");
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

// Another pair for each frame.
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

std::string sha_of(const platform::Tables& tables) {
  std::string bytes;
  for (const auto& table : {tables.left, tables.right}) {
    if (table) bytes.append(reinterpret_cast<const char*>(table->entries.data()), table->entries.size() * 4);
    bytes += '|';
  }
  return report::sha256_hex(bytes.data(), bytes.size());
}

// "left_image bank0 bank1, .., right_lut bank0"
std::string text_of(const BoardConfig& board, const Placement& placement) {
  std::string text;
  std::string last;
  const auto buffers = platform::buffers(board.allocation);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string name = buffers[i].key.substr(buffers[i].key.find('.') + 1);
    if (name != last) text += (text.empty() ? "" : ", ") + name;
    text += ' ' + board.banks[static_cast<std::size_t>(placement[i])].name;
    last = name;
  }
  return text;
}

// Cycles of each point's run, from the database.
std::vector<std::uint64_t> cycles_of(const AllocationSearch& search, const std::string& path) {
  explore::Database store(path, explore::Database::Access::kRead);
  explore::Statement find(store, "SELECT status, reason, cycles FROM points WHERE hash = ?");
  std::vector<std::uint64_t> cycles;
  for (std::uint64_t number = 0; number < search.size(); ++number) {
    find.bind(1, search.point(number).hash);
    if (!find.step() || find.text(0) != "ok") {
      throw std::runtime_error(
          fmt::format("{}: an allocation could not be simulated: {}", path, find.text(1)));
    }
    cycles.push_back(static_cast<std::uint64_t>(find.integer(2)));
    find.reset();
  }
  return cycles;
}

std::string table(const AllocationSearch& search, const BoardConfig& board,
                  const std::vector<BestPlacement>& all) {
  std::string text = fmt::format("{:>5} {:>12} {:>14} {:>14} {:>10}  {}\n", "banks", "allocations",
                                 "best frames/s", "bound", "reached by", "one of them");
  for (const BestPlacement& best : all) {
    const BoardConfig one = explore::placed(board, best.witness);
    const auto bound = platform::core_bound(one, platform::identity_tables(one), search.turn_frames());
    text += fmt::format("{:>5} {:>12} {:>14.3f} {:>14.3f} {:>10}  {}\n", best.banks, best.placements,
                        best.frames_per_second, bound.core, best.reached_by, text_of(board, best.witness));
  }
  return text;
}

// Runs the best of each number of banks with pixels: all have to give the same disparities, and the cycles
// that were found.
void check_pixels(const AllocationSearch& search, const BoardConfig& board, const platform::Tables& tables,
                  const std::vector<BestPlacement>& all) {
  ScenePairs pairs(board);
  std::string first;
  for (const BestPlacement& best : all) {
    const auto run = simulation::simulate_pixels(explore::placed(board, best.witness), tables, pairs,
                                                 search.turn_frames());
    if (first.empty()) first = run.disparities_sha256;
    if (run.disparities_sha256 != first) {
      throw std::runtime_error(fmt::format("the disparities of {} differ from those of {}",
                                           text_of(board, best.witness),
                                           text_of(board, all.front().witness)));
    }
    if (run.cycles != best.cycles) {
      throw std::runtime_error(fmt::format("{}: {} cycles with pixels, {} found",
                                           text_of(board, best.witness), run.cycles, best.cycles));
    }
  }
}

// What has been shown.
std::string certificate(const std::vector<BestPlacement>& all, double keep_percent) {
  const auto rate = [](const BestPlacement& best) { return best.frames_per_second; };
  const auto top = std::max_element(all.begin(), all.end(),
                                    [&](const auto& a, const auto& b) { return rate(a) < rate(b); });
  std::string text =
      fmt::format("The best of all is {:.3f} frames/s, and needs {} banks", rate(*top), top->banks);
  if (top != all.begin()) {
    const auto below =
        std::max_element(all.begin(), top, [&](const auto& a, const auto& b) { return rate(a) < rate(b); });
    text +=
        fmt::format(": every allocation to fewer was tried, and the best of them gives {:.3f}", rate(*below));
  } else {
    text += ", the fewest that hold the buffers";
  }
  text += ".\n";
  const auto kept = std::find_if(all.begin(), all.end(), [&](const BestPlacement& best) {
    return rate(best) >= rate(*top) * keep_percent / 100;
  });
  return text +
         fmt::format("{:g} % of it is kept with {} banks ({:.3f} frames/s, {:.2f} %), and not with fewer.\n",
                     keep_percent, kept->banks, rate(*kept), 100 * rate(*kept) / rate(*top));
}

std::string space_text(const AllocationSearch& search, const BoardConfig& board, int banks) {
  std::string text =
      fmt::format("{}: {} buffers in at most {} of {} banks: {} different allocations, {} of them fit\n",
                  board.name, platform::buffers(board.allocation).size(), banks, board.banks.size(),
                  search.placements(), search.fitting());
  if (search.by_frames()) {
    text += fmt::format(
        "{} boards of one frame are all that has to be simulated: with fixed priority and without turnaround "
        "a "
        "frame\nleaves nothing behind, so that its cycles depend on which of its own buffers share a bank, "
        "and on "
        "nothing else\n",
        search.size());
  } else {
    text += fmt::format(
        "{} boards are simulated, one for each: a frame leaves arbiters or banks in another state\n",
        search.size());
  }
  return text;
}

int allocate(const AllocateOptions& options) {
  Problems problems;
  const auto board = options.board.load(problems);
  const auto calibration = options.board.load_calibration(board ? &*board : nullptr, problems);
  if (board && *options.banks > static_cast<int>(board->banks.size())) {
    problems.add(fmt::format("--banks = {}: must be 1..{}, the banks of the board", *options.banks,
                             board->banks.size()));
  }
  problems.check();
  const AllocationSearch search(*board, *options.banks, calibration ? sha_of(calibration->tables) : "");
  if (search.fitting() == 0) {
    refuse(fmt::format("--banks = {}: none of {} allocations fits into so few banks", *options.banks,
                       search.placements()));
  }
  explore::SweepOptions sweep;
  sweep.store = options.out.text;
  sweep.version = kVersion;
  sweep.jobs = std::max(1U, std::thread::hardware_concurrency());
  try {
    const explore::Store store(sweep.store, sweep.version);
  } catch (const explore::DatabaseError& error) {
    refuse(fmt::format("--out {}", error.what()));
  }
  catch_interrupts();
  const platform::Tables tables = tables_of(*board, calibration);
  simulation::PointSimulator simulator =
      calibration ? simulation::PointSimulator(tables) : simulation::PointSimulator();
  ProgressLine progress;
  const auto counts = explore::sweep(
      search, [&simulator](const explore::Point& point) { return simulator(point); }, sweep,
      [&](const explore::SweepCounts& done) {
        progress.show([&](double) { return fmt::format("{}/{} boards", done.done(), done.total); });
        return !interrupted();
      });
  progress.erase();
  if (counts.done() < counts.total) {
    say("note", "interrupted: the same command goes on where this one has ended");
    return kInterrupted;
  }
  const std::vector<BestPlacement> all = search.best(cycles_of(search, sweep.store));
  check_pixels(search, *board, tables, all);
  print(space_text(search, *board, *options.banks) + table(search, *board, all) +
        certificate(all, options.keep_percent) +
        fmt::format("The disparities of these {} allocations are the same, pixel by pixel, in {} frames.\n",
                    all.size(), search.turn_frames()));
  return kDone;
}

}  // namespace

void add_allocate(CLI::App& program, Action& action) {
  const auto options = std::make_shared<AllocateOptions>();
  const auto parsed = [options, &action] {
    options->check_usage();
    action = [options] { return allocate(*options); };
  };
  options->add_to(add_command(program, "allocate",
                              "Find the best allocation of the buffers to banks, and prove it", parsed,
                              "Every different way to place the buffers in at most N banks is tried: "
                              "placements that differ only by an\n"
                              "exchange of banks that are alike count as one. For each number of banks: how "
                              "many placements fit, the\n"
                              "best frame rate of the core over a turn of the allocation's lists beside its "
                              "bound, how many reach it,\n"
                              "and one that does."));
}

}  // namespace stereotlm::cli
