#include "sw/report/conflicts_text.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/memory/arbitration.h"
#include "platform/config/board_yaml.h"
#include "platform/records/conflicts.h"

namespace stereotlm::report {
namespace {

using Parts = std::array<std::uint64_t, 8>;

// A frame of eight strips of two rows (the last: one row) and eight groups of four columns, of 10 cycles
// each. In group g of strip s, left_lut waits strips[s] * groups[g] cycles on bank b for left_pixel.
class MadeConflicts {
 public:
  MadeConflicts(std::uint64_t in_fill, const Parts& strips, const Parts& groups, std::size_t most_tiles = 64)
      : conflicts_(board_, most_tiles) {
    constexpr memory::PortMask kLut = memory::mask_of(fpga::lut_group(fpga::Side::kLeft));
    constexpr memory::PortMask kPixel = memory::mask_of(fpga::pixel_group(fpga::Side::kLeft));
    memory::Arbitration arbitration(board_.fpga.arbiter, platform::ssram_configs(board_));
    for (const fpga::Side side : {fpga::Side::kLeft, fpga::Side::kRight}) {
      arbitration.route(fpga::lut_group(side), 1, false);
      arbitration.route(fpga::pixel_group(side), 1, false);
    }
    fpga::ConflictRecorder& recorder = conflicts_.recorder();
    recorder.start_frame(0, arbitration);
    std::uint64_t cycle = 0;
    const auto end_group = [&](std::uint64_t waits) {
      for (; waits != 0; --waits) recorder.step(kLut | kPixel, kPixel, arbitration);
      recorder.end_group(cycle += 10);
    };
    for (; recorder.strip() == 0; in_fill = 0) end_group(in_fill);
    for (const std::uint64_t strip : strips) {
      for (const std::uint64_t group : groups) end_group(strip * group);
    }
    recorder.end_frame(cycle);
    add_frame(conflicts_.take_frames().front(), sums_);
  }

  // What is said of the only wait behind its cycles and percent.
  std::string place() const {
    const std::string text = conflicts_text(conflicts_document(board_, conflicts_.recorder(), sums_));
    const std::size_t begin = text.find(" %), ") + 5;
    return text.substr(begin, text.find('\n', begin) - begin);
  }

 private:
  platform::BoardConfig board_ = platform::load_board(
      "fpl2003", {"image={width: 32, height: 15}", "matcher.rows=2", "ssram.banks={a: {}, b: {}}",
                  "allocation.left_image=a", "allocation.right_image=a", "allocation.disparity=a",
                  "allocation.left_lut=b", "allocation.right_lut=b"});
  platform::Conflicts conflicts_;
  fpga::FrameConflicts sums_;
};

constexpr Parts kAll = {1, 1, 1, 1, 1, 1, 1, 1};

TEST(ConflictsText, NamesTheFirstAndShortestPlaceThatHas80PercentOfAWait) {
  struct Case {
    Parts strips;
    Parts groups;
    std::string place;
  };
  const std::vector<Case> cases = {
      {kAll, kAll, "all over the picture"},
      {{0, 0, 1, 1, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 1, 1, 0}, "80 % in rows 4..7, 80 % in columns 20..27"},
      {{0, 0, 0, 0, 0, 0, 0, 1}, kAll, "80 % in rows 14..14"},
      {kAll, {0, 0, 0, 0, 0, 0, 0, 1}, "80 % in columns 28..31"},
      {{0, 1, 1, 1, 1, 1, 0, 0}, kAll, "80 % in rows 2..9"},      // 4 of 5; the first
      {{1, 1, 1, 1, 16, 0, 0, 0}, kAll, "80 % in rows 8..9"},     // the shortest
      {{0, 0, 80, 0, 0, 20, 0, 0}, kAll, "80 % in rows 4..5"},    // just enough
      {{0, 0, 79, 0, 0, 21, 0, 0}, kAll, "80 % in rows 4..11"},   // too little
      {{0, 1, 1, 1, 1, 1, 1, 0}, kAll, "80 % in rows 2..11"},     // 5 of 8
      {{0, 1, 1, 1, 1, 1, 1, 1}, kAll, "all over the picture"},   // 6 of 8: most of the picture
      {kAll, {1, 1, 1, 1, 1, 1, 0, 0}, "80 % in columns 0..19"},  // 5 of 8
      {kAll, {1, 1, 1, 1, 1, 1, 1, 0}, "all over the picture"},   // 6 of 8
  };
  for (const auto& [strips, groups, place] : cases) {
    EXPECT_EQ(MadeConflicts(0, strips, groups).place(), place);
  }
}

TEST(ConflictsText, LeavesWaitsBeforeTheFirstRowOutOfThePlace) {
  EXPECT_EQ(MadeConflicts(9, {}, {}).place(), "before the first row of results");
  EXPECT_EQ(MadeConflicts(9, {0, 0, 0, 1}, {1}).place(), "80 % in rows 6..7, 80 % in columns 0..3");
}

TEST(ConflictsText, NamesThePlaceInWholeTiles) {
  // Of 8x4 pixels.
  const MadeConflicts conflicts(0, {0, 0, 0, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 0, 0, 1}, 16);
  EXPECT_EQ(conflicts.place(), "80 % in rows 12..14, 80 % in columns 24..31");
}

}  // namespace
}  // namespace stereotlm::report
