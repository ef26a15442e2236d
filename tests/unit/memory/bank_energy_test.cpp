#include "models/memory/bank_energy.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace stereotlm::memory {
namespace {

// What a bank of this kind takes that does so much in a second, in watts.
double watts(BankKind kind, double accesses, double rows = 0, double refreshes = 0) {
  const auto count = [](double number) { return static_cast<std::uint64_t>(number); };
  return 1e-12 *
         static_cast<double>(energy_pj(kBankEnergies[static_cast<std::size_t>(kind)], 1'000'000'000'000,
                                       count(accesses), count(rows), count(refreshes)));
}

// Contract 9.1: the parts, their supplies and currents.
TEST(BankEnergy, GivesTheCurrentsOfTheSheetsAgain) {
  constexpr double kPrecision = 1e-4;
  for (const BankKind kind : {BankKind::kZbtPipelined, BankKind::kZbtFlowThrough, BankKind::kSyncBurst}) {
    EXPECT_NEAR(watts(kind, 0), 3.3 * 0.080, kPrecision);
    EXPECT_NEAR(watts(kind, 100e6), 3.3 * 0.320, kPrecision);
  }
  EXPECT_NEAR(watts(BankKind::kQdr, 0), 1.8 * 0.200, kPrecision);
  EXPECT_NEAR(watts(BankKind::kQdr, 2 * 167e6), 1.8 * 0.300, kPrecision);
  EXPECT_NEAR(watts(BankKind::kSdram, 0), 3.3 * 0.055, kPrecision);                   // IDD3
  EXPECT_NEAR(watts(BankKind::kSdram, 1e9 / 7), 3.3 * 0.175, kPrecision);             // IDD4
  EXPECT_NEAR(watts(BankKind::kSdram, 2e9 / 70, 1e9 / 70), 3.3 * 0.165, kPrecision);  // IDD1
  EXPECT_NEAR(watts(BankKind::kSdram, 0, 0, 1e9 / 70), 3.3 * 0.320, kPrecision);      // IDD5
}

TEST(BankEnergy, RoundsTheStandbyHalvesUpAndNothingElse) {
  const BankEnergy bank{0.001, 7, 11, 13};  // 1 uW
  EXPECT_EQ(energy_pj(bank, 499'999, 0, 0, 0), 0U);
  EXPECT_EQ(energy_pj(bank, 1'499'999, 2, 3, 5), 1U + 14 + 33 + 65);
  EXPECT_EQ(energy_pj(bank, 1'500'000, 0, 0, 0), 2U);
  // 64 bits of uW * ps would not hold a week at the greatest power.
  EXPECT_EQ(energy_pj({kMostStandbyMw, 0}, 604'800'000'000'000'000U, 0, 0, 0), 6'048'000'000'000'000'000U);
}

}  // namespace
}  // namespace stereotlm::memory
