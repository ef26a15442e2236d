#include "models/memory/memory_config.h"

#include <gtest/gtest.h>

namespace stereotlm::memory {
namespace {

using Problems = std::vector<std::string>;

TEST(SsramBankConfig, AcceptsTheEndsOfEachRange) {
  EXPECT_EQ(problems(SsramBankConfig{}), Problems{});
  EXPECT_EQ(problems(SsramBankConfig{1, BankKind::kZbtFlowThrough, 0, 1}), Problems{});
  EXPECT_EQ(problems(SsramBankConfig{1U << 26U, BankKind::kSyncBurst, 1, 1000}), Problems{});
  EXPECT_EQ(problems(SsramBankConfig{1, BankKind::kSyncBurst, 16, 40}), Problems{});
}

TEST(SsramBankConfig, RefusesWhatLiesBeyondThem) {
  const std::string words_rule = ": must be 1..67108864";
  const std::string turnaround_rule = ": must be 1..16 with sync_burst, else 0";
  EXPECT_EQ(problems(SsramBankConfig{0}), Problems{"words = 0" + words_rule});
  EXPECT_EQ(problems(SsramBankConfig{(1U << 26U) + 1}), Problems{"words = 67108865" + words_rule});
  EXPECT_EQ(problems(SsramBankConfig{8, BankKind::kSyncBurst, 0}),
            Problems{"turnaround_cycles = 0" + turnaround_rule});
  EXPECT_EQ(problems(SsramBankConfig{8, BankKind::kSyncBurst, 17}),
            Problems{"turnaround_cycles = 17" + turnaround_rule});
  EXPECT_EQ(problems(SsramBankConfig{8, BankKind::kZbtPipelined, 1}),
            Problems{"turnaround_cycles = 1" + turnaround_rule});
  EXPECT_EQ(problems(SsramBankConfig{8, BankKind::kZbtPipelined, 0, 0.5}),
            Problems{"clock_mhz = 0.500000: must be 1..1000"});
  EXPECT_EQ(problems(SsramBankConfig{8, BankKind::kZbtPipelined, 0, 1000.5}).size(), 1U);
}

TEST(ArbiterConfig, RefusesAListThatNamesAPortTwice) {
  ArbiterConfig config;
  EXPECT_EQ(problems(config), Problems{});
  config.priority[0] = Port::kResult;
  EXPECT_EQ(problems(config), (Problems{"priority = result 2 times: must name each port once",
                                        "priority = host 0 times: must name each port once"}));
}

TEST(BankKind, HasTheReadLatencyOfItsDataSheet) {
  EXPECT_EQ(read_latency_cycles(BankKind::kZbtPipelined), 2);
  EXPECT_EQ(read_latency_cycles(BankKind::kZbtFlowThrough), 1);
  EXPECT_EQ(read_latency_cycles(BankKind::kSyncBurst), 2);
}

}  // namespace
}  // namespace stereotlm::memory
