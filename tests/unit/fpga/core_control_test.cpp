#include "models/fpga/core_control.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace stereotlm::fpga {
namespace {

using memory::mask_of;
using memory::Port;
using memory::PortMask;

CoreConfig small_core(Fetch fetch = Fetch::kColumn) {
  CoreConfig config;
  config.width = 8;
  config.height = 2;
  config.window = 3;
  config.disparities = 2;
  config.filter.reset();
  config.fetch = fetch;
  return config;
}

TEST(MatchControl, ConsumesOnlyWhatBothLanesHaveAndTheResultQueueCanTake) {
  MatchControl match{FrameGeometry(small_core())};
  match.start_frame();
  EXPECT_TRUE(match.decide(true, true));
  EXPECT_FALSE(match.decide(false, true));
  EXPECT_FALSE(match.decide(true, false));
}

TEST(MatchControl, NeedsSlotsUpToTheLastOneAndNoneInTheDrain) {
  const FrameGeometry geometry(small_core());
  MatchControl match(geometry);
  match.start_frame();
  for (std::uint64_t slot = 0; slot < geometry.slots; ++slot) {
    EXPECT_FALSE(match.draining());
    EXPECT_FALSE(match.decide(false, true));
    match.consume();
  }
  for (std::uint64_t cycle = 0; cycle < geometry.drain_cycles; ++cycle) {
    EXPECT_TRUE(match.draining());
    EXPECT_TRUE(match.decide(false, true));
    EXPECT_FALSE(match.decide(false, false));
    match.consume();
  }
  EXPECT_FALSE(match.decide(true, true));
}

TEST(MatchControl, CompletesAWordWithTheColumnOfItsLastResult) {
  for (const Fetch fetch : {Fetch::kColumn, Fetch::kLineBuffer}) {
    CoreConfig config = small_core(fetch);
    config.filter = kernels::log7();
    const FrameGeometry geometry(config);
    MatchControl match(geometry);
    for (int frame = 0; frame < 2; ++frame) {
      match.start_frame();
      std::uint64_t words = 0;
      const auto per_column = static_cast<std::uint64_t>(geometry.slots_per_column);
      for (std::uint64_t cycle = 0; cycle < geometry.slots + geometry.drain_cycles; ++cycle) {
        // Result i leaves when column i + C is complete; i mod 4 = 3 completes a word.
        const std::uint64_t column = cycle / per_column;
        const bool last_of_column = cycle % per_column == per_column - 1;
        const bool word = last_of_column && column >= geometry.result_delay_columns &&
                          (column - geometry.result_delay_columns) % 4 == 3;
        EXPECT_EQ(match.consume() && match.word_leaves(), word) << cycle;
        words += std::uint64_t{word};
      }
      EXPECT_EQ(words, geometry.result_words);
    }
  }
}

TEST(ResultControl, HasRoomForOneLessThanItsDepthAndNoMore) {
  ResultControl result(FrameGeometry(small_core()), 2);
  result.start_frame();
  EXPECT_TRUE(result.has_room());
  result.commit(false, true);
  EXPECT_TRUE(result.has_room());
  result.commit(false, true);
  EXPECT_FALSE(result.has_room());
  result.commit(true, false);
  EXPECT_TRUE(result.has_room());
}

TEST(ResultControl, RequestsFromTheCycleAfterAWordEntered) {
  ResultControl result(FrameGeometry(small_core()), 8);
  result.start_frame();
  EXPECT_EQ(result.decide(), Intent::kIdle);
  result.commit(false, true);
  EXPECT_EQ(result.decide(), Intent::kRequest);
  result.commit(false, false);
  EXPECT_EQ(result.decide(), Intent::kRequest);
  result.commit(true, false);
  EXPECT_EQ(result.decide(), Intent::kStarved);
}

TEST(ResultControl, TakesAndGivesAWordInOneCycle) {
  ResultControl result(FrameGeometry(small_core()), 1);
  result.start_frame();
  result.commit(false, true);
  result.commit(true, true);
  EXPECT_EQ(result.decide(), Intent::kRequest);
  EXPECT_FALSE(result.has_room());
}

TEST(ResultControl, IsDoneWithTheLastWordAndIdleThen) {
  const FrameGeometry geometry(small_core());  // four words
  ResultControl result(geometry, 8);
  for (int frame = 0; frame < 2; ++frame) {
    result.start_frame();
    for (std::uint64_t word = 0; word < geometry.result_words; ++word) {
      EXPECT_FALSE(result.frame_done());
      result.commit(false, true);
      EXPECT_FALSE(result.frame_done());
      result.commit(true, false);
    }
    EXPECT_TRUE(result.frame_done());
    EXPECT_EQ(result.decide(), Intent::kIdle);
  }
}

// Steps a core whose requests are all granted, except those in `refused`, until the frame is done; returns
// the cycles.
std::uint64_t run_frame(CoreControl& core, PortMask refused = 0, std::uint64_t refused_cycles = 0) {
  std::uint64_t cycles = 0;
  while (!core.frame_done() && cycles < 10'000) {
    const CoreControl::Decision decision = core.decide();
    const PortMask requests = decision.requests();
    const auto granted = cycles < refused_cycles ? static_cast<PortMask>(requests & ~refused) : requests;
    core.commit(decision, granted, {true, true});
    core.count_host(false, false);
    ++cycles;
  }
  return cycles;
}

TEST(CoreControl, TakesTheLatenciesTheSlotsTheDrainAndTheLastWrite) {
  for (const Fetch fetch : {Fetch::kColumn, Fetch::kLineBuffer}) {
    CoreControl core(small_core(fetch));
    const FrameGeometry& geometry = core.geometry();
    const std::uint64_t work = geometry.slots + geometry.drain_cycles + 1;
    core.start_frame({2, 2, 2, 2});
    EXPECT_EQ(run_frame(core), 4 + work);
    core.start_frame({1, 2, 1, 1});  // the slower side decides
    EXPECT_EQ(run_frame(core), 3 + work);
    core.start_frame({1, 1, 1, 1});
    EXPECT_EQ(run_frame(core), 2 + work);
  }
}

TEST(CoreControl, NeedsNoTableLatencyWithoutTables) {
  CoreConfig config = small_core();
  config.left_table = false;
  CoreControl left_only(config);
  left_only.start_frame({2, 2, 2, 2});
  const std::uint64_t work = left_only.geometry().slots + left_only.geometry().drain_cycles + 1;
  EXPECT_EQ(run_frame(left_only), 4 + work);
  EXPECT_EQ(left_only.port_cycles(Port::kLeftLut).idle(), 4 + work);
  config.right_table = false;
  CoreControl neither(config);
  neither.start_frame({2, 2, 2, 2});
  EXPECT_EQ(run_frame(neither), 2 + work);
}

TEST(CoreControl, ConsumesBothLanesTogether) {
  CoreControl core(small_core());
  core.start_frame({1, 1, 1, 1});
  const std::uint64_t alone = core.geometry().slots + core.geometry().drain_cycles + 1 + 2;
  // The first slot is empty; the second is refused in cycles 1 to 9.
  EXPECT_EQ(run_frame(core, mask_of(Port::kRightLut), 10), alone + 9);
  EXPECT_EQ(core.lane(Side::kLeft).consumed(), core.geometry().slots);
  EXPECT_EQ(core.lane(Side::kRight).consumed(), core.geometry().slots);
}

TEST(CoreControl, PutsEachPortIntoOneStateACycle) {
  CoreControl core(small_core());
  std::uint64_t cycles = 0;
  for (int frame = 0; frame < 3; ++frame) {
    core.start_frame({2, 1, 2, 1});
    cycles += run_frame(core, mask_of(Port::kLeftPixel), static_cast<std::uint64_t>(frame * 7));
  }
  for (std::size_t port = 0; port < memory::kPortCount; ++port)
    EXPECT_EQ(core.port_cycles(static_cast<Port>(port)).sum(), cycles) << memory::kPortNames[port];
}

TEST(CoreControl, CountsWhatTheHostPortDid) {
  CoreControl core(small_core());
  core.count_host(false, false);
  core.count_host(true, false);
  core.count_host(true, false);
  core.count_host(true, true);
  const PortCycles& host = core.port_cycles(Port::kHost);
  EXPECT_EQ(host.idle(), 1U);
  EXPECT_EQ(host.stalled(), 2U);
  EXPECT_EQ(host.granted(), 1U);
  EXPECT_EQ(host.sum(), 4U);
}

// The result port of small_core() with this queue, refused in the cycles before `refused_cycles`.
std::uint64_t run_with_queue(int fifo_words, std::uint64_t refused_cycles, std::uint64_t& stalls) {
  CoreConfig config = small_core();
  config.result_fifo_words = fifo_words;
  CoreControl core(config);
  core.start_frame({1, 1, 1, 1});
  const std::uint64_t cycles = run_frame(core, mask_of(Port::kResult), refused_cycles);
  stalls = core.port_cycles(Port::kResult).stalled();
  return cycles;
}

TEST(CoreControl, StopsTheMatcherWhileTheResultQueueIsFull) {
  const FrameGeometry geometry(small_core());
  const std::uint64_t alone = 2 + geometry.slots + geometry.drain_cycles + 1;
  // The lanes are consumed from cycle 2 on; the first word enters at the end of this cycle.
  const std::uint64_t first_word = 2 + (geometry.result_delay_columns + 4) * 3 - 1;
  std::uint64_t stalls = 0;
  // One place: the queue is full in the cycle in which each word is written, the last one stops nothing.
  const std::uint64_t one_place = alone + geometry.result_words - 1;
  EXPECT_EQ(run_with_queue(1, 0, stalls), one_place);
  EXPECT_EQ(run_with_queue(1, first_word + 1, stalls), one_place);
  EXPECT_EQ(stalls, 0U);
  EXPECT_EQ(run_with_queue(1, first_word + 2, stalls), one_place + 1);
  EXPECT_EQ(stalls, 1U);
}

TEST(CoreControl, LosesNothingToAStallWhileTheResultQueueHasRoom) {
  const FrameGeometry geometry(small_core());
  const std::uint64_t alone = 2 + geometry.slots + geometry.drain_cycles + 1;
  const std::uint64_t first_word = 2 + (geometry.result_delay_columns + 4) * 3 - 1;
  std::uint64_t stalls = 0;
  EXPECT_EQ(run_with_queue(2, 0, stalls), alone);
  EXPECT_EQ(run_with_queue(2, first_word + 3, stalls), alone);
  EXPECT_EQ(stalls, 2U);
}

TEST(CoreControl, NamesTheRequestsAndPassesOfACycle) {
  CoreControl core(small_core());
  core.start_frame({1, 1, 1, 1});
  CoreControl::Decision decision = core.decide();  // the first slot lies above the image
  EXPECT_EQ(decision.requests(), 0);
  EXPECT_EQ(decision.passes(), mask_of(Port::kLeftLut) | mask_of(Port::kRightLut));
  core.commit(decision, 0, {});
  decision = core.decide();
  EXPECT_EQ(decision.requests(), mask_of(Port::kLeftLut) | mask_of(Port::kRightLut));
  EXPECT_EQ(decision.passes(), mask_of(Port::kLeftPixel) | mask_of(Port::kRightPixel));
}

TEST(CoreControl, RefusesAConfigurationWithProblems) {
  CoreConfig config = small_core();
  config.window = 4;
  EXPECT_THROW(CoreControl{config}, std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::fpga
