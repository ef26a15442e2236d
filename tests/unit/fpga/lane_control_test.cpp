#include "models/fpga/lane_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

// 4 x `height` pixels, 3 x 3 windows, line buffers: slots row by row, and one row of empty slots at the end.
FrameGeometry geometry_of(int height) { return FrameGeometry(small_core(4, height, 1, Fetch::kLineBuffer)); }

struct LaneSetting {
  int fifo_slots = 16;
  int table_latency = 2;
  int image_latency = 2;
  bool has_table = true;
  int height = 2;
  PixelCache cache = PixelCache::kNone;
};

// Cycles of a lane, one character per cycle.
struct Cycles {
  const char* claim;
  LaneSetting setting = {};
  // Expected. Intents: R request, P pass, I idle, B blocked, S starved. `consumed`: 1 if a slot is consumed,
  // else 0. Cycles beyond the end of a text are not checked.
  std::string lut = "";
  std::string pixel = "";
  std::string consumed = "";
  // Inputs of each cycle, 1 or 0. The last character also holds for all later cycles.
  std::string grants_lut = "1";
  std::string grants_pixel = "1";
  std::string needs_pixel = "1";
  std::string consumes = "1";  // if the lane is ready
};

void PrintTo(const Cycles& cycles, std::ostream* out) { *out << cycles.claim; }

bool at(const std::string& given, std::size_t cycle) {
  return given[std::min(cycle, given.size() - 1)] == '1';
}

char letter_of(Intent intent) { return "RPIBS"[static_cast<std::size_t>(intent)]; }

// Runs the cycles and compares them with those expected.
void expect_cycles(LaneControl& lane, const Cycles& cycles) {
  const std::size_t count = std::max({cycles.lut.size(), cycles.pixel.size(), cycles.consumed.size()});
  std::string lut;
  std::string pixel;
  std::string consumed;
  for (std::size_t cycle = 0; cycle < count; ++cycle) {
    const LaneControl::Decision decision = lane.decide();
    const bool consumes = at(cycles.consumes, cycle) && lane.ready();
    lut += letter_of(decision.lut);
    pixel += letter_of(decision.pixel);
    consumed += consumes ? '1' : '0';
    lane.commit(decision, at(cycles.grants_lut, cycle) && decision.lut == Intent::kRequest,
                at(cycles.grants_pixel, cycle) && decision.pixel == Intent::kRequest,
                at(cycles.needs_pixel, cycle), consumes);
  }
  EXPECT_EQ(lut.substr(0, cycles.lut.size()), cycles.lut);
  EXPECT_EQ(pixel.substr(0, cycles.pixel.size()), cycles.pixel);
  EXPECT_EQ(consumed.substr(0, cycles.consumed.size()), cycles.consumed);
}

class LaneCycles : public testing::TestWithParam<Cycles> {};

TEST_P(LaneCycles, AreThoseOfTheContract) {
  const LaneSetting& setting = GetParam().setting;
  LaneControl lane(geometry_of(setting.height), setting.has_table, setting.cache, setting.fifo_slots);
  lane.start_frame(setting.table_latency, setting.image_latency);
  expect_cycles(lane, GetParam());
}

// The entries of a full lane, every third one valid, while the first slot waits for its grant.
std::string in_64_slots(char valid, char invalid) {
  std::string slots;
  for (int slot = 0; slot < 64; ++slot) slots += slot % 3 == 0 ? valid : invalid;
  return slots;
}

// Claim and setting; expected lut, pixel, consumed; given grants_lut, grants_pixel, needs_pixel, consumes.
const std::vector<Cycles> kCycles = {
    {"TakeASlotWithOnePlaceLeftAndNoneWithout", {3}, "RRRBB", "", "", "1", "0"},
    {"CountASlotThatIsConsumedAsStillInTheLane", {1, 1, 1}, "RBBR", "", "0010"},
    // A slot stays for both latencies and the cycle in which it is consumed.
    {"RunWithoutPauseIfThePlacesCoverTheLatencies", {5, 2, 2, true, 8}, "RRRRRRRRRRRRRRRRRRRR"},
    {"PauseIfOnePlaceIsMissing", {4, 2, 2, true, 8}, "RRRRBR"},
    {"HandleAndConsumeASlotAtTheLatencies", {16, 2, 2}, "", "IIR", "00001"},
    {"HandleAndConsumeASlotAtAShortTableLatency", {16, 1, 2}, "", "IR", "0001"},
    {"HandleAndConsumeASlotAtShortLatencies", {16, 1, 1}, "", "IR", "001"},
    {"RequestAgainAfterARefusal", {2, 1, 1}, "RRRRRBB", "IIIIRRRRR", "000000001", "0001", "00000001"},
    {"PassASlotWithoutValidEntry", {16, 2, 1}, "", "IIRPPR", "", "1", "1", "100111"},
    {"KeepTheEntriesOfAFullLaneInOrder",
     {64, 2, 2, true, 32},
     std::string(64, 'R') + 'B',
     "II" + std::string(63, 'R') + in_64_slots('R', 'P'),
     "",
     "1",
     std::string(65, '0') + '1',
     in_64_slots('1', '0'),
     "0"},
    // Four pixels, then four empty slots.
    {"PassEmptySlotsAtBothPortsWithTheSameLatencies",
     {16, 2, 2, true, 1},
     "RRRRPPPPI",
     "IIRRRRPPPPI",
     "0000111111110"},
    {"StarveThePixelPortBetweenItsFirstAndItsLastSlot",
     {16, 1, 1, true, 1},
     "",
     "IIIIRSSSRRRPPPPI",
     "",
     "00010001"},
    {"BlockOnlyAPortThatTakesSlots", {2, 1, 1}, "RRBBB", "IRRSS", "", "1", "1", "1", "0"},
    {"LetThePixelPortTakeTheSlotsOfASideWithoutTable", {2, 2, 2, false}, "IIII", "RRBR", "0011"},
    {"NeedOnlyTheImagesLatencyOnASideWithoutTable", {16, 2, 2, false, 1}, "", "RRRRPPPPI", "001111111"},
    // The first pixel of each of two words.
    {"PassThePixelsOfACachedWordOnASideWithoutTable",
     {16, 2, 2, false, 2, PixelCache::kWord},
     "",
     "RPPPRPPPPPPPI",
     "001111"},
    {"NeedOnlyAShortImageLatencyOnASideWithoutTable", {16, 2, 1, false, 1}, "", "RRRRPPPPI", "011111111"},
};

INSTANTIATE_TEST_SUITE_P(LaneControl, LaneCycles, testing::ValuesIn(kCycles),
                         [](const auto& suite) { return std::string(suite.param.claim); });

TEST(LaneControl, StartsTheNextFrameFromTheFirstSlotWithItsOwnLatencies) {
  LaneControl lane(geometry_of(1), true, PixelCache::kNone, 16);
  lane.start_frame(2, 2);
  Cycles cycles{""};
  cycles.consumed = "00001111111100000000";
  expect_cycles(lane, cycles);
  EXPECT_EQ(lane.consumed(), 8U);
  lane.start_frame(1, 1);
  cycles.pixel = "IR";
  cycles.consumed = "001";
  expect_cycles(lane, cycles);
  EXPECT_EQ(lane.consumed(), 9U);  // over all frames
}

TEST(LaneControl, RefusesADepthOrAReadLatencyOutsideItsRange) {
  const FrameGeometry geometry = geometry_of(2);
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

}  // namespace
}  // namespace stereotlm::fpga
