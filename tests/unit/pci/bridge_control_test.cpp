// The bridge and the local bus as their controls alone, without modules and without the kernel.
#include "models/pci/bridge_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "models/fpga/local_bus_control.h"

namespace stereotlm::pci {
namespace {

constexpr std::uint64_t kPs = 25'000;  // a clock of the local bus and of the core

// The core grants each word of a bank in the cycle of its request, and never refuses. The test plays the PCI
// bus, and calls the steps.
class BridgeControlTest : public testing::Test,
                          public PciSlot,
                          public BridgeControl::Host,
                          public fpga::LocalBusControl::Core {
 protected:
  static constexpr std::uint32_t kNoBank = 63U << 26U;  // a page

  BridgeControlTest() { bus.bind(bridge.local_bus_master()); }
  // Steps whatever is due up to `end_ps`.
  void run_to(std::uint64_t end_ps) {
    for (;;) {
      const std::uint64_t now_ps = std::min(bridge.next_ps(), bus.next_ps());
      if (now_ps > end_ps) return;
      ++steps;
      bridge.next_ps() == now_ps ? bridge.step(now_ps) : bus.step(now_ps);
    }
  }
  bool post(std::uint64_t now_ps, std::uint64_t offset, std::size_t words) {
    const std::vector<unsigned char> data(4 * words, 1);
    return bridge.write(now_ps, offset, data.data(), words);
  }
  std::uint32_t status() {
    std::uint32_t value = 0;
    EXPECT_TRUE(bridge.read_register(bridge::kInterruptStatus, value));
    return value;
  }
  // The PCI bus grants the burst that the bridge has requested, and transfers its first `words` words.
  PciBurst transfer(std::uint64_t end_ps, std::size_t words, const std::vector<std::uint32_t>& read = {}) {
    EXPECT_FALSE(requests_ps.empty());
    const PciBurst burst = bridge.begin_burst(end_ps);
    std::copy(read.begin(), read.end(), burst.words->begin());
    const bool complete = words == burst.words->size();
    bridge.end_burst({complete ? BurstEnd::kComplete : BurstEnd::kLatencyTimer, words, 0, end_ps});
    return burst;
  }

  void request(PciMasterIf& /*master*/, std::uint64_t from_ps) override { requests_ps.push_back(from_ps); }
  BurstResult transferred(std::uint64_t) const override { return {}; }
  const Clock& clock() const override { return pci_clock; }
  void slave_read_ended(std::uint64_t now_ps, bool ok) override {
    EXPECT_TRUE(ok);
    reads_ended_ps.push_back(now_ps);
  }
  void interrupt_changed(std::uint64_t now_ps) override { interrupts_ps.push_back(now_ps); }
  void route(const fpga::HostRoute& route) override {
    if (!route.bank) return;
    routes_ps.push_back(bus.request_ps());
    while (bus.word_waits()) bus.access(bus.request_ps(), bus.request_ps() + 2 * kPs);
  }
  bool access_bank(std::uint64_t, bool write, std::uint64_t address, std::uint32_t& word) override {
    if (write) memory[address] = word;
    if (!write) word = memory[address];
    return true;
  }
  bool access_register(std::uint64_t, bool, std::uint64_t address, std::uint32_t& word) override {
    word = static_cast<std::uint32_t>(address);
    return true;
  }

  Clock pci_clock{33.333};
  fpga::LocalBusControl bus{{40, {}}, 4, *this};
  BridgeControl bridge{{32, 64}, *this, bus, *this};
  std::map<std::uint64_t, std::uint32_t> memory;
  std::vector<std::uint64_t> requests_ps;
  std::vector<std::uint64_t> routes_ps;  // first requests of the bursts to the banks
  std::vector<std::uint64_t> reads_ended_ps;
  std::vector<std::uint64_t> interrupts_ps;
  int steps = 0;
};

// Address and decode clock, 32 words, idle clock: 35 clocks.
TEST_F(BridgeControlTest, EndsAPostedBurstWithoutAStepUnlessWordsWait) {
  EXPECT_TRUE(post(0, 0, 32));
  EXPECT_EQ(bridge.next_ps(), kNever);
  EXPECT_EQ(bridge.writable_words(35 * kPs - 1, 64), 32U);
  EXPECT_EQ(bridge.writable_words(35 * kPs, 64), 64U);
  EXPECT_TRUE(post(35 * kPs, 128, 32));
  EXPECT_EQ(bridge.next_ps(), kNever);
  EXPECT_TRUE(post(36 * kPs, 256, 32));
  EXPECT_EQ(bridge.next_ps(), 70 * kPs);
  EXPECT_FALSE(post(70 * kPs - 1, 384, 1));
  run_to(70 * kPs);
  EXPECT_EQ(steps, 1);
  EXPECT_EQ(bridge.next_ps(), kNever);
  EXPECT_EQ(routes_ps, (std::vector<std::uint64_t>{3 * kPs, 38 * kPs, 73 * kPs}));
  EXPECT_TRUE(post(70 * kPs, 384, 32));
  EXPECT_EQ(bridge.stats().posted_words, 128U);
  EXPECT_EQ(bridge.stats().errors, 1U);
}

TEST_F(BridgeControlTest, ReadsBehindPostedWritesAndReportsTheEnd) {
  std::uint32_t words[2] = {};
  post(0, 0, 2);
  bridge.read(kPs, bridge::kCoreRegisters + 4, reinterpret_cast<unsigned char*>(words), 2);
  EXPECT_EQ(bridge.next_ps(), 5 * kPs);
  run_to(UINT64_MAX - 1);
  // From clock 5 on: address, decode, two words, idle.
  EXPECT_EQ(reads_ended_ps, (std::vector<std::uint64_t>{10 * kPs}));
  EXPECT_EQ(words[1], 8U);
  EXPECT_EQ(bridge.stats().slave_reads, 2U);
}

// Writes that are posted at the time at which a read begins go first.
TEST_F(BridgeControlTest, ChoosesAfterAllTransfersThatStartAtATime) {
  std::uint32_t word = 0;
  bridge.read(0, 0, reinterpret_cast<unsigned char*>(&word), 1);
  EXPECT_EQ(bridge.next_ps(), 0U);
  post(0, 0, 1);
  EXPECT_EQ(bridge.next_ps(), 4 * kPs);
  run_to(UINT64_MAX - 1);
  EXPECT_EQ(routes_ps, (std::vector<std::uint64_t>{3 * kPs, 7 * kPs}));
  EXPECT_EQ(word, 0x01010101U);
}

TEST_F(BridgeControlTest, RaisesAnErrorAtOnceIfTheLocalBusRefusesAPostedBurst) {
  bridge.write_register(0, bridge::kPage, kNoBank);
  bridge.write_register(0, bridge::kInterruptEnable, bridge::kPostedError);
  EXPECT_TRUE(interrupts_ps.empty());
  post(kPs, 0, 1);
  EXPECT_EQ(bridge.next_ps(), kPs);
  run_to(kPs);
  EXPECT_EQ(status(), bridge::kPostedError);
  EXPECT_TRUE(bridge.interrupts());
  bridge.write_register(2 * kPs, bridge::kInterruptStatus, bridge::kPostedError);
  EXPECT_FALSE(bridge.interrupts());
  EXPECT_EQ(interrupts_ps, (std::vector<std::uint64_t>{kPs, 2 * kPs}));
  EXPECT_EQ(bus.stats(0).errors, 1U);
}

TEST_F(BridgeControlTest, KnowsTheAddressInABankOfBytesThatLieInOneApertureAndOneBank) {
  constexpr std::uint32_t kWords = bridge::kBankBytes / 4;
  bridge.write_register(0, bridge::kPage, 1U << 26U | 5U);
  bridge.write_register(0, bridge::kPage + 12, 2U << 26U | (kWords - 8));
  const std::uint64_t bank = bridge::kBankBytes;
  const std::uint64_t end = bridge::kApertureBytes;
  EXPECT_EQ(bridge.bank_address(8, 16), bank + 20 + 8);
  EXPECT_EQ(bridge.bank_address(end - 16, 16), bank + 20 + end - 16);
  EXPECT_EQ(bridge.bank_address(end - 16, 20), std::nullopt);  // two apertures
  EXPECT_EQ(bridge.bank_address(3 * end, 32), 3 * bank - 32);
  EXPECT_EQ(bridge.bank_address(3 * end, 36), std::nullopt);  // two banks
  EXPECT_NE(bridge.bank_address(4 * end - 4, 4), std::nullopt);
  EXPECT_EQ(bridge.bank_address(4 * end - 4, 8), std::nullopt);  // the core's registers
  EXPECT_EQ(bridge.bank_address(4 * end, 4), std::nullopt);
}

TEST_F(BridgeControlTest, IsIdleWhenTheBurstOfThePostedWordsHasEnded) {
  EXPECT_TRUE(bridge.is_idle());
  const std::size_t turn = bridge.turn();
  EXPECT_TRUE(post(0, 0, 32));
  EXPECT_EQ(bridge.posted_words(), 32U);
  bridge.settle(35 * kPs - 1);
  EXPECT_FALSE(bridge.is_idle());
  bridge.settle(35 * kPs);
  EXPECT_TRUE(bridge.is_idle());
  EXPECT_EQ(bridge.posted_words(), 0U);
  EXPECT_NE(bridge.turn(), turn);
  bridge.write_register(36 * kPs, bridge::kDmaControl, 1);
  EXPECT_FALSE(bridge.is_idle());
}

TEST_F(BridgeControlTest, CountsPostedWritesThatAreSkipped) {
  const std::size_t turn = 1 - bridge.turn();
  bridge.skip_posted(turn, 40);
  EXPECT_EQ(bridge.turn(), turn);
  bridge.skip_posted(turn, 39);
  EXPECT_EQ(bridge.stats().most_posted_words, 40U);
  bridge.count_skipped(0, 32);
  bridge.count_skipped(bridge::kBankBytes, 8);
  EXPECT_EQ(bridge.stats().posted_words, 40U);
}

// The channel reads its descriptor and four words, one of them after a cut, and writes them to bank 1.
TEST_F(BridgeControlTest, MovesTheWordsOfADmaChannel) {
  bridge.write_register(0, bridge::kDmaDescriptor, 0x100);
  bridge.write_register(0, bridge::kDmaControl, 1);
  EXPECT_EQ(transfer(kPs, 4, {0x1000, 1U << 26U, 4, 0}).address, 0x100U);
  EXPECT_EQ(transfer(2 * kPs, 3, {1, 2, 3}).address, 0x1000U);
  EXPECT_EQ(bridge.next_ps(), kNever);
  EXPECT_EQ(transfer(3 * kPs, 1, {4}).address, 0x100CU);
  EXPECT_EQ(requests_ps, (std::vector<std::uint64_t>{0, kPs, 2 * kPs}));
  EXPECT_EQ(bridge.next_ps(), 3 * kPs);
  run_to(3 * kPs);
  EXPECT_EQ(bridge.next_ps(), 10 * kPs);  // the channel waits for the end
  EXPECT_EQ(status(), 0U);
  run_to(10 * kPs);
  EXPECT_EQ(status(), bridge::kDmaDone);
  EXPECT_EQ(memory.at(std::uint64_t{1} << 28U | 12U), 4U);
  EXPECT_EQ(bridge.stats().dma_words, 4U);
}

class BridgeControlOnLocalBus : public BridgeControlTest, public LocalBusMasterObserver {
 protected:
  BridgeControlOnLocalBus() { bridge.observe(static_cast<LocalBusMasterObserver&>(*this)); }
  void words_posted(std::uint64_t now_ps, std::size_t words) override { add("posted", now_ps, words); }
  void transfer_waits(std::uint64_t now_ps, LocalBusSource source) override {
    add(name_of(source) + " waits", now_ps, 0);
  }
  void burst_begins(std::uint64_t now_ps, LocalBusSource source, std::size_t words) override {
    add(name_of(source) + " begins", now_ps, words);
  }
  void posted_words_leave(std::uint64_t at_ps, std::size_t words) override { add("leave", at_ps, words); }
  void add(const std::string& what, std::uint64_t time_ps, std::size_t words) {
    reports.push_back(what + ' ' + std::to_string(words) + " in clock " + std::to_string(time_ps / kPs));
  }
  static std::string name_of(LocalBusSource source) {
    return std::array<const char*, 4>{"write", "read", "dma0", "dma1"}[static_cast<std::size_t>(source)];
  }
  std::vector<std::string> reports;
};

// A burst has its address, decode and idle clock beside its words.
TEST_F(BridgeControlOnLocalBus, ShowsWhatWaitsAndWhatBeginsToAnObserver) {
  std::uint32_t word = 0;
  post(0, 0, 30);
  post(10 * kPs, 120, 20);
  bridge.read(11 * kPs, 0, reinterpret_cast<unsigned char*>(&word), 1);
  run_to(100 * kPs);
  EXPECT_EQ(reports, (std::vector<std::string>{"posted 30 in clock 0", "write begins 30 in clock 0",
                                               "leave 30 in clock 33", "posted 20 in clock 10",
                                               "read waits 0 in clock 11", "write begins 20 in clock 33",
                                               "leave 20 in clock 56", "read begins 1 in clock 56"}));
}

TEST_F(BridgeControlOnLocalBus, ShowsThatTheWordsOfARefusedBurstLeaveAtOnce) {
  bridge.write_register(0, bridge::kPage, kNoBank);
  post(kPs, 0, 2);
  EXPECT_EQ(reports, (std::vector<std::string>{"posted 2 in clock 1", "write begins 2 in clock 1",
                                               "leave 2 in clock 1"}));
}

}  // namespace
}  // namespace stereotlm::pci
