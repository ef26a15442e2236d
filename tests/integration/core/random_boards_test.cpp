#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <numeric>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "models/memory/arbitration_policies.h"
#include "platform/config/board_yaml.h"
#include "platform/figures/bounds.h"
#include "platform/loop/core_loop.h"
#include "platform/records/conflicts.h"
#include "sw/stats/record_csv.h"
#include "tests/integration/core/preloaded_run.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/plain_conflicts.h"
#include "tests/support/random_board.h"

// Whole runs on random boards, each in its own process, against the plain cycle loop and literal arithmetic.
namespace stereotlm::test {
namespace {

using fpga::Fidelity;

constexpr std::uint64_t kMaxFrameCycles = 20'000'000;
const std::string kHang = "the plain cycle loop hangs";

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::stoull(text) : otherwise;
}

int processors() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

PreloadedRun run_board(const RandomBoard& board, const platform::BoardConfig& config,
                       Fidelity fidelity = Fidelity::kCycle, bool with_rows = false,
                       platform::Conflicts* conflicts = nullptr) {
  std::vector<host::StereoPair> pairs;
  for (std::size_t pair = 0; pair < board.pictures.size(); ++pair)
    pairs.push_back(stereo_pair(board, static_cast<int>(pair)));
  return run_preloaded(config, board_tables(board), pairs, static_cast<std::uint64_t>(board.frames), fidelity,
                       with_rows, conflicts);
}

std::string pixel_differences(const kernels::GrayImage& image, const std::vector<std::uint8_t>& expected) {
  for (std::size_t index = 0; index < expected.size(); ++index) {
    if (image.pixels[index] == expected[index]) continue;
    const auto width = static_cast<std::size_t>(image.width);
    return "pixel (" + std::to_string(index % width) + ", " + std::to_string(index / width) +
           ") = " + std::to_string(image.pixels[index]) + ", expected " + std::to_string(expected[index]) +
           "\n";
  }
  return {};
}

std::string energy_differences(const RandomBoard& board, const PlainCycleResult& expected,
                               const platform::Statistics& found) {
  const PlainTime time_ps = PlainClock(board.clock_mhz).edge(expected.counted_cycles);
  return differing_lines(plain_energy(cycle_input(board), expected, expected.counted_work, time_ps),
                         energy_text(found));
}

// What differs between the model and the references; kHang if there is nothing to compare with.
std::string compare_with_references(const RandomBoard& board, Fidelity fidelity) {
  const PlainCycleResult expected = run_plain_cycle_loop(cycle_input(board), board.frames, kMaxFrameCycles);
  if (expected.hang) return kHang;
  const PreloadedRun run = run_board(board, board_config(board), fidelity);
  std::string text = differences(figures(run.statistics), figures(expected)) +
                     energy_differences(board, expected, run.statistics);
  for (const std::string& failed : run.statistics.failed) text += failed + "\n";
  EXPECT_EQ(run.disparity.size(), static_cast<std::size_t>(board.frames));
  for (std::size_t frame = 0; fidelity != Fidelity::kTiming && frame < run.disparity.size(); ++frame) {
    const auto reference = compute_reference(reference_input(board, static_cast<int>(frame)));
    const std::string wrong = pixel_differences(run.disparity[frame], reference.disparity);
    if (!wrong.empty()) text += "frame " + std::to_string(frame) + ": " + wrong;
  }
  return text;
}

// A line for each row, of the ports that the models record.
template <typename Rows>
std::string text_of_rows(const std::vector<Rows>& frames, std::size_t ports) {
  std::string text;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    for (std::size_t row = 0; row < frames[frame].size(); ++row) {
      const auto& end = frames[frame][row];
      text += "frame " + std::to_string(frame) + ", row " + std::to_string(row) + ": " +
              std::to_string(end.cycles) + "; stalls";
      for (std::size_t port = 0; port < ports; ++port) text += ' ' + std::to_string(end.stalls[port]);
      text += '\n';
    }
  }
  return text;
}

// What differs in figures and rows, with rows recorded.
std::string compare_rows_with_references(const RandomBoard& board, Fidelity fidelity) {
  const PlainCycleResult expected = run_plain_cycle_loop(cycle_input(board), board.frames, kMaxFrameCycles);
  if (expected.hang) return kHang;
  const PreloadedRun run = run_board(board, board_config(board), fidelity, true);
  EXPECT_EQ(run.rows.size(), static_cast<std::size_t>(board.frames));
  EXPECT_EQ(run.rows.front().size(), static_cast<std::size_t>(board.height));
  const std::size_t ports = fpga::CorePorts(board.lanes).core_size();
  EXPECT_EQ(text_of_rows(run.rows, ports), text_of_rows(expected.rows, ports));
  return differences(figures(run.statistics), figures(expected));
}

// What differs in rows.csv and conflicts.csv. Every fourth board has larger tiles.
std::string compare_conflicts_with_references(const RandomBoard& board, Fidelity fidelity) {
  const PlainCycleInput input = cycle_input(board);
  const PlainCycleResult expected = run_plain_cycle_loop(input, board.frames, kMaxFrameCycles);
  if (expected.hang) return kHang;
  const platform::BoardConfig config = board_config(board);
  const std::size_t most_tiles =
      board.seed % 4 == 0 ? 1 + board.seed % 50 : fpga::ConflictRecorder::kMostTiles;
  platform::Conflicts conflicts(config, most_tiles);
  const PreloadedRun run = run_board(board, config, fidelity, false, &conflicts);
  std::string rows = stats::rows_csv_head(config);
  std::uint64_t frames = 0;
  for (const fpga::FrameConflicts& frame : conflicts.take_frames())
    rows += stats::rows_csv(config, frames++, frame);
  const fpga::TileGrid& grid = conflicts.recorder().grid();
  EXPECT_LE(grid.columns * grid.rows, most_tiles);
  std::string text = differing_lines(plain_rows_csv(input, expected.strips), rows);
  text +=
      differing_lines(plain_conflicts_csv(input, expected.tiles, grid.strips_of_tile, grid.groups_of_tile),
                      stats::conflicts_csv(config, conflicts.recorder()));
  for (const std::string& failed : conflicts.failed(run.statistics)) text += failed + "\n";
  return text;
}

// What differs between the core's timing in a loop and the plain cycle loop.
std::string compare_core_run_with_references(const RandomBoard& board, Fidelity /*its own*/) {
  const PlainCycleResult expected = run_plain_cycle_loop(cycle_input(board), board.frames, kMaxFrameCycles);
  if (expected.hang) return kHang;
  const auto frames = static_cast<std::uint64_t>(board.frames);
  const platform::Statistics found = platform::run_core(board_config(board), board_tables(board), frames);
  std::string text =
      differences(figures(found), figures(expected)) + energy_differences(board, expected, found);
  for (const std::string& failed : found.failed) text += failed + "\n";
  EXPECT_EQ(found.fidelity, "fast");
  return text;
}

// Rates of the core that are above the bound of their frames, and bounds that are of other frames.
std::string rates_above_bounds(const RandomBoard& board, Fidelity /*its own*/) {
  std::string text;
  const platform::BoardConfig config = board_config(board);
  const platform::Tables tables = board_tables(board);
  const platform::FrameAccesses accesses = platform::frame_accesses(config, tables);
  // Frames of tall boards are long, and the loop simulates each of them several times.
  const std::uint64_t most_frames = board.width * board.height > 4000 ? 2 : 6;
  double cycles = 0;
  for (std::uint64_t frames = 1; frames <= most_frames; ++frames) {
    std::uint64_t most = 0;
    for (const auto& each : frame_bounds(config, accesses, frames - 1)) most = std::max(most, each.cycles);
    cycles += static_cast<double>(most);
    const platform::Statistics found = platform::run_core(config, tables, frames);
    const double bound = config.fpga.clock_mhz * 1e6 * static_cast<double>(frames) / cycles;
    if (found.frames_per_second.core > found.bound.core || found.bound.core != bound)
      text += std::to_string(frames) + " frames: above the bound, or another bound\n";
  }
  return text;
}

using Comparison = std::string (*)(const RandomBoard& board, Fidelity fidelity);

// Boards without the knobs of contract section 7, or with the knobs that the models have.
class RandomBoards : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Drawn, RandomBoards, testing::Bool(),
                         [](const auto& suite) { return suite.param ? "WithKnobs" : "WithoutKnobs"; });

RandomBoard board_of(std::uint64_t seed, bool with_knobs) {
  return make_random_board(seed, with_knobs ? RandomKnobs::with_section_8() : RandomKnobs{});
}

// Of boards that once showed an error which the first boards do not show: results in sdram that begin more
// than a strip behind the slots, or whose last strip begins another turn of the internal banks.
constexpr std::array<std::uint64_t, 4> kSeedsOfErrors = {5562, 7500, 16441, 17138};

void expect_boards_equal_references(Fidelity fidelity, bool with_knobs, std::uint64_t boards,
                                    Comparison compare = compare_with_references) {
  const std::uint64_t first = from_environment("STEREOTLM_RANDOM_FIRST", 0);
  const std::uint64_t count = random_boards(boards);
  std::vector<std::uint64_t> seeds(count);
  std::iota(seeds.begin(), seeds.end(), first);
  seeds.insert(seeds.end(), kSeedsOfErrors.begin(), kSeedsOfErrors.end());
  std::vector<ChildWork> jobs;
  for (const std::uint64_t seed : seeds)
    jobs.push_back([=] { return compare(board_of(seed, with_knobs), fidelity); });
  const std::vector<ChildResult> results = run_in_children(jobs, processors(), std::chrono::seconds(200));
  std::uint64_t hangs = 0;
  for (std::size_t job = 0; job < results.size(); ++job) {
    if (results[job].text == kHang) {
      ++hangs;
    } else if (!results[job].ok()) {
      const RandomBoard board = board_of(seeds[job], with_knobs);
      ADD_FAILURE() << results[job].text << "\n"
                    << describe(board) << "\n"
                    << platform::to_yaml(board_config(board));
    }
  }
  testing::Test::RecordProperty("hangs", std::to_string(hangs));
  EXPECT_EQ(hangs, 0U);
}

TEST_P(RandomBoards, EqualThePlainCycleLoopAndTheLiteralArithmetic) {
  expect_boards_equal_references(Fidelity::kCycle, GetParam(), 300);
}

TEST_P(RandomBoards, EqualThePlainCycleLoopAndTheLiteralArithmeticAtFastFidelity) {
  expect_boards_equal_references(Fidelity::kFast, GetParam(), 1000);
}

TEST_P(RandomBoards, EqualThePlainCycleLoopWithoutPixels) {
  expect_boards_equal_references(Fidelity::kTiming, GetParam(), 300);
}

TEST_P(RandomBoards, EqualThePlainCycleLoopInALoopOfTheirOwn) {
  expect_boards_equal_references(Fidelity::kTiming, GetParam(), 1000, compare_core_run_with_references);
}

TEST_P(RandomBoards, AreNeverFasterThanTheBoundOfTheirFrames) {
  expect_boards_equal_references(Fidelity::kTiming, GetParam(), 50, rates_above_bounds);
}

TEST_P(RandomBoards, HaveTheRowsOfThePlainCycleLoop) {
  expect_boards_equal_references(Fidelity::kCycle, GetParam(), 100, compare_rows_with_references);
}

TEST_P(RandomBoards, HaveTheRowsOfThePlainCycleLoopAtFastFidelity) {
  expect_boards_equal_references(Fidelity::kTiming, GetParam(), 500, compare_rows_with_references);
}

TEST_P(RandomBoards, HaveTheConflictsOfThePlainCycleLoop) {
  expect_boards_equal_references(Fidelity::kCycle, GetParam(), 100, compare_conflicts_with_references);
}

TEST_P(RandomBoards, HaveTheConflictsOfThePlainCycleLoopAtFastFidelity) {
  expect_boards_equal_references(Fidelity::kTiming, GetParam(), 500, compare_conflicts_with_references);
}

std::string text_of(const std::vector<kernels::GrayImage>& disparities) {
  std::string text;
  for (const kernels::GrayImage& image : disparities) {
    for (const std::uint8_t pixel : image.pixels) text += std::to_string(pixel) + ' ';
    text += '\n';
  }
  return text;
}

// All buffers in one bank, a bank for each, and the board's own sharing.
std::vector<platform::BoardConfig> allocations_of(const RandomBoard& board) {
  RandomBoard one_bank = board;
  one_bank.banks = {PlainBank{PlainBankKind::kSyncBurst, 3}};
  for (auto* list : {&one_bank.left_image, &one_bank.right_image, &one_bank.disparity})
    std::fill(list->begin(), list->end(), 0);
  RandomBoard spread = board;
  int next = 0;
  for (auto* list : {&spread.left_image, &spread.right_image, &spread.disparity}) {
    for (PlainBuffer& buffer : *list) buffer = next++;
  }
  for (auto* lut : {&spread.left_lut, &spread.right_lut}) {
    if (*lut) *lut = next++;
  }
  if (spread.joint_tables) spread.right_lut = spread.left_lut;
  spread.banks.assign(static_cast<std::size_t>(next), PlainBank{PlainBankKind::kZbtFlowThrough, 0});
  for (auto* lut : {&one_bank.left_lut, &one_bank.right_lut}) {
    if (*lut) *lut = 0;
  }
  return {board_config(board), board_config(one_bank), board_config(spread)};
}

TEST_P(RandomBoards, GiveTheSameDisparityImageWithAnyAllocation) {
  for (std::uint64_t seed = 20'000; seed < 20'010; ++seed) {
    const RandomBoard board = board_of(seed, GetParam());
    SCOPED_TRACE(describe(board));
    std::vector<std::string> images;
    for (const platform::BoardConfig& config : allocations_of(board))
      images.push_back(run_for_text([&] { return text_of(run_board(board, config).disparity); }));
    EXPECT_EQ(images[0], images[1]);
    EXPECT_EQ(images[0], images[2]);
  }
}

TEST_P(RandomBoards, HaveEveryArbitrationPolicy) {
  std::set<std::string> drawn;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    drawn.insert(board_config(board_of(seed, GetParam())).fpga.arbiter.policy);
  for (const memory::ArbitrationPolicy& policy : memory::arbitration_policies())
    EXPECT_EQ(drawn.count(policy.name), 1U)
        << policy.name << ": not in the plain cycle loop, with which each "
        << "policy is compared: models/INSIDE.md says how to add it there";
}

TEST_P(RandomBoards, AreValid) {
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    const RandomBoard board = board_of(seed, GetParam());
    ASSERT_EQ(platform::problems(board_config(board)), std::vector<std::string>()) << describe(board);
    ASSERT_NO_THROW(platform::check_tables(board_config(board), board_tables(board))) << describe(board);
  }
}

}  // namespace
}  // namespace stereotlm::test
