#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/plain_cycle_loop.h"
#include "tests/unit/support/worked_boards.h"

// The worked values of contract section 7 on 640 x 480 pixels. plain_cycle_loop_test.cpp has those of small
// boards.
namespace stereotlm::test {
namespace {

class PlainCycleLoopWorkedValues : public testing::TestWithParam<WorkedBoard> {};

TEST_P(PlainCycleLoopWorkedValues, ComeOut) {
  const PlainCycleResult result = run(GetParam());
  EXPECT_EQ(result.frame_cycles, std::vector<std::uint64_t>{GetParam().frame_cycles});
  EXPECT_THAT(blame_of(result), testing::IsSupersetOf(GetParam().blame));
}

INSTANTIATE_TEST_SUITE_P(
    Contract, PlainCycleLoopWorkedValues,
    testing::Values(WorkedBoard{"Rows2", [](auto& board) { board.rows = 2; }, 1'229'478},
                    WorkedBoard{"Rows2WithLog7",
                                [](auto& board) {
                                  board.rows = 2;
                                  with_log7(board);
                                },
                                1'229'502},
                    WorkedBoard{"Rows4", [](auto& board) { board.rows = 4; }, 768'844},
                    WorkedBoard{"Rows8", [](auto& board) { board.rows = 8; }, 615'568},
                    WorkedBoard{"Units40", [](auto& board) { board.units = 40; }, 4'301'969},
                    WorkedBoard{"Units27", [](auto& board) { board.units = 27; }, 6'452'943},
                    WorkedBoard{"Units40WithLineBuffers",
                                [](auto& board) {
                                  board.units = 40;
                                  board.fetch = PlainFetch::kLineBuffer;
                                },
                                618'425},
                    WorkedBoard{"TablesInTheBanksOfTheirImages",
                                [](auto& board) {
                                  board.left_lut = 0;
                                  board.right_lut = 2;
                                  board.word_cache = true;
                                },
                                2'685'395,
                                {"left_lut bank0 left_pixel 534400"}},
                    WorkedBoard{"LeftTableInTheBankOfItsImageWithoutCache",
                                [](auto& board) { board.left_lut = 0; }, 4'288'597},
                    WorkedBoard{"LeftTableInTheBankOfItsImageByAge",
                                [](auto& board) {
                                  board.left_lut = 0;
                                  board.arbitration = PlainArbitration::kAge;
                                },
                                4'287'317,
                                {"left_lut bank0 left_pixel 2136322", "left_pixel bank0 left_lut 2135042"}},
                    WorkedBoard{"ResultInAQdrBankOfAnImage",
                                [](auto& board) {
                                  board.banks[0].kind = PlainBankKind::kQdr;
                                  board.disparity = {0, 0};
                                },
                                2'150'995},
                    WorkedBoard{"TwoBanks", in_two_banks, 2'151'002, {"right_pixel bank1 left_pixel 7"}},
                    WorkedBoard{"TwoBanksWithLog7",
                                [](auto& board) {
                                  in_two_banks(board);
                                  with_log7(board);
                                },
                                2'151'023},
                    WorkedBoard{"TwoBanksWithLog7AndRows4",
                                [](auto& board) {
                                  in_two_banks(board);
                                  with_log7(board);
                                  board.rows = 4;
                                },
                                768'884},
                    WorkedBoard{"TwoBanksWithLineBuffers",
                                [](auto& board) {
                                  in_two_banks(board);
                                  board.fetch = PlainFetch::kLineBuffer;
                                },
                                461'811}),
    [](const auto& board) { return board.param.name; });

TEST(PlainCycleLoopTwoBanks, ReadEachWordOnceAStripAndPassTheOtherSlots) {
  const PlainCycleResult result = run({"", in_two_banks, 0});
  EXPECT_EQ(result.port(PlainPort::kLeftPixel).granted, 535'680U);
  EXPECT_EQ(result.port(PlainPort::kLeftPixel).passed, 1'614'720U);
  EXPECT_EQ(blame_of(result), std::vector<std::string>{"right_pixel bank1 left_pixel 7"});
}

}  // namespace
}  // namespace stereotlm::test
