// The board without modules and without the kernel. Random computers compare its figures with the plain loop,
// and fast_computer_test.cpp has what it refuses.
#include "platform/loop/fast_board.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/register_map.h"
#include "models/memory/memory_config.h"
#include "tests/support/scratch_folder.h"
#include "tests/unit/platform/computer_registers.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

// The test is the master of the local bus.
class FastBoardTest : public ::testing::Test, public LocalBusMasterIf {
 protected:
  FastBoardTest() { board.local_bus().bind(*this); }
  void end_burst_at(std::uint64_t end_ps, bool /*ok*/) override { burst_end_ps = end_ps; }
  // Runs a write from now to its end.
  void write(std::uint64_t address, std::vector<std::uint32_t> words) {
    burst_end_ps = kNever;
    auto* const data = reinterpret_cast<unsigned char*>(words.data());
    ASSERT_TRUE(board.local_bus().begin_burst(now_ps, {true, address, data, words.size()}));
    for (;;) {
      const std::uint64_t time_ps = std::min({board.next_ps(), board.local_bus().next_ps(), burst_end_ps});
      if (time_ps == kNever) return;
      now_ps = time_ps;
      if (time_ps == burst_end_ps) return;
      board.next_ps() == time_ps ? board.step(time_ps) : board.local_bus().step(time_ps);
    }
  }

  BoardConfig config = [] {
    BoardConfig board_config = testing::small_board();
    board_config.banks[3].words = 32'768;
    return board_config;
  }();
  FastBoard board{config, fpga::Fidelity::kTiming, [](std::uint64_t /*time_ps*/) {}, 8'000};
  std::uint64_t now_ps = 0;
  std::uint64_t burst_end_ps = 0;
};

// A burst keeps the left table's bank from the frame, because the host comes first. The frame is checked
// every 8192 cycles.
TEST_F(FastBoardTest, ReportsAFrameThatMakesNoProgressWithItsWaits) {
  EXPECT_EQ(board.frames().waits(), "the core runs no frame");
  std::uint32_t bank = 0;
  for (const std::uint64_t base : testing::kBaseRegisters)
    write(fpga::kLocalRegisters + base, {fpga::registers::base(bank++, 0)});
  write(fpga::kLocalRegisters + fpga::registers::kControl, {fpga::registers::kControlStart});
  const std::string text = test::message_of(
      [this] { write(memory::crossbar_address(3, 1000), std::vector<std::uint32_t>(20'000)); });
  EXPECT_EQ(text.substr(0, text.find(';')), "core: no slot consumed and no result written for 8192 cycles");
  EXPECT_NE(text.find("; frame 0 of the core, cycle "), std::string::npos);
  EXPECT_NE(text.find("left_lut asks for bank number 3"), std::string::npos);
}

}  // namespace
}  // namespace stereotlm::platform
