#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/bounds.h"
#include "sw/cli/allocation_report.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/cli/searching.h"
#include "sw/explore/optimise/search.h"
#include "sw/explore/optimise/search_store.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/store/store.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/board_model.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/open_source.h"

namespace stereotlm::cli {
namespace {

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
                      "The database of the search and its certificate, written or continued (default: none)");
  Option write = Option(this, "--write", "F.yaml", "Write the board with the best allocation as a board file",
                        {ends_in(".yaml")});
  JsonOption json{this};

  int most_banks() const { return banks.number<int>().value_or(0); }
};

// Simulates the best allocation for each number of banks, with pixels: an ideal host supplies a different
// pair for each frame. Throws if two allocations compute different disparities. For the core alone, also
// throws if an allocation needs another number of cycles than the search has found. Returns nullopt if there
// are no allocations, and after an interrupt.
std::optional<ComparedPixels> compare_pixels(const AllocationReport& report, const platform::Tables& tables) {
  runs::ProgressLine line("the best allocations are simulated with pixels");
  process::Problems none;
  runs::InputPictures scene;
  scene.synthetic = 1;
  const auto pairs = runs::open_source(scene, &report.board, none).pairs;  // a different pair for each frame
  const std::uint64_t turn = platform::allocation_period_frames(report.board);
  ComparedPixels compared = {0, report.run.camera ? turn : report.run.frames};
  std::string first;
  const BoardConfig* first_board = nullptr;
  for (const BestAllocations& best : report.all) {
    if (best.ties.empty()) continue;
    line.show(compared.allocations, report.all.size(), [](double) { return "pixels are compared"; });
    const auto& [count, board, rate, possible] = best.ties.front();
    const auto run = runs::simulate_pixels(board, tables, *pairs, compared.frames);
    if (process::interrupted()) return std::nullopt;
    if (compared.allocations++ == 0) {
      first = run.disparities_sha256;
      first_board = &board;
    }
    if (run.disparities_sha256 != first) {
      throw std::runtime_error(fmt::format("the disparities of {} differ from those of {}",
                                           allocation_text(board), allocation_text(*first_board)));
    }
    if (!report.run.camera && run.cycles != rate.cycles) {
      throw std::runtime_error(fmt::format("{}: {} cycles with pixels, {} found", allocation_text(board),
                                           run.cycles, rate.cycles));
    }
  }
  if (compared.allocations == 0) return std::nullopt;
  return compared;
}

// The placements of the board, by the number of banks that they use.
std::map<int, std::uint64_t> placements_of(const BoardConfig& board, int banks) {
  std::map<int, std::uint64_t> found;
  try {
    const explore::Placements all(board, banks, 1);
    std::vector<int> banks_of_use;
    for (std::uint32_t use = 0; use < all.uses(); ++use) {
      const std::vector<bool> used = platform::used_banks(all.placed(board, all.first_of_use(use)));
      banks_of_use.push_back(static_cast<int>(std::count(used.begin(), used.end(), true)));
    }
    for (std::size_t number = 0; number < all.size(); ++number) ++found[banks_of_use[all.use(number)]];
  } catch (const std::length_error& error) {
    process::refuse(
        fmt::format("--banks = {}: {}; give fewer, or a board with fewer buffers or more banks alike", banks,
                    error.what()));
  }
  return found;
}

// "; with N some do": N is the least number of banks above `banks` with which an allocation fits; empty if
// there is none.
std::string fewest_text(const BoardConfig& board, int banks) {
  const auto most = static_cast<int>(board.banks.size());
  while (++banks <= most) {
    if (!placements_of(board, banks).empty()) return fmt::format("; with {} some do", banks);
  }
  return "";
}

// The best allocations that a search has found.
void take_best(explore::Search& search, AllocationReport& report) {
  for (const explore::FrontPoint& point : search.front()) {
    const explore::Search::Board first = search.board(point.first.front());
    const std::map<std::string, double> figures = search.results_of(point.first.front());
    RatedAllocations rated = {point.boards, *first.board, {}, point.values[0]};
    const auto exact = figures.find("frames_per_second.exact");  // 0: not proven
    if (exact != figures.end() && exact->second > 0) {
      rated.rate = {exact->second, 0, true, 0};
    } else if (report.run.camera) {
      rated.rate = {figures.at("frames_per_second.steady"),
                    figures.at("frames_per_second.steady_uncertainty"), false, 0};
    } else {
      const auto latency = static_cast<std::uint64_t>(report.board.fpga.pipeline_latency_cycles);
      rated.rate = {figures.at("frames_per_second.core"), 0, true,
                    static_cast<std::uint64_t>(figures.at("cycles")) + report.run.frames * latency};
    }
    const auto best = std::find_if(report.all.begin(), report.all.end(), [&](const BestAllocations& one) {
      return one.banks == static_cast<int>(point.values[1].least);
    });
    best->ties.push_back(std::move(rated));
  }
  for (BestAllocations& best : report.all)
    std::stable_sort(best.ties.begin(), best.ties.end(),
                     [](const RatedAllocations& a, const RatedAllocations& b) {
                       return a.rate.frames_per_second > b.rate.frames_per_second;
                     });
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
  if (options.most_banks() > static_cast<int>(board.banks.size())) {
    problems.add(most_banks_text(options.most_banks(), board.banks.size()));
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
  loaded.say_clock_remark();
  const platform::Tables tables = loaded.tables();
  const int banks = options.most_banks();
  AllocationReport report = {*board,
                             {options.source.is_camera(), frames_of(options, *board), ""},
                             banks,
                             options.keep.number<double>().value_or(kDefaultKeepPercent),
                             options.board.words_without_allocation()};
  for (const auto& [used, count] : placements_of(*board, banks)) report.all.push_back({used, count});
  if (report.all.empty())
    process::refuse(fmt::format("--banks = {}: no allocation fits into so few banks{}", banks,
                                fewest_text(*board, banks)));
  // Allocations with as many banks are compared: one has neither more nor fewer.
  const std::string rate = report.run.camera ? "frames_per_second.steady" : "frames_per_second.core";
  const std::string text = fmt::format(
      "run: {{source: {}, frames: {}}}\nplacements: {{banks: {}}}\n"
      "maximise: [{}, banks_used]\nminimise: banks_used\n",
      report.run.camera ? "camera" : "preloaded", report.run.frames, banks, rate);
  const std::string file = platform::to_yaml(*board);
  explore::Plan plan = explore::Plan::load("allocate", "board.yaml", &text, &file);
  std::string tables_hash;
  if (loaded.calibration) {
    tables_hash = runs::sha256_of(loaded.calibration->tables);
    plan.use_calibration(tables_hash, board->image.width, board->image.height, std::nullopt);
  }
  const explore::BoardModel model =
      runs::board_model(loaded.calibration ? &loaded.calibration->tables : nullptr);
  explore::Search search(plan, plan.wishes(), model, std::max(1U, std::thread::hardware_concurrency()));
  std::optional<explore::SearchStore> store;
  process::attempt_or_refuse("--out ", [&] {
    if (!options.out.is_given()) return;
    store.emplace(
        options.out.text(),
        explore::SearchStore::Asked{
            {"version", process::kVersion}, {"plan", text}, {"board", file}, {"tables", tables_hash}});
  });
  process::catch_interrupts();
  if (store && store->is_finished()) {
    search.set_front(store->front(plan.wishes().goals.size()));
    report.is_whole = true;
  } else {
    report.is_whole = run_search(search, store ? &*store : nullptr, true);
    if (!report.is_whole) report.open_bound = search.state().bound;
    if (store && report.is_whole) store->finish(search);
  }
  report.simulated = search.state().simulated;
  take_best(search, report);
  const platform::FrameAccesses accesses = platform::frame_accesses(*board, tables);
  for (BestAllocations& best : report.all) {
    if (best.ties.empty()) continue;
    const BoardConfig& one = best.ties.front().first;
    best.bound =
        report.run.camera ? platform::steady_bound(one, accesses) : platform::core_bound(one, accesses).core;
  }
  const std::optional<BestOfAll> top = report.best();
  if (report.is_whole) report.pixels = compare_pixels(report, tables);
  if (written && top) {
    written->write(platform::to_yaml(top->fastest->first));
    written->commit();
    report.written = options.write.text();
  }
  process::print(options.json.is_given() ? json_text(allocation_report_document(report))
                                         : allocation_report_text(report));
  if (!process::interrupted()) return kDone;
  return interrupted(resume_text(store.has_value()));
}

}  // namespace

void add_allocate(Commands& commands) {
  add_command(
      commands, "allocate", "Find the best allocation of the buffers to banks, and prove it", allocate,
      "Every different way to place the buffers in at most N banks is tried; all other keys stay.\n"
      "Placements that differ only by an exchange of banks that are alike count as one, and those whose\n"
      "bound shows that another of as many banks is faster are not simulated. For each number of banks:\n"
      "how many placements fit, the best frame rate beside its bound, how many tie, and one of them.\n"
      "Placements tie if the uncertainty of their rates leaves open which is faster. An allocation with\n"
      "which captures lose pixels does not count. Last the command that runs the best allocation: the\n"
      "fastest of those with the fewest banks that tie. It is a case of optimise, which also varies keys.\n"
      "Ctrl-C ends the search: the best so far is printed, and written by --write, with the most that\n"
      "another allocation can be better. DB is continued: the same command resumes. Without --out\n"
      "nothing is kept.\n"
      "--write replaces an earlier file only if it is the same board with another allocation.");
}

}  // namespace stereotlm::cli
