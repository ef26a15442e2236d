#include "models/fpga/core_config.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/core_ports.h"
#include "models/fpga/lane_control.h"

namespace stereotlm::fpga {
namespace {

using Change = std::function<void(CoreConfig&)>;

std::vector<std::string> problems_after(const Change& change) {
  CoreConfig config;
  change(config);
  return problems(config);
}

// The keys of board files test both ends of each range.
TEST(CoreConfig, RefusesFieldsThatDoNotGoTogether) {
  const std::vector<std::pair<Change, std::string>> cases = {
      {[](CoreConfig& c) { c.width = 2052, c.left_table = false; },
       "width = 2052: must be 4..2048, a multiple of 4; a side has a look-up table"},
      {[](CoreConfig& c) { c.height = 2049, c.right_table = false; },
       "height = 2049: must be 1..2048; a side has a look-up table"},
      {[](CoreConfig& c) { c.height = 8193, c.left_table = c.right_table = false; },
       "height = 8193: must be 1..8192"},
      {[](CoreConfig& c) { c.units = 81; }, "units = 81: must be at most disparities, which is 80"},
      {[](CoreConfig& c) { c.rows = 2, c.fetch = Fetch::kLineBuffer; },
       "rows = 2: must be 1 with the line buffer"},
      {[](CoreConfig& c) { c.rows = 9; }, "result_fifo_words = 8: must be at least rows, which is 9"},
      {[](CoreConfig& c) { c.lanes = 0; }, "lanes = 0: must be 1..16"},
      {[](CoreConfig& c) { c.lanes = 17, c.window = 19; }, "lanes = 17: must be 1..16"},
      {[](CoreConfig& c) { c.lanes = 2, c.fetch = Fetch::kLineBuffer; },
       "lanes = 2: must be 1 with the line buffer"},
      {[](CoreConfig& c) { c.lanes = 9, c.rows = 2; },
       "lanes = 9: must be at most the slots of a column, window + rows - 1, which is 8"},
      {[](CoreConfig& c) { c.joint_tables = true, c.right_table = false; },
       "joint_tables = true: both sides must have a table"},
      {[](CoreConfig& c) { c.clock_mhz = 1000.5; }, "clock_mhz = 1000.500000: must be 1..1000"},
  };
  for (const auto& [change, problem] : cases)
    EXPECT_EQ(problems_after(change), std::vector<std::string>{problem});
}

TEST(CoreConfig, RefusesAKernelWithProblems) {
  const auto found = problems_after([](CoreConfig& c) { c.filter->weights.front() = 1; });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().rfind("filter: ", 0), 0U) << found.front();
}

TEST(LaneControl, RefusesADepthOrAReadLatencyOutsideItsRange) {
  const FrameGeometry geometry{CoreConfig()};
  for (const int slots : {1, 64}) EXPECT_NO_THROW(LaneControl(geometry, 0, true, PixelCache::kNone, slots));
  for (const int slots : {0, 65})
    EXPECT_THROW(LaneControl(geometry, 0, true, PixelCache::kNone, slots), std::invalid_argument);
  LaneControl lane(geometry, 0, true, PixelCache::kNone, 1);
  LaneControl lane_without_table(geometry, 0, false, PixelCache::kNone, 1);
  for (const int latency : {1, 8}) EXPECT_NO_THROW(lane.start_frame(latency, latency));
  for (const int latency : {0, 9}) {
    EXPECT_THROW(lane.start_frame(latency, 2), std::invalid_argument);
    EXPECT_THROW(lane.start_frame(2, latency), std::invalid_argument);
    EXPECT_NO_THROW(lane_without_table.start_frame(latency, 2));  // the first has no effect
  }
}

TEST(CorePorts, AreThoseOfTheContract) {
  const std::vector<std::string> expected = {"left_lut",    "right_lut", "left_pixel",
                                             "right_pixel", "result",    "host"};
  std::vector<std::string> names;
  for (const PortGroup& port : kPortGroups) names.emplace_back(port.name);
  EXPECT_EQ(names, expected);
}

TEST(CorePorts, HaveThePriorityListOfTheContract) {
  std::vector<std::string> names;
  for (const memory::Port port : core_arbiter().priority) names.emplace_back(kPortGroups[port].name);
  EXPECT_EQ(names, (std::vector<std::string>{"host", "result", "left_pixel", "right_pixel", "left_lut",
                                             "right_lut"}));
  EXPECT_EQ(core_arbiter().policy, "fixed_priority");
}

}  // namespace
}  // namespace stereotlm::fpga
