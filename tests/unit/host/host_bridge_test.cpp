#include "models/host/host_bridge.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "tests/support/test_host.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::host {
namespace {

using pci::TestMaster;
using pci::TestTarget;
using pci::word_at;

constexpr std::uint32_t kBase = 0x1'0000;
constexpr int kWait = 4;

// A processor, the bridge, a bus with a second master, and a target.
class HostBridgeTest : public testing::Test {
 protected:
  void build(const test::ProtocolOptions& options = {}, int latency_timer_clocks = 64) {
    pci::PciBusConfig config;
    config.latency_timer_clocks = latency_timer_clocks;
    config.masters = {"host", "other"};
    config.windows = {{kBase, 0x1000, kWait}};
    bus = std::make_unique<pci::PciBus>("bus", config);
    bridge.pci.bind(bus->slots[0]);
    other.pci.bind(bus->slots[1]);
    bus->stops[0].bind(target);
    binder = std::make_unique<test::MonitoringBinder>(options);
    binder->bind(cpu.socket, bridge.cpu, "cpu_to_bridge");
    binder->bind(bus->targets[0], target.socket, "bus_to_target");
    prepare(payload, words);
  }
  static void prepare(tlm::tlm_generic_payload& access, std::vector<std::uint32_t>& data) {
    access.set_command(tlm::TLM_WRITE_COMMAND);
    access.set_address(kBase + 0x20);
    access.set_data_ptr(reinterpret_cast<unsigned char*>(data.data()));
    access.set_data_length(static_cast<unsigned>(4 * data.size()));
    access.set_streaming_width(static_cast<unsigned>(4 * data.size()));
  }
  void simulate(std::function<void()> body) {
    sc_core::sc_spawn(std::move(body));
    sc_core::sc_start();
  }
  tlm::tlm_response_status send() {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    cpu.socket->b_transport(payload, delay);
    return payload.get_response_status();
  }
  std::uint64_t edge(std::uint64_t clock) const { return bus->clock().edge_ps(clock); }
  static std::uint64_t now_ps() { return Clock::to_ps(sc_core::sc_time_stamp()); }

  std::unique_ptr<test::MonitoringBinder> binder;
  std::unique_ptr<pci::PciBus> bus;
  test::TestHost cpu{"cpu"};
  HostBridge bridge{"bridge"};
  TestMaster other{"other"};
  TestTarget target{"target"};
  tlm::tlm_generic_payload payload;
  std::vector<std::uint32_t> words{5, 6, 7};
  sc_core::sc_time delay;
};

TEST_F(HostBridgeTest, WritesAWordInOneBurst) {
  build();
  simulate([this] {
    EXPECT_EQ(cpu.write(kBase + 8, 77).status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(now_ps(), edge(1 + kWait + 1));
  });
  ASSERT_EQ(target.accesses.size(), 1U);
  EXPECT_TRUE(target.accesses[0].write);
  EXPECT_EQ(target.accesses[0].address, 8U);
  EXPECT_EQ(target.accesses[0].words, std::vector<std::uint32_t>{77});
  EXPECT_EQ(bus->stats().masters[0].transactions, 1U);
}

TEST_F(HostBridgeTest, ReadsAWordInOneBurst) {
  build();
  simulate([this] {
    const auto answer = cpu.read(kBase + 8);
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(answer.word, word_at(8));
    EXPECT_EQ(now_ps(), edge(1 + kWait + 1));
  });
}

TEST_F(HostBridgeTest, BeginsAtTheTimeOfTheAccess) {
  build();
  simulate([this] {
    const auto answer = cpu.read(kBase + 8, Clock::to_time(edge(10)));
    EXPECT_EQ(answer.at, Clock::to_time(edge(10 + 1 + kWait + 1)));
    EXPECT_EQ(answer.at, sc_core::sc_time_stamp());
  });
}

TEST_F(HostBridgeTest, TransfersSeveralWordsInOneBurst) {
  build();
  simulate([this] {
    EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
    payload.set_command(tlm::TLM_READ_COMMAND);
    EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
  });
  ASSERT_EQ(target.accesses.size(), 2U);
  EXPECT_EQ(target.accesses[0].words, (std::vector<std::uint32_t>{5, 6, 7}));
  EXPECT_EQ(words, pci::words_from(0x20, 3));
}

TEST_F(HostBridgeTest, RepeatsARetry) {
  build();
  int refusals = 3;
  target.writable = [&refusals](auto, auto count) { return refusals-- > 0 ? 0U : count; };
  simulate([this] {
    EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(now_ps(), edge(3 * 2 + 1 + kWait + 3));  // each retry: address clock and idle clock
  });
  EXPECT_EQ(bus->stats().masters[0].retries, 3U);
  EXPECT_EQ(bus->stats().masters[0].words, 3U);
}

TEST_F(HostBridgeTest, GoesOnBehindADisconnect) {
  build();
  target.writable = [](auto, auto count) { return std::min<std::size_t>(count, 2); };
  simulate([this] { EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE); });
  ASSERT_EQ(target.accesses.size(), 2U);
  EXPECT_EQ(target.accesses[0].words, (std::vector<std::uint32_t>{5, 6}));
  EXPECT_EQ(target.accesses[1].address, 0x28U);
  EXPECT_EQ(target.accesses[1].words, std::vector<std::uint32_t>{7});
}

TEST_F(HostBridgeTest, GoesOnWithAReadThatTheLatencyTimerCut) {
  words.assign(40, 0);
  build({}, 10);
  other.bursts = {{false, kBase, 1}};
  simulate([this] {
    other.request();
    payload.set_command(tlm::TLM_READ_COMMAND);
    EXPECT_EQ(send(), tlm::TLM_OK_RESPONSE);
  });
  EXPECT_EQ(words, pci::words_from(0x20, 40));
  EXPECT_EQ(bus->stats().masters[0].transactions, 2U);
  EXPECT_EQ(bus->stats().masters[0].words, 40U);
}

TEST_F(HostBridgeTest, AnswersAMasterAbortAsAnAddressError) {
  build();
  simulate([this] {
    EXPECT_EQ(cpu.read(kBase + 0x1000).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(now_ps(), edge(5));
    EXPECT_EQ(cpu.write(0, 1).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(cpu.write(kBase, 1).status, tlm::TLM_OK_RESPONSE);
  });
  EXPECT_EQ(bus->stats().masters[0].aborts, 2U);
}

TEST_F(HostBridgeTest, AnswersAnErrorOfTheTargetAsAGenericError) {
  build();
  target.response = tlm::TLM_ADDRESS_ERROR_RESPONSE;
  simulate([this] {
    EXPECT_EQ(cpu.read(kBase).status, tlm::TLM_GENERIC_ERROR_RESPONSE);
    EXPECT_EQ(cpu.write(kBase, 1).status, tlm::TLM_GENERIC_ERROR_RESPONSE);
  });
}

TEST_F(HostBridgeTest, TakesTurnsBetweenProcesses) {
  build({});
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
  EXPECT_EQ(bus->stats().masters[0].words, 9U);
}

TEST_F(HostBridgeTest, ServesANonBlockingProcessor) {
  build();
  simulate([this] {
    EXPECT_EQ(cpu.access(tlm::TLM_WRITE_COMMAND, kBase, 9).status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(cpu.access(tlm::TLM_READ_COMMAND, kBase + 4).word, word_at(4));
  });
  EXPECT_EQ(target.accesses.size(), 2U);
}

TEST_F(HostBridgeTest, RefusesWhatABurstCannotSay) {
  test::ProtocolOptions options;
  options.whole_words = false;
  options.streaming_bursts = true;
  build(options);
  std::array<unsigned char, 4> enables{};
  simulate([this, &enables] {
    payload.set_command(tlm::TLM_IGNORE_COMMAND);
    EXPECT_EQ(send(), tlm::TLM_COMMAND_ERROR_RESPONSE);
    payload.set_command(tlm::TLM_WRITE_COMMAND);
    payload.set_data_length(6);
    EXPECT_EQ(send(), tlm::TLM_BURST_ERROR_RESPONSE);
    payload.set_data_length(0);
    EXPECT_EQ(send(), tlm::TLM_BURST_ERROR_RESPONSE);
    payload.set_data_length(12);
    payload.set_streaming_width(8);
    EXPECT_EQ(send(), tlm::TLM_BURST_ERROR_RESPONSE);
    payload.set_streaming_width(12);
    payload.set_address(kBase + 2);
    EXPECT_EQ(send(), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    payload.set_address(kBase);
    payload.set_byte_enable_ptr(enables.data());
    payload.set_byte_enable_length(4);
    EXPECT_EQ(send(), tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
    EXPECT_EQ(now_ps(), 0U);
  });
  EXPECT_EQ(binder->take_violations().size(), 1U);  // the length of 0
  EXPECT_EQ(bus->stats().masters[0].transactions, 0U);
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
