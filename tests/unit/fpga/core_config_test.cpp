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

TEST(CoreConfig, AcceptsBothEndsOfEachRange) {
  const std::vector<Change> changes = {
      [](CoreConfig& c) { c.width = 4, c.height = 1, c.window = 3, c.disparities = 1, c.lr_tolerance = 0; },
      [](CoreConfig& c) { c.width = 2048, c.height = 2048, c.window = 31, c.disparities = 254; },
      [](CoreConfig& c) { c.width = 8192, c.height = 8192, c.left_table = c.right_table = false; },
      [](CoreConfig& c) { c.units = 1, c.disparities = 1; },
      [](CoreConfig& c) { c.units = c.disparities = 254; },
      [](CoreConfig& c) { c.rows = c.result_fifo_words = 16; },
      [](CoreConfig& c) { c.rows = 1, c.fetch = Fetch::kLineBuffer; },
      [](CoreConfig& c) { c.lane_fifo_slots = 1, c.result_fifo_words = 1, c.pipeline_latency_cycles = 0; },
      [](CoreConfig& c) { c.lane_fifo_slots = 64, c.result_fifo_words = 64, c.clock_mhz = 1000; },
      [](CoreConfig& c) { c.pipeline_latency_cycles = 1024, c.lr_tolerance = 253, c.clock_mhz = 1; },
      [](CoreConfig& c) { c.filter.reset(), c.lr_tolerance.reset(); },
  };
  for (std::size_t i = 0; i < changes.size(); ++i)
    EXPECT_EQ(problems_after(changes[i]), std::vector<std::string>{}) << i;
}

TEST(CoreConfig, RefusesWhatLiesBeyondThem) {
  const std::vector<std::pair<Change, std::string>> cases = {
      {[](CoreConfig& c) { c.width = 0; },
       "width = 0: must be 4..2048, a multiple of 4; a side has a look-up table"},
      {[](CoreConfig& c) { c.width = 6; },
       "width = 6: must be 4..2048, a multiple of 4; a side has a look-up table"},
      {[](CoreConfig& c) { c.width = 2052; },
       "width = 2052: must be 4..2048, a multiple of 4; a side has a look-up table"},
      {[](CoreConfig& c) { c.height = 0; }, "height = 0: must be 1..2048; a side has a look-up table"},
      {[](CoreConfig& c) { c.height = 2049; }, "height = 2049: must be 1..2048; a side has a look-up table"},
      {[](CoreConfig& c) { c.width = 2052, c.left_table = false; },
       "width = 2052: must be 4..2048, a multiple of 4; a side has a look-up table"},
      {[](CoreConfig& c) { c.height = 2049, c.right_table = false; },
       "height = 2049: must be 1..2048; a side has a look-up table"},
      {[](CoreConfig& c) { c.width = 8196, c.left_table = c.right_table = false; },
       "width = 8196: must be 4..8192, a multiple of 4"},
      {[](CoreConfig& c) { c.height = 8193, c.left_table = c.right_table = false; },
       "height = 8193: must be 1..8192"},
      {[](CoreConfig& c) { c.units = 0; }, "units = 0: must be 1..254"},
      {[](CoreConfig& c) { c.units = 81; }, "units = 81: must be at most disparities, which is 80"},
      {[](CoreConfig& c) { c.rows = 0; }, "rows = 0: must be 1..16"},
      {[](CoreConfig& c) { c.rows = 17, c.result_fifo_words = 17; }, "rows = 17: must be 1..16"},
      {[](CoreConfig& c) { c.rows = 2, c.fetch = Fetch::kLineBuffer; },
       "rows = 2: must be 1 with the line buffer"},
      {[](CoreConfig& c) { c.rows = 9; }, "result_fifo_words = 8: must be at least rows, which is 9"},
      {[](CoreConfig& c) { c.window = 1; }, "window = 1: must be 3..31, odd"},
      {[](CoreConfig& c) { c.window = 8; }, "window = 8: must be 3..31, odd"},
      {[](CoreConfig& c) { c.window = 33; }, "window = 33: must be 3..31, odd"},
      {[](CoreConfig& c) { c.disparities = 0; }, "disparities = 0: must be 1..254"},
      {[](CoreConfig& c) { c.disparities = 255; }, "disparities = 255: must be 1..254"},
      {[](CoreConfig& c) { c.lr_tolerance = -1; }, "lr_tolerance = -1: must be 0..253"},
      {[](CoreConfig& c) { c.lr_tolerance = 254; }, "lr_tolerance = 254: must be 0..253"},
      {[](CoreConfig& c) { c.lane_fifo_slots = 0; }, "lane_fifo_slots = 0: must be 1..64"},
      {[](CoreConfig& c) { c.lane_fifo_slots = 65; }, "lane_fifo_slots = 65: must be 1..64"},
      {[](CoreConfig& c) { c.result_fifo_words = 0; }, "result_fifo_words = 0: must be 1..64"},
      {[](CoreConfig& c) { c.result_fifo_words = 65; }, "result_fifo_words = 65: must be 1..64"},
      {[](CoreConfig& c) { c.pipeline_latency_cycles = -1; },
       "pipeline_latency_cycles = -1: must be 0..1024"},
      {[](CoreConfig& c) { c.pipeline_latency_cycles = 1025; },
       "pipeline_latency_cycles = 1025: must be 0..1024"},
      {[](CoreConfig& c) { c.clock_mhz = 0.5; }, "clock_mhz = 0.500000: must be 1..1000"},
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
  for (const int slots : {1, 64}) EXPECT_NO_THROW(LaneControl(geometry, true, PixelCache::kNone, slots));
  for (const int slots : {0, 65})
    EXPECT_THROW(LaneControl(geometry, true, PixelCache::kNone, slots), std::invalid_argument);
  LaneControl lane(geometry, true, PixelCache::kNone, 1);
  LaneControl lane_without_table(geometry, false, PixelCache::kNone, 1);
  for (const int latency : {1, 2}) EXPECT_NO_THROW(lane.start_frame(latency, latency));
  for (const int latency : {0, 3}) {
    EXPECT_THROW(lane.start_frame(latency, 2), std::invalid_argument);
    EXPECT_THROW(lane.start_frame(2, latency), std::invalid_argument);
    EXPECT_NO_THROW(lane_without_table.start_frame(latency, 2));  // the first has no effect
  }
}

TEST(CorePorts, AreThoseOfTheContract) {
  const std::vector<std::string> expected = {"left_lut",    "right_lut", "left_pixel",
                                             "right_pixel", "result",    "host"};
  std::vector<std::string> names;
  for (const CorePort& port : kPorts) names.emplace_back(port.name);
  EXPECT_EQ(names, expected);
}

TEST(CorePorts, HaveThePriorityListOfTheContract) {
  std::vector<std::string> names;
  for (const memory::Port port : core_arbiter().priority) names.emplace_back(kPorts[port].name);
  EXPECT_EQ(names, (std::vector<std::string>{"host", "result", "left_pixel", "right_pixel", "left_lut",
                                             "right_lut"}));
  EXPECT_EQ(core_arbiter().policy, "fixed_priority");
}

TEST(CorePorts, AreOneForJointTables) {
  CoreConfig config;
  config.joint_tables = true;
  EXPECT_TRUE(has_port(config, lut_port(Side::kLeft)));
  EXPECT_FALSE(has_port(config, lut_port(Side::kRight)));
  for (const Side side : kSides) EXPECT_TRUE(has_table(config, side));
}

TEST(CorePorts, ExistForATableOnlyIfTheCoreHasOne) {
  CoreConfig config;
  config.right_table = false;
  for (memory::Port port = 0; port < kPortCount; ++port)
    EXPECT_EQ(has_port(config, port), port != lut_port(Side::kRight)) << kPorts[port].name;
}

}  // namespace
}  // namespace stereotlm::fpga
