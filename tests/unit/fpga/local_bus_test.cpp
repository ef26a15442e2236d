// The FPGA's end of the local bus alone. The test plays the core: it grants words and says when they are
// usable.
#include "models/fpga/local_bus.h"

#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <vector>

#include "models/fpga/register_file.h"
#include "models/memory/crossbar.h"
#include "models/memory/ssram_bank.h"
#include "tests/support/expected_report.h"
#include "tests/support/monitoring_binder.h"
#include "tests/support/test_host.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {
namespace {

using memory::crossbar_address;
using sc_core::sc_time;
using test::TestHost;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;

constexpr std::size_t kBanks = 2;
constexpr std::uint64_t kWords = 16;
constexpr std::uint64_t kLocalPs = 30'000;  // 33.333.. MHz
constexpr std::uint64_t kCorePs = 25'000;

// Local clock edges every 30 ns, cycles of the core every 25 ns. Behind `memory` is one bank.
class LocalBusTest : public testing::Test {
 protected:
  LocalBusTest() {
    binder.bind(host.socket, bus.bus, "host_to_local_bus");
    binder.bind(bus.memory, bank.port, "local_bus_to_bank");
    binder.bind(bus.registers, register_file.local_bus, "local_bus_to_registers");
    binder.bind(unused.socket, register_file.registers, "host_to_registers");
    bus.route_out.bind(routes);
    register_file.start_out.bind(starts);
    register_file.done(done);
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  static sc_time local(std::uint64_t edge) { return Clock::to_time(edge * kLocalPs); }
  static void run_until(const sc_time& time) { sc_core::sc_start(time - sc_core::sc_time_stamp()); }
  // Grants a word in the cycle of the core that begins at `grant_ps`; usable two cycles later.
  void grant(std::uint64_t grant_ps) {
    ASSERT_TRUE(bus.requests(grant_ps));
    bus.access(Clock::to_time(grant_ps) - sc_core::sc_time_stamp(), grant_ps, grant_ps + 2 * kCorePs);
  }

  test::MonitoringBinder binder;
  TestHost host{"host"};
  TestHost unused{"unused"};
  memory::SsramBank bank{"bank", {kWords, memory::BankKind::kZbtPipelined, 0, 40}};
  RegisterFile register_file{"register_file"};
  LocalBus bus{"bus", {1e6 / static_cast<double>(kLocalPs), {{0, 8}}}, kBanks};  // one buffer of two words
  Collected<HostRoute> routes;
  Collected<FrameStart> starts;
  sc_core::sc_signal<bool> done{"done"};
};

TEST_F(LocalBusTest, AsksAtTheEndOfTheWordsClock) {
  host.request(TLM_WRITE_COMMAND, 4, 7, local(10) - Clock::to_time(1));
  ASSERT_TRUE(bus.word_waits());
  // Address clock 10, decode clock 11, the word in clock 12.
  EXPECT_EQ(bus.request_ps(), 13 * kLocalPs);
  EXPECT_FALSE(bus.requests(13 * kLocalPs - 1));
  EXPECT_TRUE(bus.requests(13 * kLocalPs));
}

TEST_F(LocalBusTest, TakesTheNextAddressClockAPicosecondLate) {
  host.request(TLM_WRITE_COMMAND, 4, 7, local(10) + Clock::to_time(1));
  EXPECT_EQ(bus.request_ps(), 14 * kLocalPs);
}

TEST_F(LocalBusTest, FollowsAGrantWithTheNextClock) {
  host.request(TLM_WRITE_COMMAND, 0, std::vector<std::uint32_t>{5, 6, 7});
  EXPECT_EQ(bus.request_ps(), 3 * kLocalPs);
  grant(3 * kLocalPs);  // at a local edge: the next word's clock begins there
  EXPECT_EQ(bus.request_ps(), 4 * kLocalPs);
  grant(4 * kLocalPs + 1);  // behind an edge: it begins at the next
  EXPECT_EQ(bus.request_ps(), 6 * kLocalPs);
  grant(6 * kLocalPs);
  EXPECT_FALSE(bus.word_waits());
  run_until(local(20));
  ASSERT_EQ(host.answers.size(), 1U);
  EXPECT_EQ(host.answers[0].status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(host.answers[0].at, local(7));  // the idle clock is 6
  EXPECT_EQ(std::vector<std::uint32_t>(bank.words(), bank.words() + 3),
            (std::vector<std::uint32_t>{5, 6, 7}));
  EXPECT_EQ(bus.stats().words_written, 3U);
  EXPECT_EQ(bus.stats().bursts, 1U);
  EXPECT_EQ(bus.stats().busy_clocks, 6U);  // without the idle clock
  EXPECT_EQ(bus.stats().clocks, 20U);
}

TEST_F(LocalBusTest, CountsClocksUpToNow) {
  run_until(local(10));
  host.request(TLM_WRITE_COMMAND, 0, 5);
  EXPECT_EQ(bus.stats().busy_clocks, 0U);
  run_until(local(12));
  EXPECT_EQ(bus.stats().clocks, 12U);
  EXPECT_EQ(bus.stats().busy_clocks, 2U);
  grant(13 * kLocalPs);  // ahead of time
  EXPECT_EQ(bus.stats().busy_clocks, 2U);
  run_until(local(13));
  EXPECT_EQ(bus.stats().busy_clocks, 3U);
  run_until(local(14));
  EXPECT_EQ(bus.stats().busy_clocks, 3U);
}

TEST_F(LocalBusTest, CountsTheWordsOfEachBuffer) {
  using Words = std::vector<std::uint64_t>;
  host.request(TLM_WRITE_COMMAND, 4, std::vector<std::uint32_t>{5, 6, 7});
  EXPECT_EQ(bus.words_granted().words(), (Words{0, 0}));
  EXPECT_EQ(bus.words_to_grant().words(), (Words{1, 2}));
  grant(3 * kLocalPs);
  grant(4 * kLocalPs);
  EXPECT_EQ(bus.words_granted().words(), (Words{1, 1}));
  EXPECT_EQ(bus.words_to_grant().words(), (Words{0, 1}));
  grant(5 * kLocalPs);
  EXPECT_EQ(bus.words_granted().words(), (Words{1, 2}));
  EXPECT_EQ(bus.words_to_grant().words(), (Words{0, 0}));
  run_until(local(20));
  host.request(TLM_READ_COMMAND, 4, std::vector<std::uint32_t>(2));
  EXPECT_EQ(bus.words_to_grant().words(), (Words{0, 0}));
}

TEST_F(LocalBusTest, EndsAReadWhenItsLastWordIsUsable) {
  host.debug_write(8, {41, 42});
  host.request(TLM_READ_COMMAND, 8, std::vector<std::uint32_t>(2));
  grant(3 * kLocalPs);
  EXPECT_EQ(bus.request_ps(), 4 * kLocalPs);  // the next word is asked for while the first is on its way
  grant(4 * kLocalPs);
  run_until(local(20));
  ASSERT_EQ(host.answers.size(), 1U);
  EXPECT_EQ(host.answers[0].words, (std::vector<std::uint32_t>{41, 42}));
  // Usable at 4 * 30 + 50 ns: on the bus at edge 6, then the idle clock.
  EXPECT_EQ(host.answers[0].at, local(7));
  EXPECT_EQ(bus.stats().words_read, 2U);
}

TEST_F(LocalBusTest, TellsTheCrossbarWhereItsWordsGo) {
  host.request(TLM_READ_COMMAND, crossbar_address(0, 1), 0);
  ASSERT_EQ(routes.beats.size(), 1U);
  EXPECT_EQ(routes.beats[0].bank, std::optional<std::size_t>(0));
  EXPECT_FALSE(routes.beats[0].write);
  grant(3 * kLocalPs);
  ASSERT_EQ(routes.beats.size(), 2U);
  EXPECT_EQ(routes.beats[1].bank, std::nullopt);
  host.request(TLM_WRITE_COMMAND, crossbar_address(1, 0), 0);
  ASSERT_EQ(routes.beats.size(), 3U);
  EXPECT_EQ(routes.beats[2].bank, std::optional<std::size_t>(1));
  EXPECT_TRUE(routes.beats[2].write);
}

TEST_F(LocalBusTest, AccessesARegisterAtTheEndOfItsClock) {
  host.request(TLM_WRITE_COMMAND, kLocalRegisters + registers::kControl, registers::kControlStart);
  run_until(local(3) - Clock::to_time(1));
  EXPECT_TRUE(starts.beats.empty());
  run_until(local(3) + Clock::to_time(1));
  ASSERT_EQ(starts.beats.size(), 1U);
  EXPECT_EQ(starts.beats[0].delay, sc_time());
  run_until(local(20));
  EXPECT_EQ(host.answers.at(0).at, local(4));
  EXPECT_TRUE(routes.beats.empty());
  EXPECT_EQ(bus.stats().register_accesses, 1U);
}

TEST_F(LocalBusTest, AccessesRegistersOneClockApart) {
  host.request(TLM_WRITE_COMMAND, kLocalRegisters + registers::kLeftImageBase,
               std::vector<std::uint32_t>{3, 4, 5});
  run_until(local(20));
  EXPECT_EQ(host.answers.at(0).at, local(6));
  host.request(TLM_READ_COMMAND, kLocalRegisters + registers::kRightImageBase, 0);
  run_until(local(40));
  EXPECT_EQ(host.answers.at(1).word, 4U);
  EXPECT_EQ(bus.stats().register_accesses, 4U);
}

TEST_F(LocalBusTest, TransfersTheWordsBesideOneThatIsRefused) {
  host.request(TLM_WRITE_COMMAND, (kWords - 1) * 4, std::vector<std::uint32_t>{8, 9});
  grant(3 * kLocalPs);
  grant(4 * kLocalPs);
  run_until(local(20));
  EXPECT_EQ(host.answers.at(0).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(bank.words()[kWords - 1], 8U);
  EXPECT_EQ(bus.stats().words_written, 1U);
  EXPECT_EQ(bus.stats().errors, 1U);
  host.request(TLM_WRITE_COMMAND, kLocalRegisters + registers::kStatus, 1);
  run_until(local(40));
  EXPECT_EQ(host.answers.at(1).status, tlm::TLM_COMMAND_ERROR_RESPONSE);
  host.request(TLM_READ_COMMAND, 0, 0);
  grant(60 * kLocalPs);
  run_until(local(80));
  EXPECT_EQ(host.answers.at(2).status, tlm::TLM_OK_RESPONSE);
}

TEST_F(LocalBusTest, EndsAReadThatIsRefusedWithItsGrant) {
  host.request(TLM_READ_COMMAND, kWords * 4, 0);
  grant(3 * kLocalPs);
  run_until(local(20));
  EXPECT_EQ(host.answers.at(0).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(host.answers.at(0).at, local(4));
}

TEST_F(LocalBusTest, AnswersABurstAsTheFirstOfItsRefusedWords) {
  // A register that cannot be read, ones that can, and none behind the last.
  host.request(TLM_READ_COMMAND, kLocalRegisters + registers::kControl,
               std::vector<std::uint32_t>(registers::kEnd / 4 + 1));
  run_until(local(20));
  EXPECT_EQ(host.answers.at(0).status, tlm::TLM_COMMAND_ERROR_RESPONSE);
  EXPECT_EQ(bus.stats().errors, 2U);
}

TEST_F(LocalBusTest, RefusesAtOnceWhatIsNoBurst) {
  const auto status = [this](tlm::tlm_command command, std::uint64_t address, std::size_t words) {
    EXPECT_EQ(host.request(command, address, std::vector<std::uint32_t>(words)), tlm::TLM_COMPLETED);
    return host.answers.back().status;
  };
  EXPECT_EQ(status(TLM_READ_COMMAND, 2, 1), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(status(TLM_READ_COMMAND, crossbar_address(kBanks, 0), 1), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(status(TLM_READ_COMMAND, crossbar_address(1, 0) - 4, 2), tlm::TLM_BURST_ERROR_RESPONSE);
  binder.take_violations();
  EXPECT_EQ(bus.stats().errors, 3U);
  EXPECT_EQ(bus.stats().bursts, 0U);
  EXPECT_FALSE(bus.word_waits());
  EXPECT_EQ(host.request(TLM_READ_COMMAND, crossbar_address(1, 0) - 4, 0), tlm::TLM_ACCEPTED);
  grant(3 * kLocalPs);
}

TEST_F(LocalBusTest, RefusesBlockingTransport) {
  EXPECT_EQ(host.read(0).status, tlm::TLM_GENERIC_ERROR_RESPONSE);
}

TEST_F(LocalBusTest, ReachesBanksAndRegistersByDebugTransport) {
  EXPECT_EQ(host.debug_write(12, {77}), 4U);
  EXPECT_EQ(bank.words()[3], 77U);
  EXPECT_EQ(host.debug_read(kLocalRegisters + registers::kStatus, 1), std::vector<std::uint32_t>{0});
  tlm::tlm_dmi dmi;
  EXPECT_TRUE(host.dmi(0, dmi));
  EXPECT_EQ(dmi.get_end_address(), kWords * 4 - 1);
}

// Reports that do not throw: an exception from here, behind a process of the bus, would pass a stack that the
// address sanitizer does not know.
void report_without_exception() {
  sc_core::sc_report_handler::set_actions("/stereotlm/local_bus", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
}

TEST_F(LocalBusTest, ReportsABurstWhileOneIsUnderWay) {
  host.request(TLM_READ_COMMAND, 0, 0);
  test::ExpectedReport report("/stereotlm/local_bus");
  report_without_exception();
  host.request(TLM_READ_COMMAND, 4, 0);
  EXPECT_EQ(report.text(), "bus: phase out of order");
  EXPECT_EQ(binder.take_violations().size(), 1U);
}

TEST_F(LocalBusTest, ReportsABurstBeforeTheResponseEnded) {
  host.ending = TestHost::Ending::kAccepted;
  host.request(TLM_WRITE_COMMAND, 0, 0);
  grant(3 * kLocalPs);
  test::ExpectedReport report("/stereotlm/local_bus");
  report_without_exception();
  host.request(TLM_READ_COMMAND, 4, 0);
}

TEST_F(LocalBusTest, ReportsTheEndOfAResponseThatHasNotBegun) {
  host.request(TLM_READ_COMMAND, 0, 0);
  test::ExpectedReport report("/stereotlm/local_bus");
  report_without_exception();
  host.end_response();
  EXPECT_EQ(binder.take_violations().size(), 1U);
}

TEST_F(LocalBusTest, NotifiesTheCoreWhenTheFirstWordBeginsToAsk) {
  sc_time noticed;
  sc_core::sc_spawn([&] {
    host.request(TLM_READ_COMMAND, 0, 0, local(5));
    sc_core::wait(bus.request_event());
    noticed = sc_core::sc_time_stamp();
  });
  run_until(local(20));
  EXPECT_EQ(noticed, local(8));
}

class LocalBusEndings : public LocalBusTest, public testing::WithParamInterface<TestHost::Ending> {};

TEST_P(LocalBusEndings, MakeRoomForTheNextBurst) {
  host.ending = GetParam();
  for (std::uint64_t burst = 0; burst < 3; ++burst) {
    host.request(TLM_WRITE_COMMAND, burst * 4, 1);
    grant(bus.request_ps());
    run_until(host.answers.back().at);
    if (host.ending == TestHost::Ending::kAccepted) host.end_response();
  }
  EXPECT_EQ(host.answers.size(), 3U);
  EXPECT_EQ(host.answers[2].at, local(3 * 4));
}

INSTANTIATE_TEST_SUITE_P(LocalBus, LocalBusEndings,
                         testing::Values(TestHost::Ending::kCompleted, TestHost::Ending::kUpdated,
                                         TestHost::Ending::kAccepted));

TEST(LocalBus, RefusesAClockOrBanksOutsideTheirRange) {
  EXPECT_NO_THROW(LocalBus("a", {1}, 1));
  EXPECT_NO_THROW(LocalBus("b", {1000}, 64));
  EXPECT_THROW(LocalBus("c", {0.5}, 1), std::invalid_argument);
  EXPECT_THROW(LocalBus("d", {1000.5}, 1), std::invalid_argument);
  EXPECT_THROW(LocalBus("e", {40}, 0), std::invalid_argument);
  EXPECT_THROW(LocalBus("f", {40}, 65), std::invalid_argument);
}

// Words that are moved at once, and granted later.
TEST_F(LocalBusTest, MovesTheWordsOfABurstAtOnce) {
  std::vector<std::uint32_t> moved(3);
  host.request(TLM_WRITE_COMMAND, crossbar_address(0, 1), std::vector<std::uint32_t>{7, 8, 9});
  run_until(local(3));
  EXPECT_EQ(bus.words_left(), 3U);
  bus.move_words(reinterpret_cast<unsigned char*>(moved.data()));
  EXPECT_EQ(moved, (std::vector<std::uint32_t>{7, 8, 9}));
  EXPECT_EQ(bus.words_left(), 3U);  // granted none
  bus.count_granted(3, 3 * kLocalPs, 4 * kLocalPs);
  moved = {10, 11};
  run_until(local(10));
  host.request(TLM_READ_COMMAND, crossbar_address(0, 1), std::vector<std::uint32_t>(2));
  run_until(local(13));
  bus.move_words(reinterpret_cast<unsigned char*>(moved.data()));
  bus.count_granted(2, 14 * kLocalPs, 15 * kLocalPs);
  run_until(local(20));
  ASSERT_EQ(host.answers.size(), 2U);
  EXPECT_EQ(host.answers[1].words, (std::vector<std::uint32_t>{10, 11}));
}

TEST_F(LocalBusTest, CountsWordsGrantedTogetherAsOneByOne) {
  host.request(TLM_WRITE_COMMAND, crossbar_address(0, 1), std::vector<std::uint32_t>(4));
  run_until(local(3));
  bus.count_granted(3, 6 * kLocalPs, 7 * kLocalPs);
  EXPECT_EQ(bus.words_left(), 1U);
  EXPECT_EQ(bus.request_ps(), 7 * kLocalPs);  // the clock behind the last grant
  EXPECT_TRUE(bus.word_waits());
  bus.count_granted(1, 7 * kLocalPs, 8 * kLocalPs);
  EXPECT_FALSE(bus.word_waits());
  run_until(local(20));
  ASSERT_EQ(host.answers.size(), 1U);
  EXPECT_EQ(host.answers[0].at, local(7 + 1));  // behind the idle clock
  EXPECT_EQ(bus.stats().words_written, 4U);
  EXPECT_EQ(bus.stats().words_read, 0U);
}

TEST_F(LocalBusTest, EndsABurstThatReadsOnceItsLastWordIsUsable) {
  host.request(TLM_READ_COMMAND, crossbar_address(0, 1), std::vector<std::uint32_t>(2));
  run_until(local(3));
  bus.count_granted(2, 4 * kLocalPs, 4 * kLocalPs + 1);
  run_until(local(20));
  ASSERT_EQ(host.answers.size(), 1U);
  EXPECT_EQ(host.answers[0].at, local(5 + 1));
  EXPECT_EQ(bus.stats().words_read, 2U);
}

TEST(LocalBus, IsInStepWithAClockThatHasItsEdges) {
  const LocalBus bus("bus", {40, {}}, kBanks);
  EXPECT_TRUE(bus.is_in_step_with(Clock(40)));
  EXPECT_FALSE(bus.is_in_step_with(Clock(80)));
}

}  // namespace
}  // namespace stereotlm::fpga
