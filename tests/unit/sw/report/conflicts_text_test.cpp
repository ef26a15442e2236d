#include "sw/report/conflicts_text.h"

#include <gtest/gtest.h>

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
