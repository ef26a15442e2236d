#include "models/fpga/lane_control.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>

namespace stereotlm::fpga {
namespace {

// 4 x `height` pixels, 3 x 3 windows, line buffers: slots row by row, and one row of empty slots at the end.
CoreConfig config(int height) {
  CoreConfig core;
  core.width = 4;
  core.height = height;
  core.window = 3;
  core.disparities = 1;
  core.filter.reset();
  core.fetch = Fetch::kLineBuffer;
  return core;
}

// A lane and one who steps it. Everything is granted and every entry valid unless the test says otherwise.
class Lane {
 public:
  explicit Lane(int fifo_slots, int table_latency = 2, int image_latency = 2, bool has_table = true,
                int height = 2)
      : geometry(config(height)), control(geometry, has_table, fifo_slots) {
    control.start_frame(table_latency, image_latency);
  }

  bool grant_lut = true;
  bool grant_pixel = true;
  bool entry_valid = true;
  bool consume = true;  // whatever can be consumed

  // One cycle; returns what was decided in it.
  LaneControl::Decision step() {
    const LaneControl::Decision decision = control.decide();
    consumed_now = consume && control.ready();
    control.commit(decision, grant_lut && decision.lut == Intent::kRequest,
                   grant_pixel && decision.pixel == Intent::kRequest, entry_valid, consumed_now);
    ++cycles;
    return decision;
  }
  // The intent of a port over the next cycles.
  std::vector<Intent> lut(int count) { return intents(count, &LaneControl::Decision::lut); }
  std::vector<Intent> pixel(int count) { return intents(count, &LaneControl::Decision::pixel); }

  FrameGeometry geometry;
  LaneControl control;
  bool consumed_now = false;
  std::uint64_t cycles = 0;

 private:
  std::vector<Intent> intents(int count, Intent LaneControl::Decision::*port) {
    std::vector<Intent> intents;
    while (count-- > 0) intents.push_back(step().*port);
    return intents;
  }
};

constexpr Intent kRequest = Intent::kRequest;
constexpr Intent kPass = Intent::kPass;
constexpr Intent kIdle = Intent::kIdle;
constexpr Intent kBlocked = Intent::kBlocked;
constexpr Intent kStarved = Intent::kStarved;
using Intents = std::vector<Intent>;

TEST(LaneControl, TakesASlotWithOnePlaceLeftAndNoneWithoutPlace) {
  Lane lane(3);
  lane.grant_pixel = false;
  EXPECT_EQ(lane.lut(5), (Intents{kRequest, kRequest, kRequest, kBlocked, kBlocked}));
}

TEST(LaneControl, CountsASlotConsumedInTheCycleAsStillInTheLane) {
  Lane lane(1, 1, 1);
  EXPECT_EQ(lane.step().lut, kRequest);  // cycle 0: taken
  EXPECT_EQ(lane.step().lut, kBlocked);  // cycle 1: handled
  EXPECT_EQ(lane.step().lut, kBlocked);  // cycle 2: consumed
  EXPECT_TRUE(lane.consumed_now);
  EXPECT_EQ(lane.step().lut, kRequest);
}

TEST(LaneControl, RunsWithoutPauseIfThePlacesCoverTheLatencies) {
  // A slot stays for both latencies and the cycle in which it is consumed.
  Lane enough(5, 2, 2, true, 8);
  EXPECT_EQ(enough.lut(20), Intents(20, kRequest));
  Lane one_short(4, 2, 2, true, 8);
  EXPECT_EQ(one_short.lut(6), (Intents{kRequest, kRequest, kRequest, kRequest, kBlocked, kRequest}));
}

TEST(LaneControl, HandlesASlotAtTheTablesLatencyAndNotBefore) {
  Lane pipelined(16, 2, 2);
  EXPECT_EQ(pipelined.pixel(3), (Intents{kIdle, kIdle, kRequest}));
  Lane flow_through(16, 1, 2);
  EXPECT_EQ(flow_through.pixel(2), (Intents{kIdle, kRequest}));
}

TEST(LaneControl, LetsTheMatcherConsumeAtTheImagesLatencyAndNotBefore) {
  for (const int image_latency : {1, 2}) {
    Lane lane(16, 1, image_latency);
    std::vector<bool> consumed;
    for (int cycle = 0; cycle <= 1 + image_latency; ++cycle) {
      lane.step();
      consumed.push_back(lane.consumed_now);
    }
    std::vector<bool> expected(static_cast<std::size_t>(1 + image_latency), false);
    expected.push_back(true);
    EXPECT_EQ(consumed, expected) << image_latency;
  }
}

TEST(LaneControl, AsksAgainForWhatWasRefused) {
  Lane lane(2, 1, 1);
  lane.grant_lut = false;
  EXPECT_EQ(lane.lut(3), Intents(3, kRequest));
  lane.grant_lut = true;
  lane.grant_pixel = false;
  lane.step();
  EXPECT_EQ(lane.pixel(3), Intents(3, kRequest));
  EXPECT_EQ(lane.control.handled(), 0U);
  lane.grant_pixel = true;
  lane.step();
  EXPECT_EQ(lane.control.handled(), 1U);
}

TEST(LaneControl, PassesWhatHasNoValidEntryAndAsksForWhatHas) {
  Lane lane(16, 2, 1);
  Intents pixel;
  for (const bool valid : {true, false, false, true, true, true}) {
    lane.entry_valid = valid;
    pixel.push_back(lane.step().pixel);
  }
  EXPECT_EQ(pixel, (Intents{kIdle, kIdle, kRequest, kPass, kPass, kRequest}));
}

TEST(LaneControl, KeepsTheEntriesOfAFullLaneInOrder) {
  Lane lane(64, 2, 2, true, 32);
  lane.grant_pixel = false;
  lane.step();  // the first is valid and keeps the others waiting
  for (int slot = 1; slot < 64; ++slot) {
    lane.entry_valid = slot % 3 == 0;
    EXPECT_EQ(lane.step().lut, kRequest);
  }
  lane.consume = false;
  EXPECT_EQ(lane.step().lut, kBlocked);
  lane.grant_pixel = true;
  for (int slot = 0; slot < 64; ++slot)
    EXPECT_EQ(lane.step().pixel, slot % 3 == 0 ? kRequest : kPass) << slot;
}

TEST(LaneControl, PassesEmptySlotsAtBothPortsWithTheSameLatencies) {
  // Four pixels, then four empty slots.
  const Intents requests_and_passes = {kRequest, kRequest, kRequest, kRequest, kPass, kPass, kPass, kPass};
  Lane lut(16, 2, 2, true, 1);
  EXPECT_EQ(lut.lut(8), requests_and_passes);
  EXPECT_EQ(lut.lut(1), Intents{kIdle});
  Lane pixel(16, 2, 2, true, 1);
  EXPECT_EQ(pixel.pixel(2), Intents(2, kIdle));
  EXPECT_EQ(pixel.pixel(8), requests_and_passes);
  EXPECT_EQ(pixel.pixel(1), Intents{kIdle});
  // The last slot was taken in cycle 7, handled in cycle 9 and is consumed in cycle 11.
  EXPECT_EQ(pixel.cycles, 11U);
  for (const std::uint64_t consumed : {7U, 8U, 8U}) {
    EXPECT_EQ(pixel.control.consumed(), consumed);
    pixel.step();
  }
}

TEST(LaneControl, StarvesThePixelPortBetweenItsFirstAndItsLastSlot) {
  Lane lane(16, 1, 1, true, 1);
  lane.grant_lut = false;
  EXPECT_EQ(lane.pixel(3), Intents(3, kIdle));  // nothing yet: idle
  lane.grant_lut = true;
  EXPECT_EQ(lane.step().pixel, kIdle);
  lane.grant_lut = false;
  EXPECT_EQ(lane.pixel(3), (Intents{kRequest, kStarved, kStarved}));
  lane.grant_lut = true;
  EXPECT_EQ(lane.pixel(3), (Intents{kStarved, kRequest, kRequest}));
  EXPECT_EQ(lane.pixel(6), (Intents{kRequest, kPass, kPass, kPass, kPass, kIdle}));
}

TEST(LaneControl, BlocksOnlyAPortThatTakesSlots) {
  Lane lane(2, 1, 1);
  lane.consume = false;
  EXPECT_EQ(lane.lut(4), (Intents{kRequest, kRequest, kBlocked, kBlocked}));
  EXPECT_EQ(lane.pixel(1), Intents{kStarved});
}

TEST(LaneControl, LetsThePixelPortTakeTheSlotsOfASideWithoutTable) {
  Lane lane(2, 2, 2, false, 1);
  EXPECT_EQ(lane.pixel(4), (Intents{kRequest, kRequest, kBlocked, kRequest}));  // consumed first in cycle 2
  EXPECT_EQ(lane.control.consumed(), 2U);
  EXPECT_EQ(lane.lut(1), Intents{kIdle});
}

TEST(LaneControl, ConsumesAtTheImagesLatencyOnASideWithoutTable) {
  for (const std::uint64_t image_latency : {1U, 2U}) {
    Lane lane(16, 2, static_cast<int>(image_latency), false, 1);
    Intents pixel;
    for (std::uint64_t cycle = 0; cycle < 9; ++cycle) {
      pixel.push_back(lane.step().pixel);
      EXPECT_EQ(lane.consumed_now, cycle >= image_latency);
    }
    EXPECT_EQ(pixel, (Intents{kRequest, kRequest, kRequest, kRequest, kPass, kPass, kPass, kPass, kIdle}));
  }
}

TEST(LaneControl, RefusesADepthOutsideItsRange) {
  const FrameGeometry geometry(config(2));
  EXPECT_NO_THROW(LaneControl(geometry, true, 1));
  EXPECT_NO_THROW(LaneControl(geometry, true, 64));
  EXPECT_THROW(LaneControl(geometry, true, 0), std::invalid_argument);
  EXPECT_THROW(LaneControl(geometry, true, 65), std::invalid_argument);
}

TEST(LaneControl, RefusesAReadLatencyThatItCannotHold) {
  for (const int latency : {1, 2}) EXPECT_NO_THROW(Lane(1, latency, latency));
  for (const int latency : {0, 3}) {
    EXPECT_THROW(Lane(1, latency, 2), std::invalid_argument);
    EXPECT_THROW(Lane(1, 2, latency), std::invalid_argument);
    EXPECT_NO_THROW(Lane(1, latency, 2, false));  // without a table its latency has no effect
  }
}

TEST(LaneControl, StartsTheNextFrameFromTheFirstSlotWithItsOwnLatencies) {
  Lane lane(16, 2, 2, true, 1);
  for (int cycle = 0; cycle < 20; ++cycle) lane.step();
  EXPECT_EQ(lane.control.consumed(), 8U);
  lane.control.start_frame(1, 1);
  EXPECT_EQ(lane.pixel(2), (Intents{kIdle, kRequest}));
  lane.step();
  EXPECT_TRUE(lane.consumed_now);
  EXPECT_EQ(lane.control.consumed(), 9U);  // over all frames
}

}  // namespace
}  // namespace stereotlm::fpga
