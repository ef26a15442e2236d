#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/plain_clock.h"
#include "tests/support/plain_cycle_loop.h"
#include "tests/support/reference_arithmetic.h"

// Small random boards with tables and pictures for tests that compare the models with the references. Every
// board keeps the rules of contract section 4. A seed gives the same board on every platform.
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

// 4..64 x 1..40 pixels, 1..10 banks, a pipeline latency of up to 40 cycles, all else in its whole range.
// Each side with a bank for its table has entries; filter_half and cost_half are not set.
struct RandomBoard : PlainCycleInput {
  std::uint64_t seed = 0;
  std::optional<ReferenceKernel> filter;  // nullopt: none
  std::optional<int> lr_tolerance;        // nullopt: off
  ReferenceCost cost;
  PlainNumber clock_mhz{40, 1};       // of computers another one
  int frames = 0;                     // 1..4
  std::vector<PicturePair> pictures;  // 1..frames pairs; frame f shows pair f mod length

  const PicturePair& pictures_of_frame(int frame) const {
    return pictures[static_cast<std::size_t>(frame) % pictures.size()];
  }
};

// The knobs of contract sections 7 and 8 that boards draw, beside all of sections 1 to 6. About every second
// board draws each of them, in any combination that is allowed.
struct RandomKnobs {
  bool large_images = false;  // few boards: up to 8192 columns or rows, without tables
  bool units = false;         // up to 16 passes
  bool rows = false;
  bool joint_tables = false;
  bool word_cache = false;
  bool qdr = false;
  bool cost = false;
  bool result_delay = false;
  bool wide_pci = false;  // of computers: 64 bits
  // Of computers: captures contend with the frame, by a local bus in step with the core, and the accesses of
  // the frame are regular. The models have a faster way there; it is no knob of section 7.
  bool contended_captures = false;
  // Of computers: captures go to banks of their own, by a local bus in step with the core.
  bool apart_captures = false;
  // Of section 8.
  bool sdram = false;
  bool stripes = false;  // and up to 8 banks more
  bool lanes = false;
  bool energy = false;  // of section 9: banks with figures of their own, and another clock

  // Those of section 7.
  static constexpr RandomKnobs all() {
    return {true, true, true, true, true, true, true, true, true, true, true};
  }
  // Those of sections 7 to 9: all that boards can have.
  static constexpr RandomKnobs with_section_8() {
    RandomKnobs knobs = all();
    knobs.lanes = knobs.sdram = knobs.stripes = knobs.energy = true;
    return knobs;
  }
};

// The number of boards that a test compares: STEREOTLM_RANDOM_BOARDS, if that is set.
std::uint64_t random_boards(std::uint64_t without_it);

// Without knobs a seed gives the board of sections 1 to 6 that it has always given. Each knob draws from a
// generator of its own.
// `fix` sets what the board must have, before its tables and pictures are drawn.
RandomBoard make_random_board(std::uint64_t seed, const RandomKnobs& knobs = {},
                              const std::function<void(RandomBoard&)>& fix = {});

// For the message of a failure.
inline std::string describe(const RandomBoard& board) {
  return "random board of seed " + std::to_string(board.seed);
}

// The board as input of the two references.
PlainCycleInput cycle_input(const RandomBoard& board);
ReferenceInput reference_input(const RandomBoard& board, int frame);

}  // namespace stereotlm::test
