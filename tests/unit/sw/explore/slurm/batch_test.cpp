#include "sw/explore/slurm/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "platform/config/board_yaml.h"
#include "sw/explore/plan/knobs.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

using test::message_of;
using ::testing::HasSubstr;

BoardPoints points_with(const std::vector<std::string>& windows) {
  std::vector<platform::BoardConfig> boards;
  for (const std::string& window : windows)
    boards.push_back(platform::load_board("fpl2003", {"matcher.window=" + window}));
  return {std::move(boards), {}};
}

// What a run gives is made up.
Figures evaluate(const Point& point) {
  if (point.board->matcher.window == 9) throw std::runtime_error("too large");
  return {{{"cycles", std::int64_t{100} * point.board->matcher.window}, {"frames_per_second.core", 2.5}}, {}};
}

bool always(const SweepCounts& /*counts*/) { return true; }

TEST(Batch, KeepsWhatCameOfEachPoint) {
  const BoardPoints points = points_with({"5", "7"});
  Batch batch;
  ASSERT_TRUE(batch.run(points, evaluate, "1", 2, always));
  EXPECT_EQ(batch.row_of(points.point(1)).integer("cycles"), 700);
  EXPECT_EQ(batch.row_of(points.point(0)).integer("cycles"), 500);
  const StoredRow& row = batch.row_of(points.point(0));
  EXPECT_EQ(row.real("frames_per_second.core"), 2.5);
  EXPECT_EQ(row.integer("matcher.window"), 5);
  EXPECT_EQ(row.text("run.source"), "preloaded");
  EXPECT_EQ(row.text("no.such.column"), "");
  EXPECT_EQ(row.integer("no.such.column"), 0);
  EXPECT_EQ(row.real("no.such.column"), 0);
}

TEST(Batch, SaysWhyAPointHasNoFigures) {
  const BoardPoints points = points_with({"9"});
  Batch batch;
  ASSERT_TRUE(batch.run(points, evaluate, "1", 1, always));
  EXPECT_THROW(batch.row_of(points.point(0)), PointFailed);
  EXPECT_EQ(message_of([&] { batch.row_of(points.point(0)); }), "fpl2003: too large");
  EXPECT_THAT(message_of([&] { batch.row_of(points_with({"11"}).point(0)); }),
              HasSubstr("was not simulated"));
}

TEST(Batch, TakesFurtherPoints) {
  const BoardPoints points = points_with({"5"});
  const BoardPoints others = points_with({"11"});
  Batch batch;
  ASSERT_TRUE(batch.run(points, evaluate, "1", 1, always));
  EXPECT_EQ(batch.row_of(points.point(0)).integer("cycles"), 500);
  ASSERT_TRUE(batch.run(others, evaluate, "1", 1, always));
  EXPECT_EQ(batch.row_of(others.point(0)).integer("cycles"), 1100);
  EXPECT_EQ(batch.row_of(points.point(0)).integer("cycles"), 500);
}

TEST(Batch, CanBeInterrupted) {
  std::vector<platform::BoardConfig> boards;
  for (int disparities = 1; disparities <= 64; ++disparities)
    boards.push_back(platform::load_board("fpl2003", {"matcher.disparities=" + std::to_string(disparities)}));
  Batch batch;
  EXPECT_FALSE(batch.run(BoardPoints(boards, {}), evaluate, "1", 1,
                         [](const SweepCounts& /*counts*/) { return false; }));
}

TEST(Batch, LeavesNothingBehind) {
  std::string path;
  {
    Batch batch;
    ASSERT_TRUE(batch.run(points_with({"5"}), evaluate, "1", 1, always));
    path = batch.path();
    ASSERT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(path).parent_path()));
}

}  // namespace
}  // namespace stereotlm::explore
