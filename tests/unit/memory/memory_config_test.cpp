#include "models/memory/memory_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {
namespace {

using testing::ElementsAre;
using testing::StartsWith;
using Problems = std::vector<std::string>;

TEST(BankTraits, HaveTheLatenciesAndTurnaroundsOfTheDataSheets) {
  const std::vector<BankTraits> expected = {{BankKind::kZbtPipelined, "zbt_pipelined", 2, false, 1},
                                            {BankKind::kZbtFlowThrough, "zbt_flow_through", 1, false, 1},
                                            {BankKind::kSyncBurst, "sync_burst", 2, true, 1},
                                            {BankKind::kQdr, "qdr", 2, false, 2},  // QDR-II SRAM
                                            {BankKind::kSdram, "sdram", 0, false, 1}};
  ASSERT_EQ(kBankTraits.size(), expected.size());
  for (const BankTraits& traits : expected) {
    EXPECT_STREQ(traits_of(traits.kind).name, traits.name);
    EXPECT_EQ(traits_of(traits.kind).read_latency_cycles, traits.read_latency_cycles) << traits.name;
    EXPECT_EQ(traits_of(traits.kind).has_turnaround, traits.has_turnaround) << traits.name;
    EXPECT_EQ(traits_of(traits.kind).ports, traits.ports) << traits.name;
  }
}

TEST(SsramBankConfig, RefusesWhatLiesBeyondThem) {
  const std::vector<std::pair<SsramBankConfig, std::string>> refused = {
      {{0}, "words = 0: must be 1..67108864"},
      {{(1U << 26U) + 1}, "words = 67108865: must be 1..67108864"},
      {{8, BankKind::kSyncBurst, 0}, "turnaround_cycles = 0: must be 1..16 for sync_burst"},
      {{8, BankKind::kSyncBurst, 17}, "turnaround_cycles = 17: must be 1..16 for sync_burst"},
      {{8, BankKind::kZbtPipelined, 1}, "turnaround_cycles = 1: must be 0 for zbt_pipelined"},
      {{8, BankKind::kQdr, 1}, "turnaround_cycles = 1: must be 0 for qdr"},
      {{8, static_cast<BankKind>(kBankTraits.size())},
       "kind = " + std::to_string(kBankTraits.size()) + ": must be a BankKind"},
      {{8, BankKind::kZbtPipelined, 0, 0.5}, "clock_mhz = 0.500000: must be 1..1000"},
      {{8, BankKind::kZbtPipelined, 0, 1000.5}, "clock_mhz = 1000.500000: must be 1..1000"}};
  for (const auto& [config, problem] : refused) EXPECT_EQ(problems(config), Problems{problem});
}

TEST(ArbiterConfig, RefusesAnUnknownPolicyAndAListThatDoesNotNameEachPortOnce) {
  ArbiterConfig config = arbiter_of("lottery");
  config.priority[0] = port::kResult;
  EXPECT_THAT(problems(config), ElementsAre(StartsWith("policy = lottery: must be one of fixed_priority, "),
                                            "priority: port 4 is named 2 times: must be once",
                                            "priority: port 5 is named 0 times: must be once"));
}

TEST(ArbiterConfig, HasOneToSixtySixPorts) {
  const auto problems_with = [](std::size_t ports) {
    ArbiterConfig config;
    for (Port port = 0; port < ports; ++port) config.priority.push_back(port);
    return problems(config);
  };
  EXPECT_EQ(problems_with(0), Problems{"priority = 0 ports: must be 1..66"});
  EXPECT_EQ(problems_with(1), Problems{});
  EXPECT_EQ(problems_with(66), Problems{});
  EXPECT_EQ(problems_with(67), Problems{"priority = 67 ports: must be 1..66"});
}

}  // namespace
}  // namespace stereotlm::memory
