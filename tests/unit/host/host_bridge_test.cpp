#include "models/host/host_bridge.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "models/testing/expected_report.h"
#include "models/testing/test_host.h"
#include "tests/support/refused_access.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::host {
namespace {

using pci::PciBusBench;
using pci::word_at;
using Words = std::vector<std::uint32_t>;

constexpr std::uint32_t kBase = PciBusBench::kBase;
constexpr int kWait = 4;

// A processor, the bridge, a bus with a second master, and a target.
class HostBridgeTest : public testing::Test {
 protected:
  void build(const test::ProtocolOptions& options = {}, int latency_timer_clocks = 64) {
    pci::PciBusConfig config = PciBusBench::with_window(kWait, latency_timer_clocks);
    config.masters = {"host"};
    bench = std::make_unique<PciBusBench>(config);
    bench->bind_stop();
    bridge.pci.bind(bench->bus->slots[0]);
    binder = std::make_unique<test::MonitoringBinder>(options);
    binder->bind(cpu.socket, bridge.cpu, "cpu_to_bridge");
  }
  void simulate(std::function<void()> body) {
    sc_core::sc_spawn(std::move(body));
    sc_core::sc_start();
  }
  void write_words() { EXPECT_EQ(cpu.write_words(kBase + 0x20, {5, 6, 7}).status, tlm::TLM_OK_RESPONSE); }
  std::uint64_t edge(std::uint64_t clock) const { return bench->edge(clock); }
  pci::TestTarget& target() { return *bench->targets[0]; }
  pci::PciBus::MasterStats stats() const { return bench->bus->stats().masters[0]; }

  std::unique_ptr<test::MonitoringBinder> binder;
  std::unique_ptr<PciBusBench> bench;
  test::TestHost cpu{"cpu"};
  HostBridge bridge{"bridge"};
};

TEST_F(HostBridgeTest, AccessesAWordInOneBurstAtTheTimeOfTheAccess) {
  build();
  simulate([this] {
    EXPECT_EQ(cpu.write(kBase + 8, 77).status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(kernel_time::now_ps(), edge(1 + kWait + 1));
    const auto answer = cpu.read(kBase + 8, kernel_time::to_time(edge(20) - kernel_time::now_ps()));
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(answer.word, word_at(8));
    EXPECT_EQ(answer.at, kernel_time::to_time(edge(20 + 1 + kWait + 1)));
    EXPECT_EQ(answer.at, sc_core::sc_time_stamp());
  });
  ASSERT_EQ(target().accesses.size(), 2U);
  EXPECT_TRUE(target().accesses[0].write);
  EXPECT_EQ(target().accesses[0].address, 8U);
  EXPECT_EQ(target().accesses[0].words, Words{77});
  EXPECT_EQ(stats().transactions, 2U);
}

TEST_F(HostBridgeTest, RepeatsARetriedBurst) {
  build();
  int refusals = 3;
  target().writable = [&refusals](auto, auto count) { return refusals-- > 0 ? 0U : count; };
  simulate([this] {
    write_words();
    EXPECT_EQ(kernel_time::now_ps(),
              edge(3 * 2 + 1 + kWait + 3));  // each retry: address clock and idle clock
  });
  EXPECT_EQ(stats().retries, 3U);
  ASSERT_EQ(target().accesses.size(), 1U);
  EXPECT_EQ(target().accesses[0].words, (Words{5, 6, 7}));
}

TEST_F(HostBridgeTest, ContinuesADisconnectedBurst) {
  build();
  target().writable = [](auto, auto count) { return std::min<std::size_t>(count, 2); };
  simulate([this] { write_words(); });
  ASSERT_EQ(target().accesses.size(), 2U);
  EXPECT_EQ(target().accesses[0].words, (Words{5, 6}));
  EXPECT_EQ(target().accesses[1].address, 0x28U);
  EXPECT_EQ(target().accesses[1].words, Words{7});
}

TEST_F(HostBridgeTest, ContinuesAReadThatTheLatencyTimerCut) {
  build({}, 10);
  bench->masters[0]->bursts = {pci::read_of(1)};
  simulate([this] {
    bench->masters[0]->request();
    const auto answer = cpu.read_words(kBase + 0x20, 40);
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(answer.words, pci::words_from(0x20, 40));
  });
  EXPECT_EQ(stats().transactions, 2U);
  EXPECT_EQ(stats().words, 40U);
}

TEST_F(HostBridgeTest, AnswersAMasterAbortAsAnAddressErrorAndATargetErrorAsAGenericError) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  simulate([this] {
    EXPECT_EQ(cpu.read(kBase + PciBusBench::kBytes).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(kernel_time::now_ps(), edge(5));
    EXPECT_EQ(cpu.write(0, 1).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(cpu.write(kBase, 1).status, tlm::TLM_OK_RESPONSE);
    target().response = tlm::TLM_ADDRESS_ERROR_RESPONSE;
    EXPECT_EQ(cpu.read(kBase).status, tlm::TLM_GENERIC_ERROR_RESPONSE);
    EXPECT_EQ(cpu.write(kBase, 1).status, tlm::TLM_GENERIC_ERROR_RESPONSE);
  });
  EXPECT_EQ(stats().aborts, 4U);
}

TEST_F(HostBridgeTest, ServesProcessesInTheOrderOfTheirAccesses) {
  build();
  std::vector<int> order;
  for (const int process : {0, 1, 2}) {
    sc_core::sc_spawn([this, &order, process] {
      for (int i = 0; i < 3; ++i) {
        cpu.write(kBase, 1);
        order.push_back(process);
      }
    });
  }
  sc_core::sc_start();
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 0, 1, 2, 0, 1, 2}));
  EXPECT_EQ(stats().words, 9U);
}

TEST_F(HostBridgeTest, EndsTheBurstOfAKilledProcessOnlyIfItIsGranted) {
  build();
  test::ExpectedReport lost("/stereotlm/lost_access", 3);
  auto granted = sc_core::sc_spawn([this] { cpu.write_words(kBase, {1, 2}); });
  auto in_queue = sc_core::sc_spawn([this] { cpu.write(kBase + 4, 9); });
  simulate([&] {
    sc_core::wait(kernel_time::to_time(edge(3)));
    granted.kill();
    in_queue.kill();
    write_words();  // at once behind the burst
    EXPECT_EQ(kernel_time::now_ps(), edge((1 + kWait + 2 + 1) + 1 + kWait + 3));
    bench->masters[0]->bursts = {pci::read_of(20)};
    bench->masters[0]->request();
    auto requested = sc_core::sc_spawn([this] { cpu.write(kBase + 8, 1); });
    sc_core::wait(kernel_time::to_time(edge(5)));
    requested.kill();
    write_words();
  });
  EXPECT_NE(lost.text().find("bridge: a write of 4 bytes at address 0x10008 is lost: "), std::string::npos);
  ASSERT_EQ(target().accesses.size(), 4U);
  EXPECT_EQ(target().accesses[0].words, (Words{1, 2}));
  for (const std::size_t access : {1U, 3U}) EXPECT_EQ(target().accesses[access].words, (Words{5, 6, 7}));
}

// A process is reset in each clock of its access, before and after all else that happens as the clock begins.
TEST_F(HostBridgeTest, ServesAProcessThatIsReset) {
  sc_core::sc_report_handler::set_actions("/stereotlm/lost_access", sc_core::SC_DO_NOTHING);
  build();
  bool is_last = false;
  auto victim = sc_core::sc_spawn([&] {
    do {
      EXPECT_EQ(cpu.read_words(kBase + 0x20, 3).words, pci::words_from(0x20, 3));
    } while (!is_last);
  });
  simulate([&] {
    for (std::uint64_t clock = 1; clock < 200; clock += 7) {
      sc_core::wait(kernel_time::to_time(edge(clock)) - sc_core::sc_time_stamp());
      for (std::uint64_t deltas = clock % 5; deltas > 0; --deltas) sc_core::wait(sc_core::SC_ZERO_TIME);
      victim.reset();
    }
    is_last = true;
  });
  EXPECT_TRUE(victim.terminated());
}

TEST_F(HostBridgeTest, ServesANonBlockingProcessor) {
  build();
  simulate([this] {
    EXPECT_EQ(cpu.access(tlm::TLM_WRITE_COMMAND, kBase, 9).status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(cpu.access(tlm::TLM_READ_COMMAND, kBase + 4).word, word_at(4));
  });
  EXPECT_EQ(target().accesses.size(), 2U);
}

TEST_F(HostBridgeTest, RefusesAccessesThatABurstCannotCarry) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  test::ProtocolOptions options;
  options.whole_words = false;
  build(options);
  const test::RefusedAccess refused[] = {
      {tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_IGNORE_COMMAND, kBase},
      {tlm::TLM_BURST_ERROR_RESPONSE, tlm::TLM_WRITE_COMMAND, kBase, 6, 12},
      {tlm::TLM_BURST_ERROR_RESPONSE, tlm::TLM_WRITE_COMMAND, kBase, 0, 12},
      {tlm::TLM_BURST_ERROR_RESPONSE, tlm::TLM_WRITE_COMMAND, kBase, 12, 8},
      {tlm::TLM_ADDRESS_ERROR_RESPONSE, tlm::TLM_WRITE_COMMAND, kBase + 2},
      {tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, tlm::TLM_WRITE_COMMAND, kBase, 4, 4, 4},
  };
  simulate([this, &refused] {
    for (const test::RefusedAccess& access : refused) test::expect_refused(cpu.socket, access);
  });
  EXPECT_EQ(binder->take_violations().size(), 1U);  // the length of 0
  EXPECT_EQ(stats().transactions, 0U);
}

TEST_F(HostBridgeTest, GrantsNoDirectAccess) {
  build();
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  tlm::tlm_dmi dmi;
  EXPECT_FALSE(cpu.dmi(kBase, dmi));
  EXPECT_EQ(cpu.debug_write(kBase, {1}), 0U);
}

}  // namespace
}  // namespace stereotlm::host
