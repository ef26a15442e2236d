#include "sw/explore/conditions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "platform/board_yaml.h"

namespace stereotlm::explore {
namespace {

using ::testing::HasSubstr;

bool holds(const std::string& text, const std::vector<std::string>& sets = {}) {
  auto values = values_of(platform::load_board("fpl2003", sets));
  values.push_back({"run.source", "preloaded"});
  values.push_back({"run.frames", std::int64_t{6}});
  return Conditions({text}).hold(values);
}

TEST(Conditions, CompareKeysOfTheBoardAsItsFileNamesThem) {
  EXPECT_TRUE(holds("image.width * image.height <= 307200"));
  EXPECT_FALSE(holds("image.width * image.height < 307200"));
  EXPECT_TRUE(holds("cameras.frame_rate_hz > 29.9 AND cameras.frame_rate_hz < 30"));
  EXPECT_TRUE(holds("matcher.filter = 'log7'"));
  EXPECT_TRUE(holds("allocation.left_image = '[bank0, bank1]'"));
  EXPECT_TRUE(holds("allocation.left_lut = 'none'", {"allocation.left_lut=none"}));
  EXPECT_TRUE(holds("board.name = 'fpl2003'"));
  EXPECT_TRUE(holds("ssram.banks = 8"));
  EXPECT_TRUE(holds("run.frames = 6 AND run.source = 'preloaded'"));
}

TEST(Conditions, TakeNullForNo) {
  EXPECT_FALSE(holds("NULL"));
  EXPECT_FALSE(holds("pci.\"load.burst_words\" = 32"));
  EXPECT_TRUE(holds("pci.\"load.burst_words\" IS NULL"));
}

TEST(Conditions, AllHaveToHold) {
  const auto values = values_of(platform::load_board("fpl2003"));
  EXPECT_TRUE(Conditions({}).hold(values));
  EXPECT_TRUE(Conditions({"image.width = 640", "image.height = 480"}).hold(values));
  EXPECT_FALSE(Conditions({"image.width = 640", "image.height = 481"}).hold(values));
}

TEST(Conditions, MayBeAskedAgainForOtherBoards) {
  Conditions conditions({"image.width = 640"});
  EXPECT_TRUE(conditions.hold(values_of(platform::load_board("fpl2003"))));
  EXPECT_FALSE(conditions.hold(values_of(platform::load_board("fpl2003", {"image.width=320"}))));
  EXPECT_TRUE(conditions.hold(values_of(platform::load_board("fpl2003"))));
  Conditions of_load({"pci.\"load.burst_words\" = 8"});
  EXPECT_TRUE(of_load.hold(
      values_of(platform::load_board("fpl2003", {"pci.load={burst_words: 8, interval_us: 10}"}))));
  EXPECT_FALSE(of_load.hold(values_of(platform::load_board("fpl2003"))));
}

TEST(Conditions, CountAsBanksWhatLiesBelowThem) {
  const std::int64_t one = 1;
  EXPECT_TRUE(Conditions({"ssram.banks = 2"})
                  .hold({{"ssram.banks.a.words", one},
                         {"ssram.default.words", one},
                         {"ssram.banks.a.turnaround_cycles", one},
                         {"ssram.banks.words.words", one}}));
}

std::string refusal(const std::string& text) {
  try {
    const Conditions conditions({text});
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(Conditions, AreRefusedWithTheReason) {
  EXPECT_THAT(refusal("image.widht = 640"), HasSubstr("no such column: image.widht"));
  EXPECT_THAT(refusal("clock_mhz = 40"), HasSubstr("ambiguous column name: clock_mhz"));
  EXPECT_THAT(refusal("matcher.filter = \"log7\""), HasSubstr("no such column: log7"));
  EXPECT_THAT(refusal("image.width ="), HasSubstr("syntax error"));
  EXPECT_THAT(refusal("1)); DELETE FROM points; SELECT ((1"), HasSubstr("more than one"));
  EXPECT_EQ(refusal("1 -- a comment"), "");
}

}  // namespace
}  // namespace stereotlm::explore
