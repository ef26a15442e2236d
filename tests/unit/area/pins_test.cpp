#include "models/area/pins.h"

#include <gtest/gtest.h>

namespace stereotlm::area {
namespace {

memory::SsramBankConfig bank_of(std::uint32_t words) {
  memory::SsramBankConfig bank;
  bank.words = words;
  return bank;
}

TEST(Pins, OfSsramFollowFromItsWords) {
  const std::pair<std::uint32_t, int> cases[] = {{1, 0}, {2, 1}, {3, 2}, {524288, 19}, {524289, 20}};
  for (const auto& [words, address] : cases) {
    const BankPins pins = pins_of(bank_of(words));
    EXPECT_EQ(pins.address, address) << words;
    EXPECT_EQ(pins.data, 32);
    EXPECT_EQ(pins.control, 10);
    EXPECT_EQ(pins.all(), 42 + address);
  }
}

// 16 data pins each way, with a bit on both edges of the clock.
TEST(Pins, OfQdrAreThoseOfOtherSsram) {
  memory::SsramBankConfig bank = bank_of(524288);
  const int of_zbt = pins_of(bank).all();
  bank.kind = memory::BankKind::kQdr;
  EXPECT_EQ(pins_of(bank).data, 32);
  EXPECT_EQ(pins_of(bank).all(), of_zbt);
}

// The row and the column share the pins. The column needs one bit more.
TEST(Pins, OfSdramFollowFromItsRowsAndColumns) {
  const auto address = [](std::uint32_t words, int row_words, int internal_banks) {
    memory::SsramBankConfig bank = bank_of(words);
    bank.sdram = memory::SdramTiming();
    bank.sdram->row_words = row_words;
    bank.sdram->internal_banks = internal_banks;
    return pins_of(bank).address;
  };
  EXPECT_EQ(address(4194304, 256, 4), 12 + 2);  // 4096 rows
  EXPECT_EQ(address(4194305, 256, 4), 13 + 2);  // 4097 rows
  EXPECT_EQ(address(524288, 256, 4), 9 + 2);    // 512 rows, 8 bits of a column and 1
  EXPECT_EQ(address(262144, 256, 4), 9 + 2);    // 256 rows, fewer bits than the column
  EXPECT_EQ(address(16, 256, 1), 9);
  EXPECT_EQ(address(4194304, 1024, 8), 11 + 3);  // 512 rows
}

TEST(Pins, PackagesAreThoseOfTheDataSheet) {
  ASSERT_NE(find_package("ff1152"), nullptr);
  EXPECT_EQ(find_package("ff1152")->user_pins, 824);
  EXPECT_EQ(find_package("ff1517")->user_pins, 1104);
  EXPECT_EQ(find_package("FF1517"), nullptr);
}

}  // namespace
}  // namespace stereotlm::area
