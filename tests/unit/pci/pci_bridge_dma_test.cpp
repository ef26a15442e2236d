// The DMA channels of the bridge.
#include <ostream>
#include <string>

#include "tests/unit/pci/pci_bridge_bench.h"

namespace stereotlm::pci {
namespace {

class PciBridgeDma : public PciBridgeBench {
 protected:
  static constexpr std::uint32_t kChain = 0x100;
  static constexpr std::uint32_t kData = 0x1000;
};

TEST_F(PciBridgeDma, IsBusyUntilTheLastWordHasArrivedAndRefusesAStartMeanwhile) {
  build();
  for (const std::uint32_t channel : {0U, 1U}) {
    write_register(bridge::kDmaControl + channel * bridge::kChannelStride, 2);  // not the start bit
    EXPECT_EQ(read_register(bridge::kDmaStatus + channel * bridge::kChannelStride), 0U);
    local.held = true;
    start(channel, kChain, {{kData, 0, 4}});
    run(20);
    EXPECT_EQ(read_register(bridge::kDmaStatus + channel * bridge::kChannelStride), 1U);
    EXPECT_EQ(status(), 0U);
    EXPECT_EQ(dut->control().words_taken().total(), 4U * (channel + 1));
    EXPECT_EQ(dut->control().words_held().total(), 0U);  // all on the local bus
    start(channel, kChain);
    EXPECT_EQ(status(), bridge::kDmaError << channel);
    local.release();
    run(5);
    EXPECT_EQ(read_register(bridge::kDmaStatus + channel * bridge::kChannelStride), 0U);
    EXPECT_EQ(status(), (bridge::kDmaError | bridge::kDmaDone) << channel);
    EXPECT_EQ(local.bursts.size(), channel + 1U);
    write_register(bridge::kInterruptStatus, bridge::kAllInterrupts);
  }
}

// A descriptor for channel 1, and a word on the board whose accesses are refused.
struct Broken {
  const char* name;
  std::uint32_t chain;
  std::uint32_t pci;
  std::uint32_t words;
  std::uint64_t refused_address;
};
void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

class PciBridgeDmaError : public PciBridgeDma, public testing::WithParamInterface<Broken> {};

TEST_P(PciBridgeDmaError, StopsTheChannelUntilItsNextStart) {
  const Broken& broken = GetParam();
  build();
  local.refused_address = broken.refused_address;
  host.debug_write(broken.chain, {broken.pci, 0, broken.words, 0});
  start(1, broken.chain);
  run(20);
  EXPECT_EQ(status(), bridge::kDmaError << 1U);
  EXPECT_EQ(read_register(bridge::kDmaStatus + bridge::kChannelStride), 0U);
  EXPECT_GT(dut->stats().errors, 0U);
  local.refused_address = UINT64_MAX;
  write_register(bridge::kInterruptStatus, bridge::kAllInterrupts);
  start(1, kChain, {{kData, 0, 4}});
  run(20);
  EXPECT_EQ(status(), bridge::kDmaDone << 1U);
}

constexpr std::uint32_t kNoTarget = 0xF000'0000;
INSTANTIATE_TEST_SUITE_P(
    PciBridge, PciBridgeDmaError,
    testing::Values(Broken{"chain_not_aligned", 0x108, 0x1000, 4, UINT64_MAX},
                    Broken{"no_words", 0x100, 0x1000, 0, UINT64_MAX},
                    Broken{"address_not_aligned", 0x100, 0x1002, 4, UINT64_MAX},
                    Broken{"no_target_to_read", 0x100, kNoTarget, 4, UINT64_MAX},
                    Broken{"no_target_to_write", 0x100, kNoTarget, 4 | bridge::kToPci, UINT64_MAX},
                    Broken{"board_refuses_a_write", 0x100, 0x1000, 4, 0},
                    Broken{"board_refuses_a_read", 0x100, 0x1000, 4 | bridge::kToPci, 0}),
    [](const auto& tested) { return tested.param.name; });

TEST_F(PciBridgeDma, CountsTheWordsThatWaitForTheLocalBus) {
  build();
  local.held = true;
  burst(true, kSlave + 400, 3);
  start(0, kChain, {{kData, 0, 4}});
  run(20);
  EXPECT_EQ(dut->control().words_taken().total(), 7U);
  EXPECT_EQ(dut->control().words_held().total(), 4U);
  local.release();
  run(5);
  EXPECT_EQ(dut->control().words_held().total(), 0U);
}

// The test lets the bursts of the local bus through one by one. Posted writes go to bank 0, channels 0 and 1
// write to banks 1 and 2.
class PciBridgeTurns : public PciBridgeDma {
 protected:
  void build_held() {
    build({4, 64, kCore});
    local.held = true;
  }
  void start_both(std::uint32_t words) {
    for (const std::uint32_t channel : {0U, 1U})
      start(channel, kChain + 0x40 * channel, {{kData, (1 + channel) << 26U, words}});
    run(20);
  }
  void post() { burst(true, kSlave, 1); }
  // The running burst ends. The next one begins and is held.
  void let_one_through() {
    local.release();
    run(0.001);
    local.held = true;
    run(20);
  }
  // The bursts so far: 'p' for posted writes, or the number of the channel.
  std::string order() const {
    std::string order;
    for (const auto& burst : local.bursts) order += "p01"[burst.address >> 28U];
    return order;
  }
};

TEST_F(PciBridgeTurns, PassToTheOtherChannelWhenNothingWaits) {
  build_held();
  for (const char* const expected : {"p10", "p10p01", "p10p01p10"}) {
    post();
    start_both(4);
    for (int bursts = 0; bursts < 3; ++bursts) let_one_through();
    EXPECT_EQ(order(), expected);
  }
}

}  // namespace
}  // namespace stereotlm::pci
