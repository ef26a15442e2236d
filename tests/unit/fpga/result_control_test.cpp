#include "models/fpga/result_control.h"

#include <gtest/gtest.h>

namespace stereotlm::fpga {
namespace {

// Of an image of 6 rows: with 4 at once, 2 rows of the last strip lie inside.
ResultControl control_of(int delay, int fifo_words, int rows) {
  CoreConfig config;
  config.width = 8;
  config.height = 6;
  config.rows = rows;
  config.result_delay_cycles = delay;
  return ResultControl(FrameGeometry(config), fifo_words);
}

TEST(ResultControl, LetsAWordEnterAtTheEndOfTheCycleOfItsDelay) {
  for (const int delay : {0, 1, 16, 63, 64}) {
    ResultControl control = control_of(delay, 4, 1);
    control.commit(false, 1);
    for (int cycle = 0; cycle < delay; ++cycle) {
      EXPECT_EQ(control.decide(), Intent::kIdle) << delay;
      control.commit(false, 0);
    }
    EXPECT_EQ(control.decide(), Intent::kRequest) << delay;
    control.commit(true, 1);
    EXPECT_EQ(control.decide(), delay == 0 ? Intent::kRequest : Intent::kStarved) << delay;
  }
}

TEST(ResultControl, KeepsThePlaceOfAWordFromItsWayToItsWrite) {
  ResultControl control = control_of(3, 10, 4);
  // After each cycle: whether a word is written in it, words that leave, words in the queue, whether 4 places
  // are free.
  struct Cycle {
    bool granted;
    int leaving, queued;
    bool has_room;
  };
  for (const Cycle& cycle : {Cycle{false, 4, 0, true}, Cycle{false, 4, 0, false}, Cycle{false, 0, 0, false},
                             Cycle{false, 0, 4, false}, Cycle{true, 0, 7, false}, Cycle{true, 2, 6, false},
                             Cycle{true, 0, 5, false}, Cycle{true, 0, 4, true}, Cycle{false, 0, 6, true}}) {
    control.commit(cycle.granted, cycle.leaving);
    EXPECT_EQ(control.queued(), cycle.queued);
    EXPECT_EQ(control.has_room(), cycle.has_room);
  }
}

}  // namespace
}  // namespace stereotlm::fpga
