#include "sw/explore/sweep/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
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

// Made-up figures; the window 9 fails.
Figures figures_of_window(const Point& point) {
  if (point.board->matcher.window == 9) throw std::runtime_error("too large");
  return {{{"cycles", std::int64_t{100} * point.board->matcher.window}, {"frames_per_second.core", 2.5}}, {}};
}

bool run(Batch& batch, const BoardPoints& points, bool to_its_end = true) {
  return batch.run(points, figures_of_window, "1", 2,
                   [to_its_end](const SweepCounts&) { return to_its_end; });
}

TEST(Batch, KeepsTheResultsOfAllItsRuns) {
  const BoardPoints points = points_with({"5", "7"});
  const BoardPoints others = points_with({"11"});
  Batch batch;
  ASSERT_TRUE(run(batch, points));
  EXPECT_EQ(batch.row_of(points.point(1)).integer("cycles"), 700);
  ASSERT_TRUE(run(batch, others));
  EXPECT_EQ(batch.row_of(others.point(0)).integer("cycles"), 1100);
  const StoredRow& row = batch.row_of(points.point(0));
  EXPECT_EQ(row.integer("cycles"), 500);
  EXPECT_EQ(row.real("frames_per_second.core"), 2.5);
  EXPECT_EQ(row.integer("matcher.window"), 5);
  EXPECT_EQ(row.text("run.source"), "preloaded");
  EXPECT_EQ(row.text("no.such.column"), "");
  EXPECT_EQ(row.integer("no.such.column"), 0);
  EXPECT_EQ(row.real("no.such.column"), 0);
}

TEST(Batch, ReportsWhyAPointHasNoFigures) {
  const BoardPoints points = points_with({"9"});
  Batch batch;
  ASSERT_TRUE(run(batch, points));
  EXPECT_THROW(batch.row_of(points.point(0)), PointFailed);
  EXPECT_EQ(message_of([&] { batch.row_of(points.point(0)); }), "fpl2003: too large");
  EXPECT_THAT(message_of([&] { batch.row_of(points_with({"11"}).point(0)); }),
              HasSubstr("was not simulated"));
}

TEST(Batch, CanBeInterruptedAndRemovesItsFolder) {
  std::optional<Batch> batch(std::in_place);
  EXPECT_FALSE(run(*batch, points_with(std::vector<std::string>(64, "5")), false));
  const std::filesystem::path path = batch->path();
  EXPECT_TRUE(std::filesystem::exists(path));
  batch.reset();
  EXPECT_FALSE(std::filesystem::exists(path.parent_path()));
}

}  // namespace
}  // namespace stereotlm::explore
