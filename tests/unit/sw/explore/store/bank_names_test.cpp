#include "sw/explore/store/bank_names.h"

#include <gtest/gtest.h>

#include "platform/config/board_yaml.h"

namespace stereotlm::explore {
namespace {

TEST(BankNames, DifferInCase) {
  EXPECT_TRUE(differ_in_case("bank_A", "bank_a"));
  EXPECT_FALSE(differ_in_case("bank_a", "bank_a"));
  EXPECT_FALSE(differ_in_case("bank_a", "bank_b"));
  EXPECT_FALSE(differ_in_case("bank", "bank_a"));
}

TEST(BankNames, OfABoardAreAProblemIfTwoDifferOnlyInCase) {
  platform::BoardConfig board = platform::load_board("fpl2003");
  EXPECT_EQ(bank_names_problem(board), std::nullopt);
  board.banks.back().name = "Bank0";
  EXPECT_EQ(
      bank_names_problem(board),
      "ssram.banks = bank0, Bank0: the names differ only in case: a database could not tell their columns "
      "apart");
}

}  // namespace
}  // namespace stereotlm::explore
