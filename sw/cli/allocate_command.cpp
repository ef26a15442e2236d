#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/bounds.h"
#include "sw/cli/allocation_report.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/explore/search/allocation_search.h"
#include "sw/explore/store/store.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/aside.h"
#include "sw/files/whole_file.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/open_source.h"

namespace stereotlm::cli {
namespace {

using explore::AllocationSearch;
using explore::BestPlacement;
using explore::Placement;
using platform::BoardConfig;

constexpr double kDefaultKeepPercent = 99;

struct AllocateOptions : Options {
  using Options::Options;

  BoardOptions board{this};
  Option banks = Option(
      this, "--banks", "N", "Banks to use at most: 1 to those of the board",
      {required("the most banks to use"), number<int>("1 or more", [](int most) { return most > 0; })});
  SourceOption source{this};
  Option frames = Option(this, "--frames", "N",
                         "Frames of a run, whole turns of the lists of buffers: more frames make the steady "
                         "rate more certain (default one turn; with cameras 120 more)",
                         {number<std::int64_t>(explore::kFramesRule.text(), [](std::int64_t count) {
                           return explore::kFramesRule.allows(count);
                         })});
  Option keep = Option(this, "--keep-fps", "PERCENT",
                       "Say how few banks keep so much of the best frame rate (default 99)",
                       {number<double>("a percentage above 0 and at most 100",
                                       [](double percent) { return percent > 0 && percent <= 100; })});
  Option out = Option(this, "--out", "DB",
                      "The database of the boards that are simulated, written or continued (default: none)");
  Option write = Option(this, "--write", "F.yaml", "Write the board with the best allocation as a board file",
                        {ends_in(".yaml")});
  JsonOption json{this};

  int most_banks() const { return banks.number<int>().value_or(0); }
};

// The placement as text: "left_image bank0 bank1, .., right_lut bank0".
std::string text_of(const BoardConfig& board, const Placement& placement) {
  return explore::allocation_text(explore::placed(board, placement));
}

// Simulates the best allocation for each number of banks, with pixels: an ideal host supplies a different
// pair for each frame. Throws if two allocations compute different disparities. For the core alone, also
// throws if an allocation needs another number of cycles than the search has found. Returns nullopt if there
// are no allocations, and after an interrupt.
std::optional<ComparedPixels> compare_pixels(const BoardConfig& board, const platform::Tables& tables,
                                             const explore::PointRun& search,
                                             const std::vector<BestPlacement>& all) {
  runs::ProgressLine line("the best allocations are simulated with pixels");
  process::Problems none;
  runs::InputPictures scene;
  scene.synthetic = 1;
  const auto pairs = runs::open_source(scene, &board, none).pairs;  // a different pair for each frame
  ComparedPixels compared = {
      0, search.camera ? platform::allocation_period_frames(board) : explore::frames_of(search, board)};
  std::string first;
  const Placement* first_witness = nullptr;
  for (const BestPlacement& best : all) {
    if (process::interrupted()) return std::nullopt;
    if (best.tied == 0) continue;
    line.show(compared.allocations, all.size(), [](double) { return "pixels are compared"; });
    const auto run =
        runs::simulate_pixels(explore::placed(board, best.witness), tables, *pairs, compared.frames);
    if (process::interrupted()) return std::nullopt;
    if (compared.allocations++ == 0) {
      first = run.disparities_sha256;
      first_witness = &best.witness;
    }
    if (run.disparities_sha256 != first) {
      throw std::runtime_error(fmt::format("the disparities of {} differ from those of {}",
                                           text_of(board, best.witness), text_of(board, *first_witness)));
    }
    if (!search.camera && run.cycles != best.outcome.cycles) {
      throw std::runtime_error(fmt::format("{}: {} cycles with pixels, {} found",
                                           text_of(board, best.witness), run.cycles, best.outcome.cycles));
    }
  }
  if (process::interrupted() || compared.allocations == 0) return std::nullopt;
  return compared;
}

// Comparing allocations may take long. An interrupt during that time ends the process.
AllocationSearch search_of(const BoardConfig& board, int banks, const explore::PointRun& run,
                           const AllocationSearch::BoundOf& bound) {
  runs::ProgressLine line(fmt::format("all allocations to at most {} banks are compared", banks));
  try {
    return AllocationSearch(board, banks, run, bound, [&line](std::uint64_t done, std::uint64_t of) {
      line.show(done, of, [=](double) { return fmt::format("{}/{} allocations", done, of); });
    });
  } catch (const std::length_error& error) {
    process::refuse(
        fmt::format("--banks = {}: {}; give fewer, or a board with fewer buffers or more banks alike", banks,
                    error.what()));
  }
}

// "; with N some do": N is the least number of banks above `banks` with which an allocation fits; empty if
// there is none.
std::string fewest_text(const BoardConfig& board, int banks, const explore::PointRun& run) {
  const auto most = static_cast<int>(board.banks.size());
  const auto no_bound = [](const BoardConfig&) { return 0.0; };
  while (++banks <= most) {
    if (search_of(board, banks, run, no_bound).fitting() > 0) return fmt::format("; with {} some do", banks);
  }
  return "";
}

// Whether the file is the board as --write writes it, with any allocation.
bool is_written_board(const std::filesystem::path& path, const BoardConfig& board) {
  try {
    BoardConfig earlier = platform::load_board(std::filesystem::absolute(path).string());
    if (platform::to_yaml(earlier) != files::read_whole_file(path)) return false;
    earlier.allocation = board.allocation;
    return platform::to_yaml(earlier) == platform::to_yaml(board);
  } catch (const std::runtime_error&) {
    return false;
  }
}

// The file of --write; null without --write, or if there are problems, which it reports. Replaces an earlier
// file only if --write has made it for the same board.
std::unique_ptr<files::OutputFile> open_written(const AllocateOptions& options, const BoardConfig& board,
                                                process::Problems& problems) {
  if (!options.write.is_given()) return nullptr;
  const files::FileKind kind = {
      "file of this board with another allocation",
      [&board](const std::filesystem::path& path) { return is_written_board(path, board); }};
  const std::vector<files::NamedFile> others = {{"BOARD", options.board.argument.text()},
                                                {"--out", options.out.text()}};
  std::unique_ptr<files::OutputFile> file;
  problems.attempt("--write ",
                   [&] { file = std::make_unique<files::OutputFile>(options.write.text(), kind, others); });
  return file;
}

std::uint64_t frames_of(const AllocateOptions& options, const BoardConfig& board) {
  return options.frames.number<std::uint64_t>().value_or(
      platform::allocation_period_frames(board) +
      (options.source.is_camera() ? explore::kSearchSteadyFrames : 0));
}

void check(const AllocateOptions& options, const BoardConfig& board, process::Problems& problems) {
  if (const auto problem = explore::bank_names_problem(board))
    problems.add(fmt::format("{}: {}", options.board.argument.text(), *problem));
  if (options.most_banks() > static_cast<int>(board.banks.size())) {
    problems.add(fmt::format(
        "--banks = {}: must be 1..{}, the banks of the board; --set 'ssram.banks.NEW={{}}' gives it one more",
        options.most_banks(), board.banks.size()));
  }
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    if (buffer.parts > 1 && buffer.part == 0) {
      problems.add(fmt::format("{}: {} = {{rows: ..}}: must be one bank here: allocate places no stripes",
                               options.board.argument.text(), platform::key_of(buffer.buffer)));
    }
  }
  const std::uint64_t turn = platform::allocation_period_frames(board);
  const std::uint64_t least = options.source.is_camera() ? 2 * turn : turn;
  const std::uint64_t frames = frames_of(options, board);
  if (frames % turn == 0 && frames >= least) return;
  problems.add(fmt::format("--frames = {}: must be a multiple of {}, one turn of the lists of buffers{}",
                           frames, turn, options.source.is_camera() ? ", and at least two turns" : ""));
}

int allocate(const AllocateOptions& options) {
  process::Problems problems;
  const LoadedBoard loaded = options.board.load(problems);
  const auto& board = loaded.board;
  if (board) check(options, *board, problems);
  auto written = board ? open_written(options, *board, problems) : nullptr;
  problems.check();
  const platform::Tables tables = loaded.tables();
  const bool camera = options.source.is_camera();
  const int banks = options.most_banks();
  const explore::PointRun run = {camera, frames_of(options, *board),
                                 loaded.calibration ? runs::sha256_of(loaded.calibration->tables) : ""};
  const platform::FrameAccesses accesses = platform::frame_accesses(*board, tables);
  const AllocationSearch::BoundOf bound = [&](const BoardConfig& one) {
    return camera ? platform::steady_bound(one, accesses) : platform::core_bound(one, accesses).core;
  };
  AllocationSearch search = search_of(*board, banks, run, bound);
  if (search.fitting() == 0) {
    process::refuse(fmt::format("--banks = {}: none of {} allocations fits into so few banks{}", banks,
                                search.placements(), fewest_text(*board, banks, run)));
  }
  process::catch_interrupts();
  std::vector<std::string> names;
  for (const platform::BankConfig& bank : board->banks) names.push_back(bank.name);
  std::optional<files::TemporaryFolder> unkept;  // of the database without --out
  explore::SweepOptions sweep;
  process::attempt_or_refuse("", [&] {
    if (!options.out.is_given()) unkept.emplace();
    sweep.store = unkept ? (unkept->path() / "boards.db").string() : options.out.text();
  });
  process::attempt_or_refuse("--out ", [&] {
    const explore::StoreLock lock(sweep.store);
    explore::Store(sweep.store, sweep.version).check_banks(names);
  });
  runs::PointSimulator simulator = loaded.simulator();
  const auto evaluate = [&](const explore::Point& point) {
    const double rate = search.rate_to_reach(point.number);
    return simulator(point, [rate](const platform::SteadyRate& so_far) {
      return so_far.frames >= explore::kSteadyFrames && so_far.frames_per_second + so_far.uncertainty < rate;
    });
  };
  runs::ProgressLine line(fmt::format("allocations are simulated, each for {} frames", run.frames),
                          runs::stepped_text(*board, tables, camera));
  AllocationReport report = {search,
                             *board,
                             bound,
                             options.out.text(),
                             banks,
                             options.keep.number<double>().value_or(kDefaultKeepPercent),
                             options.board.words_without_allocation()};
  report.is_whole = explore::simulate(search, evaluate, sweep, [&line](const explore::SearchProgress& done) {
    line.show(done.done, done.done + done.most_left,
              [&done](double seconds) { return runs::progress_text(done, seconds); });
    return !process::interrupted();
  });
  line.erase();
  report.all = search.best();
  report.best = search.best_of_all();
  if (report.is_whole) report.pixels = compare_pixels(*board, tables, run, report.all);
  if (written && report.best) {
    written->write(platform::to_yaml(explore::placed(*board, report.best->witness)));
    written->commit();
    report.written = options.write.text();
  }
  process::print(options.json.is_given() ? json_text(allocation_report_document(report))
                                         : allocation_report_text(report));
  if (!process::interrupted()) return kDone;
  return interrupted(unkept ? "nothing is kept: give --out DB to resume later"
                            : "run the same command to resume");
}

}  // namespace

void add_allocate(Commands& commands) {
  add_command(
      commands, "allocate", "Find the best allocation of the buffers to banks, and prove it", allocate,
      "Every different way to place the buffers in at most N banks is tried; all other keys stay.\n"
      "Placements that differ only by an exchange of banks that are alike count as one, and those that are\n"
      "known to be slower than another of as many banks are not simulated, or not to the end. For each\n"
      "number of banks: how many placements fit, the best frame rate beside its bound, how many tie, and\n"
      "one of them. Placements tie if the uncertainty of their rates leaves open which is faster. An\n"
      "allocation with which captures lose pixels does not count. Last the command that runs the best\n"
      "allocation: the fastest of those with the fewest banks that tie.\n"
      "Ctrl-C ends the search: the best so far is printed, and written by --write, with the most that\n"
      "another allocation can be better. DB is continued: the same command resumes. Without --out\n"
      "nothing is kept.\n"
      "--write replaces an earlier file only if it is the same board with another allocation.");
}

}  // namespace stereotlm::cli
