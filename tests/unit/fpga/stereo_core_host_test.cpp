// The host port beside the ports of the core. The local bus has the core's clock: a burst that begins at
// edge c requests one word per cycle from cycle c + kFirst on. The random boards of
// stereo_core_random_test.cpp and the random computers compare bursts before, in and after frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/kernels/stereo.h"
#include "models/testing/expected_report.h"
#include "tests/unit/fpga/stereo_core_bench.h"

namespace stereotlm::fpga {
namespace {

using memory::crossbar_address;
using sc_core::sc_time;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;
using Words = std::vector<std::uint32_t>;

constexpr std::uint64_t kFirst = 3;     // address, decode and word clock
constexpr std::uint64_t kReadEnd = 3;   // read latency and idle clock, from the cycle of the last grant
constexpr std::uint64_t kWriteEnd = 1;  // idle clock

class StereoCoreQdr : public StereoCoreBench {};

// The host reads the last word of the results in the cycle in which the core writes it, the last counted one.
TEST_F(StereoCoreQdr, GivesTheHostTheOldWordInTheCycleOfItsWrite) {
  StereoCoreConfig board = small_board();
  board.memory.banks[kResult].kind = memory::BankKind::kQdr;
  build(board);
  memory.debug_write(crossbar_address(kResult, 0), Words(12, 0xAAAA'AAAA));
  at(edge(0), [this] { start(); });
  const std::uint64_t last = frame_cycles_alone(4) - pipeline() - 1;
  at(edge(last - kFirst), [this] { memory.access(TLM_READ_COMMAND, crossbar_address(kResult, 11)); });
  finish();
  ASSERT_EQ(memory.answers.size(), 1U);
  EXPECT_EQ(memory.answers[0].word, 0xAAAA'AAAAU);
  EXPECT_EQ(memory.answers[0].at, edge(last + kReadEnd));
  EXPECT_NE(banks[kResult]->words()[11], 0xAAAA'AAAAU);
  const memory::ArbiterStats stats = core->crossbar().arbitration().stats(kResult);
  EXPECT_EQ(stats.reads(), 1U);
  EXPECT_EQ(stats.busy_cycles(), stats.writes());
  EXPECT_EQ(stats.contended_cycles(), 0U);
  EXPECT_EQ(port(kHostGroup).granted(), 1U);
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
}

// The host writes word 4 of the left picture in cycle 37. In this cycle the core reads the last pixel of this
// word for the row of results 1, and writes its second word of results. Later rows read the new pixels.
TEST_F(StereoCoreQdr, GivesTheCoreTheOldWordInTheCycleOfTheHostsWrite) {
  constexpr std::uint64_t kCycle = 37;
  constexpr std::uint32_t kNew = 0xC200'0000;
  StereoCoreConfig board = small_board();
  board.memory.banks[kLeft].kind = memory::BankKind::kQdr;
  build(board);
  const auto image = [](const std::vector<std::uint8_t>& pixels) {
    kernels::GrayImage picture(8, 6);
    picture.pixels = pixels;
    return picture;
  };
  const auto disparities = [&](const std::vector<std::uint8_t>& left_picture) {
    const kernels::StereoConfig matcher{3, board.core.disparities, {}, 0};
    return words_of(
        kernels::disparity_image(image(left_picture), image(right), nullptr, nullptr, matcher).pixels);
  };
  const Words before = disparities(left);
  std::vector<std::uint8_t> changed = left;
  changed[19] = kNew >> 24U;
  ASSERT_NE(disparities(changed)[2], before[2]) << "row 1 would show the new pixel";
  changed[16] = changed[17] = changed[18] = 0;
  const Words after = disparities(changed);
  at(edge(0), [this] { start(); });
  at(edge(kCycle - kFirst), [this] { memory.access(TLM_WRITE_COMMAND, crossbar_address(kLeft, 4), kNew); });
  finish();
  EXPECT_EQ(memory.answers.at(0).at, edge(kCycle + kWriteEnd));
  EXPECT_EQ(core->crossbar().arbitration().stats(kLeft).contended_cycles(), 0U);
  const Words words(banks[kResult]->words(), banks[kResult]->words() + 12);
  EXPECT_EQ(Words(words.begin(), words.begin() + 4), Words(before.begin(), before.begin() + 4));
  EXPECT_EQ(Words(words.begin() + 4, words.end()), Words(after.begin() + 4, after.end()));
}

class StereoCoreStarved : public StereoCoreFidelities {};

TEST_P(StereoCoreStarved, IsNotReportedOfAFrameThatBeginsLate) {
  StereoCoreConfig board = small_board();
  board.stall_timeout_cycles = 10'000;
  build(board);
  for (const std::uint64_t cycle : {std::uint64_t{20'000}, std::uint64_t{50'000}})
    at(edge(cycle), [this] { start(); });
  run_until(edge(60'000));
  EXPECT_EQ(done_at.size(), 2U);
}

// A host that writes a word in every cycle, and is served first, keeps a reader of that bank waiting.
TEST_P(StereoCoreStarved, IsReportedWithItsWaitsAsSoonAsItsTimeoutHasPassed) {
  // Not thrown: the address sanitizer cannot follow an exception through SystemC's stacks.
  sc_core::sc_report_handler::set_actions("/stereotlm/core", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  const test::ExpectedReport expected("/stereotlm/core");
  StereoCoreConfig board = small_board();
  board.memory.banks.assign(kBankCount, {65'536});
  board.stall_timeout_cycles = 2 * 8192;  // checked every 8192 cycles
  binder = test::MonitoringBinder({true, true, true, false});
  build(board);
  start();
  at(edge(1), [this] { memory.access(TLM_WRITE_COMMAND, crossbar_address(kLeft, 1000), Words(40'000)); });
  run_until(edge(30'000));
  EXPECT_THAT(expected.text(),
              testing::ContainsRegex("core: no slot consumed and no result written for 16384 cycles; "
                                     "frame 0 of the core, cycle [12][0-9]+; left_lut is blocked: its "
                                     "lane is full; right_lut is blocked: its lane is full; "
                                     "left_pixel asks for bank number 0, lost [12][0-9]+ cycles to host; "
                                     "right_pixel is starved; result is idle; host asks for bank number 0"));
}

INSTANTIATE_TEST_SUITE_P(Fidelities, StereoCoreStarved, testing::Values(Fidelity::kCycle, Fidelity::kFast),
                         name_of_fidelity);

}  // namespace
}  // namespace stereotlm::fpga
