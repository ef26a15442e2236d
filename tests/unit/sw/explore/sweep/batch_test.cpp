#include "sw/explore/sweep/batch.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "platform/config/board_yaml.h"
#include "sw/explore/plan/knobs.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

TEST(Batch, ReportsWhyAPointHasNoFigures) {
  const BoardPoints points({platform::load_board("fpl2003")}, {});
  const auto fails = [](const Point& /*point*/) -> Figures { throw std::runtime_error("too large"); };
  Batch batch;
  ASSERT_TRUE(batch.run(points, fails, "1", 1, [](const SweepCounts&) { return true; }));
  EXPECT_THROW(batch.row_of(points.point(0)), PointFailed);
  EXPECT_EQ(test::message_of([&] { batch.row_of(points.point(0)); }), "fpl2003: too large");
}

}  // namespace
}  // namespace stereotlm::explore
