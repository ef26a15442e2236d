// The bridge as a target: posted writes, reads, registers, interrupts.
#include "models/memory/word_access.h"
#include "models/pci/posted_writes.h"
#include "models/testing/expected_report.h"
#include "tests/unit/pci/pci_bridge_bench.h"

namespace stereotlm::pci {
namespace {

class PciBridgeSlave : public PciBridgeBench {};

constexpr std::uint32_t board_word(std::uint32_t bank, std::uint32_t word) { return bank << 26U | word; }
constexpr std::uint64_t byte_on_bus(std::uint64_t bank, std::uint64_t word) {
  return bank << 28U | word << 2U;
}

TEST_F(PciBridgeSlave, PostsWritesToTheBoardWordsThatThePageOfTheirApertureNames) {
  build();
  for (std::uint32_t aperture = 0; aperture < bridge::kApertures; ++aperture) {
    write_register(bridge::kPage + 4 * aperture, board_word(2 * aperture + 1, 100 * aperture));
    EXPECT_EQ(read_register(bridge::kPage + 4 * aperture), board_word(2 * aperture + 1, 100 * aperture));
    const std::uint64_t address = kSlave + aperture * bridge::kApertureBytes + 12;
    EXPECT_EQ(burst(true, address, 5).result.end, BurstEnd::kComplete);
    run(5);
    ASSERT_EQ(local.bursts.size(), aperture + 1);
    EXPECT_TRUE(local.bursts.back().write);
    EXPECT_EQ(local.bursts.back().address, byte_on_bus(2 * aperture + 1, 100 * aperture + 3));
    EXPECT_EQ(local.bursts.back().words, words_from(address, 5));
  }
  burst(true, kSlave + bridge::kApertureBytes - 8, 4);  // across the border of two apertures
  run(5);
  ASSERT_EQ(local.bursts.size(), bridge::kApertures + 2U);
  EXPECT_EQ(local.bursts[4].address, byte_on_bus(1, bridge::kApertureBytes / 4 - 2));
  EXPECT_EQ(local.bursts[5].address, byte_on_bus(3, 100));
  EXPECT_EQ(dut->stats().posted_words, 24U);
  EXPECT_EQ(dut->control().words_taken().total(), 24U);
  EXPECT_EQ(dut->control().words_held().total(), 0U);
}

TEST_F(PciBridgeSlave, ReachesTheRegistersOfTheCoreBehindTheApertures) {
  build();
  burst(true, kSlave + bridge::kCoreRegisters + 8, 1);
  EXPECT_EQ(burst(false, kSlave + bridge::kCoreRegisters + 4, 1).words.at(0), word_at(kCore + 4));
  ASSERT_EQ(local.bursts.size(), 2U);
  EXPECT_EQ(local.bursts[0].address, kCore + 8);
  EXPECT_EQ(local.bursts[1].address, kCore + 4);
  EXPECT_EQ(dut->control().words_taken().total(), 0U);  // registers are not counted
}

TEST_F(PciBridgeSlave, TakesNoMoreWordsThanItHasPlaces) {
  build({4, 10, kCore});
  local.held = true;
  EXPECT_EQ(burst(true, kSlave, 6).result.end, BurstEnd::kComplete);
  EXPECT_EQ(burst(true, kSlave + 24, 4).result.end, BurstEnd::kComplete);
  const auto& retried = burst(true, kSlave + 40, 4);
  EXPECT_EQ(retried.result.end, BurstEnd::kDisconnect);
  EXPECT_EQ(retried.result.words, 0U);
  EXPECT_EQ(dut->control().words_taken().total(), 10U);
  EXPECT_EQ(dut->control().words_held().total(), 6U);
  local.release();
  run(5);
  EXPECT_EQ(dut->control().words_held().total(), 0U);
  EXPECT_EQ(burst(true, kSlave, 11).result.words, 10U);
  run(5);
  EXPECT_EQ(local.words.size(), 10U);
}

TEST_F(PciBridgeSlave, CountsWordsForEachBuffer) {
  build({4, 64, kCore, {{0, 20}, {20, 24}}});
  local.held = true;
  burst(true, kSlave, 8);
  EXPECT_EQ(dut->control().words_taken().words(), (std::vector<std::uint64_t>{5, 1, 2}));
  EXPECT_EQ(dut->control().words_held().words(), (std::vector<std::uint64_t>{1, 1, 2}));
  local.release();
  run(5);
}

TEST_F(PciBridgeSlave, ReadsBehindTheWritesPostedBefore) {
  build({1, 64, kCore});
  local.word_time = sc_core::sc_time(500, sc_core::SC_NS);
  burst(true, kSlave + 8, 3);
  EXPECT_EQ(burst(false, kSlave + 12, 2).words,
            (std::vector<std::uint32_t>{word_at(kSlave + 12), word_at(kSlave + 16)}));
  ASSERT_EQ(local.bursts.size(), 4U);  // a word each, then the read
  EXPECT_TRUE(local.bursts[2].write);
  EXPECT_EQ(dut->stats().slave_reads, 2U);
}

TEST_F(PciBridgeSlave, EndsTheReadOfAKilledProcessBeforeTheNextOne) {
  test::ExpectedReport lost("/stereotlm/lost_access");
  build();
  local.held = true;
  std::vector<std::uint32_t> read;
  const auto start_read = [&](std::uint64_t address) {
    return sc_core::sc_spawn([&, address] {
      memory::WordAccess access(bench->bus->targets[1]);
      sc_core::sc_time delay;
      EXPECT_TRUE(access.read(address, delay));
      read.push_back(access.word());
    });
  };
  auto victim = start_read(16);
  for (const std::uint64_t address : {24U, 32U}) start_read(address);
  sc_core::sc_spawn([&] {
    sc_core::wait(100, sc_core::SC_NS);
    victim.kill();
    sc_core::wait(100, sc_core::SC_NS);
    local.release();
  });
  run(5);
  EXPECT_NE(lost.text().find("bridge.slave: a read of 4 bytes at address 0x10 is lost"), std::string::npos);
  EXPECT_EQ(local.bursts.size(), 3U);
  EXPECT_EQ(read, (std::vector<std::uint32_t>{word_at(24), word_at(32)}));
}

TEST_F(PciBridgeSlave, AnswersAReadThatTheBoardRefusesWithAnError) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  local.refused_address = 0;
  EXPECT_EQ(burst(false, kSlave, 1).result.end, BurstEnd::kTargetError);
  EXPECT_EQ(burst(false, kSlave + 4, 1).result.end, BurstEnd::kComplete);
}

TEST_F(PciBridgeSlave, RaisesAnErrorForAWriteThatTheBoardRefuses) {
  build();
  local.refused_address = 0;
  burst(true, kSlave, 1);
  run(2);
  EXPECT_EQ(status(), bridge::kPostedError);
  EXPECT_EQ(dut->control().words_held().total(), 0U);
  EXPECT_GT(dut->stats().errors, 0U);
}

TEST_F(PciBridgeSlave, RaisesTheInterruptWhileAnEnabledStatusBitIsSet) {
  build();
  doorbell = true;
  run(1);
  EXPECT_FALSE(dut->interrupt->is_asserted());
  EXPECT_EQ(status(), bridge::kDoorbell);
  write_register(bridge::kInterruptEnable, UINT32_MAX);
  EXPECT_EQ(read_register(bridge::kInterruptEnable), bridge::kAllInterrupts);
  write_register(bridge::kInterruptEnable, bridge::kDoorbell);
  EXPECT_TRUE(dut->interrupt->is_asserted());
  write_register(bridge::kInterruptStatus, bridge::kAllInterrupts & ~bridge::kDoorbell);
  EXPECT_TRUE(dut->interrupt->is_asserted());
  write_register(bridge::kInterruptStatus, bridge::kDoorbell);
  EXPECT_FALSE(dut->interrupt->is_asserted());
  run(1);  // the doorbell is still high: only its rising edge counts
  EXPECT_EQ(status(), 0U);
  doorbell = false;
  run(1);
  doorbell = true;
  run(1);
  EXPECT_TRUE(dut->interrupt->is_asserted());
}

TEST_F(PciBridgeSlave, RefusesRegisterAccessesThatDoNotExist) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  const Script refused[] = {{true, bridge::kDmaStatus, 1},
                            {false, bridge::kDmaControl, 1},
                            {false, 0x18, 1},
                            {true, 0x18, 1},
                            {false, 0x2c, 1},
                            {false, 0, 2}};
  for (const auto& [write, offset, words] : refused)
    EXPECT_EQ(burst(write, kRegisters + offset, words).result.end, BurstEnd::kTargetError) << offset;
  EXPECT_EQ(dut->stats().errors, std::size(refused));
  EXPECT_EQ(burst(false, kRegisters + bridge::kDmaStatus, 1).result.end, BurstEnd::kComplete);
}

TEST(PostedWrites, SendABurstUpToTheEndOfABank) {
  PostedWrites posted(8);
  const std::uint32_t words[4] = {1, 2, 3, 4};
  posted.push(bridge::kBankBytes - 4, words, 4);
  EXPECT_EQ(posted.send(8).count, 1U);
  posted.sent();
  EXPECT_EQ(posted.send(8).count, 3U);
}

}  // namespace
}  // namespace stereotlm::pci
