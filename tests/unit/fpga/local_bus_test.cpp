// The FPGA's end of the local bus alone. The test plays the core: it grants words and makes them usable.
#include "models/fpga/local_bus.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/fpga/register_file.h"
#include "models/kernel_time.h"
#include "models/memory/crossbar.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
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
using Words = std::vector<std::uint32_t>;

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
  static sc_time local(std::uint64_t edge) { return kernel_time::to_time(edge * kLocalPs); }
  static void run_until(std::uint64_t edge) { sc_core::sc_start(local(edge) - sc_core::sc_time_stamp()); }
  // Grants a word in the cycle of the core that begins at `grant_ps`; usable two cycles later.
  void grant(std::uint64_t grant_ps) {
    ASSERT_TRUE(bus.control().requests(grant_ps));
    bus.control().access(grant_ps, grant_ps + 2 * kCorePs);
  }
  // Reports that do not throw: the address sanitizer cannot follow an exception through the processes.
  void expect_out_of_order(const std::function<void()>& action, std::size_t violations) {
    test::ExpectedReport report("/stereotlm/local_bus");
    sc_core::sc_report_handler::set_actions("/stereotlm/local_bus", sc_core::SC_ERROR,
                                            sc_core::SC_DO_NOTHING);
    action();
    EXPECT_EQ(report.text(), "bus: phase out of order");
    EXPECT_EQ(binder.take_violations().size(), violations);
  }

  test::MonitoringBinder binder{{true, true, true, false}};  // ends in the middle of its traffic
  TestHost host{"host"};
  TestHost unused{"unused"};
  memory::SsramBank bank{"bank", {kWords, memory::BankKind::kZbtPipelined, 0, 40}};
  RegisterFile register_file{"register_file"};
  LocalBus bus{"bus", {1e6 / static_cast<double>(kLocalPs), {{0, 8}}}, kBanks};  // one buffer of two words
  Collected<HostRoute> routes;
  Collected<FrameStart> starts;
  sc_core::sc_signal<bool> done{"done"};
};

TEST_F(LocalBusTest, CountsTheWordsWrittenToEachBuffer) {
  using Counts = std::vector<std::uint64_t>;
  const auto expect_words = [this](const Counts& granted, const Counts& to_grant) {
    EXPECT_EQ(bus.control().words_granted().words(), granted);
    EXPECT_EQ(bus.control().words_to_grant().words(), to_grant);
  };
  host.request(TLM_WRITE_COMMAND, 4, Words{5, 6, 7});
  expect_words({0, 0}, {1, 2});
  grant(3 * kLocalPs);
  grant(4 * kLocalPs);
  expect_words({1, 1}, {0, 1});
  grant(5 * kLocalPs);
  expect_words({1, 2}, {0, 0});
  run_until(20);
  host.request(TLM_READ_COMMAND, 4, Words(2));
  expect_words({1, 2}, {0, 0});
}

TEST_F(LocalBusTest, TransfersTheOtherWordsBesideOneThatIsRefused) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  host.request(TLM_WRITE_COMMAND, (kWords - 1) * 4, Words{8, 9});
  grant(3 * kLocalPs);
  grant(4 * kLocalPs);
  run_until(20);
  EXPECT_EQ(host.answers.at(0).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(bank.words()[kWords - 1], 8U);
  EXPECT_EQ(bus.stats().words_written, 1U);
  EXPECT_EQ(bus.stats().errors, 1U);
  host.request(TLM_READ_COMMAND, kWords * 4, 0);  // a read that is refused ends with its grant
  grant(23 * kLocalPs);
  run_until(40);
  EXPECT_EQ(host.answers.at(1).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(host.answers.at(1).at, local(24));
  host.request(TLM_READ_COMMAND, 0, 0);
  grant(60 * kLocalPs);
  run_until(80);
  EXPECT_EQ(host.answers.at(2).status, tlm::TLM_OK_RESPONSE);
}

TEST_F(LocalBusTest, AnswersABurstAsTheFirstOfItsRefusedWords) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  // A register that cannot be read, registers that can, and an address after the last.
  host.request(TLM_READ_COMMAND, kLocalRegisters + registers::kControl, Words(registers::kEnd / 4 + 1));
  run_until(20);
  EXPECT_EQ(host.answers.at(0).status, tlm::TLM_COMMAND_ERROR_RESPONSE);
  EXPECT_EQ(bus.stats().errors, 2U);
  EXPECT_EQ(bus.stats().register_accesses, registers::kEnd / 4 + 1);
}

TEST_F(LocalBusTest, RefusesAtOnceAccessesThatAreNoBurst) {
  const test::ExpectedReport refusal("/stereotlm/refused_access", 2);
  const auto status = [this](tlm::tlm_command command, std::uint64_t address, std::size_t words) {
    EXPECT_EQ(host.request(command, address, Words(words)), tlm::TLM_COMPLETED);
    return host.answers.back().status;
  };
  EXPECT_EQ(status(TLM_READ_COMMAND, 2, 1), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(status(TLM_READ_COMMAND, crossbar_address(kBanks, 0), 1), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(status(TLM_READ_COMMAND, crossbar_address(1, 0) - 4, 2), tlm::TLM_BURST_ERROR_RESPONSE);
  binder.take_violations();
  EXPECT_EQ(bus.stats().errors, 3U);
  EXPECT_EQ(bus.stats().bursts, 0U);
  EXPECT_FALSE(bus.control().word_waits());
  EXPECT_EQ(host.request(TLM_READ_COMMAND, crossbar_address(1, 0) - 4, 0), tlm::TLM_ACCEPTED);
  grant(3 * kLocalPs);
  EXPECT_EQ(host.read(0).status, tlm::TLM_GENERIC_ERROR_RESPONSE);  // blocking transport
}

TEST_F(LocalBusTest, RefusesATransactionWithoutMemoryManager) {
  test::ExpectedReport refusal("/stereotlm/refused_access");
  tlm::tlm_generic_payload payload;
  std::array<unsigned char, 4> data{};
  payload.set_command(TLM_READ_COMMAND);
  payload.set_data_ptr(data.data());
  payload.set_data_length(4);
  payload.set_streaming_width(4);
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_time delay;
  EXPECT_EQ(host.socket->nb_transport_fw(payload, phase, delay), tlm::TLM_COMPLETED);
  EXPECT_EQ(payload.get_response_status(), tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_NE(refusal.text().find("must have a memory manager (set_mm())"), std::string::npos);
  binder.take_violations();
}

TEST_F(LocalBusTest, ReachesBanksByDebugTransport) {
  EXPECT_EQ(host.debug_write(12, {77}), 4U);
  EXPECT_EQ(bank.words()[3], 77U);
  EXPECT_EQ(host.debug_read(kLocalRegisters + registers::kStatus, 1), Words());
  tlm::tlm_dmi dmi;
  EXPECT_FALSE(host.dmi(0, dmi));
}

TEST_F(LocalBusTest, ReportsPhasesOutOfOrder) {
  host.request(TLM_READ_COMMAND, 0, 0);
  expect_out_of_order([this] { host.request(TLM_READ_COMMAND, 4, 0); }, 1);  // a burst is under way
  expect_out_of_order([this] { host.end_response(); }, 1);                   // no response has begun
}

TEST_F(LocalBusTest, ReportsABurstBeforeTheResponseEnded) {
  host.ending = TestHost::Ending::kAccepted;
  host.request(TLM_WRITE_COMMAND, 0, 0);
  grant(3 * kLocalPs);
  expect_out_of_order([this] { host.request(TLM_READ_COMMAND, 4, 0); }, 0);
}

class LocalBusEndings : public LocalBusTest, public testing::WithParamInterface<TestHost::Ending> {};

TEST_P(LocalBusEndings, MakeRoomForTheNextBurst) {
  host.ending = GetParam();
  for (std::uint64_t burst = 0; burst < 3; ++burst) {
    host.request(TLM_WRITE_COMMAND, burst * 4, 1);
    grant(bus.control().request_ps());
    sc_core::sc_start(host.answers.back().at - sc_core::sc_time_stamp());
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

}  // namespace
}  // namespace stereotlm::fpga
