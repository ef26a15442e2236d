#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/plain_cycle_loop.h"
#include "tests/support/reference_arithmetic.h"

// Small random boards with tables and pictures for tests that compare the models with the references. Every
// board is legal in contract section 4, and one seed gives the same board on every platform and compiler.
namespace stereotlm::test {

// The splitmix64 generator (Steele, Lea and Flood, 2014), and the few draws that tests need. The C++ standard
// leaves the output of std:: distributions to the library; these are fixed.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  int between(int low, int high);  // low..high, both included
  bool chance(int percent);
  // low..small in most draws, low..high in the others.
  int mostly_small(int low, int small, int high);

 private:
  std::uint64_t state_;
};

struct PicturePair {
  std::vector<std::uint8_t> left;  // row-major, width * height
  std::vector<std::uint8_t> right;
};

// Fields are named after the keys of a board file; units and meaning as there. Buffers name their bank by its
// index in `banks`; the bank of index i is called "bank<i>".
struct RandomBoard {
  std::uint64_t seed = 0;

  int width = 0;   // 4..64
  int height = 0;  // 1..40

  PlainArbitration arbitration = PlainArbitration::kFixedPriority;
  std::array<PlainPort, kPlainPortCount> priority{};
  int lane_fifo_slots = 0;          // 1..64
  int result_fifo_words = 0;        // 1..64
  int pipeline_latency_cycles = 0;  // 0..40

  std::vector<PlainBank> banks;  // 1..10
  std::vector<int> left_image;   // 1..3 entries
  std::vector<int> right_image;  // as many
  std::vector<int> disparity;    // 1..3 entries
  std::optional<int> left_lut;   // nullopt: none
  std::optional<int> right_lut;

  int window = 0;                         // 3..31
  int disparities = 0;                    // 1..254
  std::optional<ReferenceKernel> filter;  // nullopt: none
  PlainFetch fetch = PlainFetch::kColumn;
  std::optional<int> lr_tolerance;  // nullopt: off

  // Entries, row-major; set exactly where the side has a left_lut or right_lut.
  std::optional<std::vector<std::uint32_t>> left_table;
  std::optional<std::vector<std::uint32_t>> right_table;

  int frames = 0;                     // 1..4
  std::vector<PicturePair> pictures;  // 1..frames pairs; frame f shows pair f mod length

  const PicturePair& pictures_of_frame(int frame) const {
    return pictures[static_cast<std::size_t>(frame) % pictures.size()];
  }
};

RandomBoard make_random_board(std::uint64_t seed);

// For the message of a failure.
inline std::string describe(const RandomBoard& board) {
  return "random board of seed " + std::to_string(board.seed);
}

// The board as the two references take it.
PlainCycleInput cycle_input(const RandomBoard& board);
ReferenceInput reference_input(const RandomBoard& board, int frame);

}  // namespace stereotlm::test
