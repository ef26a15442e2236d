// The computer with bursts of DMA that are skipped, and the same computer without.
#include "platform/dma_bursts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/random_computer.h"
#include "tests/unit/platform/loop_run.h"

namespace stereotlm::platform {
namespace {

using testing::Keys;
using testing::LoopOutcome;

constexpr std::uint32_t kHostBytes = 1U << 20U;
constexpr std::uint32_t kBurst = 32;               // words
constexpr std::size_t kWordsOfBank = 10 * kBurst;  // of bank 4 that a program reads at its end

constexpr std::uint32_t word_of(std::uint32_t bank, std::uint32_t number) { return bank << 26U | number; }

// What host memory holds at first.
const std::vector<unsigned char>& noise() {
  static const std::vector<unsigned char> bytes = [] {
    std::vector<unsigned char> random(kHostBytes);
    test::SplitMix64 source(1);
    std::generate(random.begin(), random.end(),
                  [&] { return static_cast<unsigned char>(source.next() >> 56U); });
    return random;
  }();
  return bytes;
}

struct Piece {
  bool to_host = false;
  std::uint32_t host = 0;
  std::uint32_t board = word_of(4, 0);
  std::uint32_t words = 0;
};

// What the program does: the chain of each channel, and what disturbs them.
struct DmaProgram {
  std::array<std::vector<Piece>, pci::bridge::kChannels> chains;
  std::optional<std::uint32_t> first_bank_of_frame;
  bool captures = false;         // to the banks 0 and 2
  std::uint64_t delay_ps = 0;    // after the start of the frame
  std::uint64_t disturb_ps = 0;  // it accesses a register or a bank as often; 0: never
  fpga::Fidelity fidelity = fpga::Fidelity::kFast;
  std::optional<fpga::CycleWindow> window;  // that is traced
};

class DmaRun : public testing::LoopRun {
 public:
  DmaRun(const BoardConfig& board, const DmaProgram& program, std::uint64_t step_ps)
      : LoopRun(board, program.fidelity, step_ps), program_(program) {
    std::copy(noise().begin(), noise().end(), memory.begin());
    for (std::uint32_t channel = 0; channel < pci::bridge::kChannels; ++channel) put_chain(channel);
  }

  LoopOutcome outcome() {
    namespace bridge = pci::bridge;
    if (program_.window) trace(*program_.window);
    const std::uint64_t registers = testing::kDevices.bridge_registers;
    write(testing::page_register(1), word_of(2, 0));
    write(testing::page_register(2), word_of(4, 0));
    write(registers + bridge::kInterruptEnable, bridge::kAllInterrupts);
    for (std::size_t side = 0; side < testing::kCaptures.size(); ++side) {
      write(testing::kCaptures[side] + capture::registers::kBufferAddress,
            static_cast<std::uint32_t>(testing::aperture(side)));
    }
    if (program_.first_bank_of_frame) start_frame(*program_.first_bank_of_frame);
    if (program_.captures) arm_captures();
    run_for(program_.delay_ps);
    std::uint32_t ended = 0;
    std::uint32_t awaited = 0;
    for (std::uint32_t channel = 0; channel < bridge::kChannels; ++channel) {
      if (program_.chains[channel].empty()) continue;
      awaited |= (bridge::kDmaDone | bridge::kDmaError) << channel;
      start_dma(channel, kBytesOfChain * channel);
    }
    const std::uint64_t wait_ps = program_.disturb_ps != 0 ? program_.disturb_ps : testing::kFramePs;
    for (std::uint64_t number = 0; (ended & awaited) == 0 || !all_ended(ended); ++number) {
      if (!run_to_interrupt(wait_ps)) {
        disturb(number);
        continue;
      }
      const std::uint32_t status = read(registers + bridge::kInterruptStatus);
      write(registers + bridge::kInterruptStatus, status);
      for (const std::uint64_t board : testing::kCaptures)
        write(board + capture::registers::kStatus, capture::registers::kStatusDone);
      note("status {}\n", status);
      ended |= status;
    }
    finish();
    if (program_.fidelity == fpga::Fidelity::kFast) {
      const std::string_view bytes(reinterpret_cast<const char*>(memory.data()), kHostBytes);
      note("memory {}\n", std::hash<std::string_view>()(bytes));
    }
    note("bank 4: {}\n", fmt::join(read(testing::aperture(2), kWordsOfBank), ","));
    return {figures() + counters() + traced(), loop().skipped_dma_bursts()};
  }

 private:
  static constexpr std::uint32_t kBytesOfChain = 512;

  void put_chain(std::uint32_t channel) {
    std::uint32_t address = kBytesOfChain * channel;
    for (const Piece& piece : program_.chains[channel]) {
      const bool is_last = &piece == &program_.chains[channel].back();
      const std::array<std::uint32_t, 4> descriptor = {
          piece.host, piece.board, piece.words | (piece.to_host ? pci::bridge::kToPci : 0),
          is_last ? 0 : address + 16};
      std::memcpy(memory.data() + address, descriptor.data(), sizeof descriptor);
      address += 16;
    }
  }
  bool all_ended(std::uint32_t status) const {
    for (std::uint32_t channel = 0; channel < pci::bridge::kChannels; ++channel) {
      const std::uint32_t ends = (pci::bridge::kDmaDone | pci::bridge::kDmaError) << channel;
      if (!program_.chains[channel].empty() && (status & ends) == 0) return false;
    }
    return true;
  }
  void disturb(std::uint64_t number) {
    const std::uint64_t bank = testing::aperture(0) + 4 * (5000 + number);
    if (number % 3 == 0) {
      read(testing::kCaptures[0] + capture::registers::kStatus);
    } else if (number % 3 == 1) {
      write(bank, 7);
    } else {
      read(bank, 3);
    }
  }

  const DmaProgram& program_;
};

BoardConfig dma_board(const Keys& keys) { return testing::loop_board(912.3, keys); }

LoopOutcome outcome_of(const BoardConfig& board, const DmaProgram& program) {
  // Less than a burst takes on a local bus of 120 MHz.
  const std::uint64_t short_ps = 8'000 * static_cast<std::uint64_t>(board.bridge.dma_burst_words + 2);
  return testing::compare_with_steps<DmaRun>(board, program, short_ps);
}

std::uint64_t skipped_bursts(const BoardConfig& board, const DmaProgram& program) {
  return outcome_of(board, program).skipped;
}

// To bank 4 and back, 30 bursts each.
DmaProgram there_and_back(std::size_t channel = 0) {
  DmaProgram program;
  program.chains[channel] = {{false, 0x10000, word_of(4, 0), 30 * kBurst},
                             {true, 0x40000, word_of(4, 0), 30 * kBurst}};
  return program;
}

TEST(DmaBursts, SkipsMostBurstsOfAnUndisturbedTransfer) {
  for (const std::size_t channel : {0U, 1U})
    EXPECT_GT(skipped_bursts(dma_board({}), there_and_back(channel)), 48U);
  for (const int mhz : {20, 40, 66, 150}) {
    EXPECT_GT(skipped_bursts(dma_board({fmt::format("pci.clock_mhz={}", mhz)}), there_and_back()), 48U)
        << mhz;
  }
  DmaProgram timing_only = there_and_back();
  timing_only.fidelity = fpga::Fidelity::kTiming;
  const LoopOutcome outcome = outcome_of(dma_board({}), timing_only);
  EXPECT_GT(outcome.skipped, 48U);
  std::array<std::uint32_t, kWordsOfBank> words{};  // are in the bank at timing-only too
  std::memcpy(words.data(), noise().data() + 0x10000, sizeof words);
  EXPECT_NE(outcome.figures.find(fmt::format("bank 4: {}\n", fmt::join(words, ","))), std::string::npos);
}

Keys random_dma_keys(test::SplitMix64& random) {
  Keys keys = testing::random_buses(random).keys;
  keys.push_back(fmt::format("pci.memory_wait_clocks={}", testing::one_of(random, {0, 1, 4, 8, 20})));
  const Keys load = testing::random_load(random, 1, 60, 30);
  keys.insert(keys.end(), load.begin(), load.end());
  return keys;
}

TEST(DmaBursts, GiveTheSameFiguresAsSteppedBursts) {
  const std::uint64_t computers = test::random_computers(200);
  std::uint64_t bursts = 0;
  std::uint64_t skipped = 0;
  for (std::uint64_t seed = 0; seed < computers; ++seed) {
    test::SplitMix64 random(seed);
    const BoardConfig board = dma_board(random_dma_keys(random));
    const int burst = board.bridge.dma_burst_words;
    DmaProgram program;
    std::vector<Piece>& chain = program.chains[seed % 2];
    for (int piece = random.between(1, 4); piece > 0; --piece) {
      const int words = random.between(1, random.chance(50) ? 60 * burst : 5 * burst);
      chain.push_back(
          {piece % 2 == 0, 0x1000U * static_cast<std::uint32_t>(random.between(1, 150)),
           word_of(random.chance(50) ? 4 : 1, 4 * static_cast<std::uint32_t>(random.between(0, 40))),
           static_cast<std::uint32_t>(words)});
      // Up to the end of the last bank or of host memory, or beyond it.
      const auto before_end = static_cast<std::uint32_t>(words - random.between(0, 1) * burst);
      if (random.chance(8)) chain.back().board = word_of(7, 131'072 - before_end);
      if (random.chance(8)) chain.back().host = kHostBytes - 4 * before_end;
      bursts += static_cast<std::uint64_t>(words / burst);
    }
    if (random.chance(15)) program.chains[1 - seed % 2] = {{true, 0xA0000, word_of(5, 0), 300}};
    if (random.chance(20)) program.first_bank_of_frame = static_cast<std::uint32_t>(random.between(0, 3));
    program.captures = random.chance(40);
    if (random.chance(30)) program.disturb_ps = 1'000'000 + 234'567 * (seed % 100);
    skipped += skipped_bursts(board, program);
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
  EXPECT_GT(skipped, bursts / 4) << bursts;
}

// A transfer of 60 bursts takes some 90 us, after the accesses of the program.
TEST(DmaBursts, GiveTheSameTraceAsSteppedBursts) {
  test::SplitMix64 random(2);
  std::uint64_t skipped = 0;
  for (int number = 0; number < 40; ++number) {
    DmaProgram program = there_and_back(static_cast<std::size_t>(random.between(0, 1)));
    program.fidelity = number % 2 == 0 ? fpga::Fidelity::kFast : fpga::Fidelity::kTiming;
    const BoardConfig board = dma_board({fmt::format("pci.clock_mhz={}", testing::decimal(random, 15, 70))});
    program.window = testing::random_window(random, board, 120e6);
    skipped += skipped_bursts(board, program);
    ASSERT_FALSE(HasFailure()) << number;
  }
  EXPECT_GT(skipped, 40U * 60 / 2);
}

}  // namespace
}  // namespace stereotlm::platform
