#include "sw/report/conflicts_text.h"

#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/conflicts.h"
#include "platform/core_run.h"
#include "sw/report/conflicts_csv.h"

namespace stereotlm::report {
namespace {

// A frame of two strips of two rows on a board of 8x3 pixels with two banks.
fpga::FrameConflicts frame() {
  fpga::FrameConflicts frame;
  frame.banks = 2;
  frame.strips = {{10, {}}, {200, {}}, {100, {}}};
  frame.strips[1].stalls[0] = 50;
  frame.strips[1].stalls[fpga::requester_of(fpga::HostTraffic::kReadBack)] = 7;
  frame.accesses.resize(6);
  frame.accesses[2] = {150, 0, 0, 0};
  frame.accesses[3] = {0, 1, 2, 3};
  return frame;
}

platform::BoardConfig board() {
  return platform::load_board(
      "fpl2003", {"image.width=8", "image.height=3", "matcher.rows=2", "ssram.banks={a: {}, b: {}}",
                  "allocation.left_image=a", "allocation.right_image=a", "allocation.disparity=a",
                  "allocation.left_lut=b", "allocation.right_lut=b"});
}

TEST(RowsCsv, HasALineForEachStripOfAFrame) {
  EXPECT_EQ(
      rows_csv_head(board()),
      "frame,first_row,last_row,cycles,left_lut_stall_cycles,right_lut_stall_cycles,left_pixel_stall_cycles,"
      "right_pixel_stall_cycles,result_stall_cycles,host_capture_stall_cycles,host_upload_stall_cycles,"
      "host_read_back_stall_cycles,a_core_accesses,a_capture_accesses,a_upload_accesses,"
      "a_read_back_accesses,b_core_accesses,b_capture_accesses,b_upload_accesses,b_read_back_accesses\n");
  EXPECT_EQ(rows_csv(board(), 12, frame()),
            "12,,,10,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n"
            "12,0,1,200,50,0,0,0,0,0,0,7,150,0,0,0,0,1,2,3\n"
            "12,2,2,100,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n");
}

TEST(ConflictsText, NamesTheFirstOfTheShortestPlacesWithMostOfTheWaits) {
  const auto place = [](const std::vector<std::uint64_t>& values, std::size_t length = 1, int whole = 8) {
    const std::optional<Range> found = place_of(values, length, whole);
    return found ? std::pair(found->first, found->last) : std::pair(-1, -1);
  };
  EXPECT_EQ(place({20, 60, 20, 0, 0, 0, 0, 0}), std::pair(0, 1)) << "not rows 1..2";
  EXPECT_EQ(place({10, 10, 0, 80, 0, 0, 0, 0}), std::pair(3, 3)) << "not rows 0..3";
  EXPECT_EQ(place({0, 0, 0, 0, 0, 0, 20, 80}, 2, 15), std::pair(14, 14)) << "the last rows are fewer";
  EXPECT_EQ(place({16, 16, 16, 16, 16, 7, 7, 6}), std::pair(0, 4));
  EXPECT_EQ(place({14, 14, 14, 14, 14, 10, 10, 10}), std::pair(-1, -1)) << "six of eight are most of them";
}

TEST(ConflictsText, SumsFramesAndShowsTheBanksThatAreUsed) {
  StripSums sums;
  sums.add(frame());
  sums.add(frame());
  const platform::Conflicts none(board());
  EXPECT_EQ(conflicts_text(conflict_summary(board(), none.recorder(), sums.sums())),
            "core         0 cycles in 0 frames\n"
            "waits        none\n"
            "rows              waits %       a %       b %\n"
            "fill                 0.00      0.00      0.00\n"
            "0..1                28.50     75.00      3.00\n"
            "2..2                 0.00      0.00      0.00\n");
}

}  // namespace
}  // namespace stereotlm::report
