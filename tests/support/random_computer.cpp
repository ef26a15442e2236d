#include "tests/support/random_computer.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

namespace stereotlm::test {
namespace {

template <typename Value>
Value one_of(SplitMix64& random, const std::vector<Value>& values) {
  return values[static_cast<std::size_t>(random.between(0, static_cast<int>(values.size()) - 1))];
}

// A number of low..high with four decimals: clocks of such frequencies never come back into phase.
std::string odd_number(SplitMix64& random, int low, int high) {
  const std::string decimals = std::to_string(10'000 + random.between(0, 9999)).substr(1);
  return std::to_string(random.between(low, high - 1)) + '.' + decimals;
}

PlainNumber usual_or_odd(SplitMix64& random, const std::vector<std::string>& usual, int low, int high) {
  return plain_number(random.chance(70) ? one_of(random, usual) : odd_number(random, low, high));
}

std::vector<std::uint32_t> identity_table(const RandomBoard& board) {
  std::vector<std::uint32_t> entries;
  for (int row = 0; row < board.height; ++row) {
    for (int column = 0; column < board.width; ++column)
      entries.push_back(0x8000'0000U | static_cast<std::uint32_t>(row) << 16U |
                        static_cast<std::uint32_t>(column));
  }
  return entries;
}

// A smaller frame, so that more of them are compared, with identity tables, which make its accesses regular.
void make_regular_frame(RandomBoard& board, SplitMix64& random) {
  board.width = 4 * random.between(6, 16);
  board.height = random.between(12, 40);
  board.window = std::min(board.window, 9);
  board.lanes = std::min(board.lanes, board.window + board.rows - 1);
  for (auto* table : {&board.left_table, &board.right_table}) {
    if (*table) *table = identity_table(board);
  }
}

// Pictures are captured into banks that the frame of the pictures before them uses.
void draw_contended_captures(RandomBoard& board, SplitMix64& random) {
  make_regular_frame(board, random);
  std::vector<PlainBuffer> used = board.disparity;
  for (const std::optional<PlainBuffer>& table : {board.left_lut, board.right_lut}) {
    if (table) used.push_back(*table);
  }
  used.push_back(board.left_image.front());
  for (auto* image : {&board.left_image, &board.right_image}) {
    image->resize(2);
    for (PlainBuffer& picture : *image) picture = one_of(random, used);
  }
  if (random.chance(50)) return;
  // Banks without turnaround then serve each word of the host at once.
  board.arbitration = PlainArbitration::kFixedPriority;
  std::stable_partition(board.priority.begin(), board.priority.end(),
                        [](PlainPort port) { return port == PlainPort::kHost; });
}

// Pictures are captured into two banks that nothing else uses, line after line.
void draw_apart_captures(RandomBoard& board, SplitMix64& random) {
  make_regular_frame(board, random);
  const int pictures = random.between(1, 2);
  for (auto* image : {&board.left_image, &board.right_image}) {
    image->assign(static_cast<std::size_t>(pictures), static_cast<int>(board.banks.size()));
    board.banks.push_back(
        {one_of<PlainBankKind>(random, {PlainBankKind::kZbtPipelined, PlainBankKind::kZbtFlowThrough})});
  }
}

}  // namespace

std::uint64_t random_computers(std::uint64_t without_it) {
  const char* const asked = std::getenv("STEREOTLM_RANDOM_COMPUTERS");
  return asked != nullptr ? std::stoull(asked) : without_it;
}

RandomComputer make_random_computer(std::uint64_t seed, const RandomKnobs& knobs) {
  constexpr PlainTime kPsOfUs = 1'000'000;
  RandomBoard board = make_random_board(seed, knobs);
  SplitMix64 random_captures(seed + 3'000'000);
  const bool has_contended_captures = knobs.contended_captures && random_captures.chance(40);
  if (has_contended_captures) draw_contended_captures(board, random_captures);
  SplitMix64 random_apart(seed + 4'000'000);
  const bool has_apart_captures = knobs.apart_captures && !has_contended_captures && random_apart.chance(60);
  if (has_apart_captures) draw_apart_captures(board, random_apart);
  SplitMix64 random(seed + 1'000'000);
  PlainComputerInput input;
  input.frame_rate_hz = usual_or_odd(random, {"1000", "500", "299.7", "99.9"}, 100, 1000);
  input.on_demand = random.chance(25);
  input.capture_to_host = random.chance(40);
  input.host_frames = random.between(1, 4);
  input.fifo_words = one_of<int>(random, {1, 2, 3, 16, 140, 4096});
  input.fifo_trigger_words = random.between(1, std::min(input.fifo_words, 32));
  input.pci_clock_mhz = usual_or_odd(random, {"33.333", "33.333", "40", "66", "10", "133.7"}, 5, 150);
  input.latency_timer_clocks = one_of<int>(random, {0, 1, 5, 16, 64, 255});
  input.bridge_wait_clocks = one_of<int>(random, {0, 1, 4, 4, 40});
  input.memory_wait_clocks = one_of<int>(random, {0, 1, 8, 8, 40});
  input.local_clock_mhz = usual_or_odd(random, {"40", "40", "10", "66.6", "160"}, 5, 170);
  input.dma_burst_words = one_of<int>(random, {1, 2, 7, 32, 1024});
  input.posted_words = one_of<int>(random, {1, 2, 5, 64, 4096});
  const PlainNumber fpga_clock_mhz = usual_or_odd(random, {"40", "40", "12.5", "100"}, 12, 120);
  input.board = {cycle_input(board), fpga_clock_mhz, board.filter, board.lr_tolerance, board.cost};
  input.frames = random.between(1, 8);
  if (random.chance(30)) {
    PlainLoad load;
    load.burst_words = one_of<int>(random, {1, 32, 500});
    load.interval_ps = one_of<PlainTime>(random, {0, 5 * kPsOfUs, 100 * kPsOfUs});
    load.first_ps = one_of<PlainTime>(random, {0, 777'700'000});
    load.access_ps = one_of<PlainTime>(random, {0, 0, kPsOfUs, 60 * kPsOfUs});
    input.load = load;
  }
  if (knobs.wide_pci) {
    SplitMix64 random_width(seed + 2'000'000);
    input.pci_width_bits = random_width.chance(50) ? 64 : 32;
  }
  if (has_contended_captures || has_apart_captures) {
    input.capture_to_host = false;
    input.local_clock_mhz = fpga_clock_mhz;
    // Over many frames, bursts of the cameras come again in the same state of the core.
    input.frames = random_captures.chance(10) ? 30 : std::max(input.frames, 4);
  }
  input.pictures = [board](std::uint64_t frame) { return camera_pictures(board, frame); };
  return {board, input};
}

PicturePair camera_pictures(const RandomBoard& board, std::uint64_t frame) {
  SplitMix64 random(board.seed * 1'000'003 + frame);
  PicturePair pair;
  const int pixels = board.width * board.height;
  for (int pixel = 0; pixel < pixels; ++pixel)
    pair.left.push_back(static_cast<std::uint8_t>(random.next() >> 56U));
  // The right picture is the left one, two columns on, with some noise: it has matches.
  for (int pixel = 0; pixel < pixels; ++pixel) {
    const auto from = static_cast<std::size_t>(std::min(pixel + 2, pixels - 1));
    pair.right.push_back(random.chance(10) ? static_cast<std::uint8_t>(random.next() >> 56U)
                                           : pair.left[from]);
  }
  return pair;
}

}  // namespace stereotlm::test
