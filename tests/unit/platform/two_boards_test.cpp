#include <gtest/gtest.h>

#include "platform/figures/bounds.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform::testing {
namespace {

// Neither board may wait until the other one is idle.
TEST(TwoBoards, TakeTheSameCyclesSideBySideAsAlone) {
  const BoardConfig first = small_board();
  BoardConfig second = small_board();
  second.image.height = 9;
  second.fpga.clock_mhz = 33.333;
  const Tables first_tables = identity_tables(first);
  const Tables second_tables = identity_tables(second);
  GreyPictures first_pictures(first);
  GreyPictures second_pictures(second);
  NoSink sink;
  test::MonitoringBinder first_binder;
  test::MonitoringBinder second_binder;
  PreloadedSystem one("one", first, first_tables, 3, first_pictures, sink, first_binder);
  PreloadedSystem two("two", second, second_tables, 2, second_pictures, sink, second_binder);
  sc_core::sc_start();
  ASSERT_TRUE(one.host.finished());
  ASSERT_TRUE(two.host.finished());
  // Nothing contends, so each frame takes what the matcher needs.
  const std::vector<std::uint64_t> first_frames(
      3, frame_bounds(first, frame_accesses(first, first_tables), 0).back().cycles);
  const std::vector<std::uint64_t> second_frames(
      2, frame_bounds(second, frame_accesses(second, second_tables), 0).back().cycles);
  EXPECT_EQ(one.board.core.frames().frame_cycles(), first_frames);
  EXPECT_EQ(two.board.core.frames().frame_cycles(), second_frames);
  EXPECT_TRUE(collect_statistics(first, first_tables, one.board).failed.empty());
  EXPECT_TRUE(collect_statistics(second, second_tables, two.board).failed.empty());
}

}  // namespace
}  // namespace stereotlm::platform::testing
