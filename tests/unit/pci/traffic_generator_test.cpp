#include "models/pci/traffic_generator.h"

#include <gtest/gtest.h>

#include "tests/support/expected_report.h"
#include "tests/support/refused_access.h"
#include "tests/support/test_host.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

constexpr std::uint32_t kDevice = 0x4000'0000;
constexpr std::uint64_t kUs = 1'000'000;  // ps

// The load with its device in a window without wait clocks, and a scripted master with its target.
class TrafficGeneratorTest : public testing::Test {
 protected:
  void build(const TrafficGeneratorConfig& config, int latency_timer_clocks = 64) {
    PciBusConfig bus_config = PciBusBench::with_window(0, latency_timer_clocks);
    bus_config.masters = {"load"};
    bus_config.windows.push_back({kDevice, 0x1000, 0});
    bench = std::make_unique<PciBusBench>(bus_config, 1, 1);
    load = std::make_unique<TrafficGenerator>("load", config);
    load->pci.bind(bench->bus->slots[0]);
    bench->binder.bind(bench->bus->targets[1], load->device, "bus_to_device");
  }
  void simulate_to(std::uint64_t time_ps) { sc_core::sc_start(Clock::to_time(time_ps - Clock::now_ps())); }
  TestMaster& master() { return *bench->masters[0]; }
  TestTarget& target() { return *bench->targets[0]; }
  PciBus::MasterStats load_stats() const { return bench->bus->stats().masters[0]; }
  void expect_report(const std::string& text) {
    test::ExpectedReport report("/stereotlm/traffic_generator");
    EXPECT_THROW(simulate_to(kUs), sc_core::sc_report);
    EXPECT_EQ(report.text(), text);
  }

  std::unique_ptr<PciBusBench> bench;
  std::unique_ptr<TrafficGenerator> load;
};

TEST_F(TrafficGeneratorTest, OccupiesTheBusAllTheTimeWithoutInterval) {
  build({kDevice, 32, 0, 0, 0});
  bench->simulate_to_edge(1000 * 34);
  EXPECT_EQ(load->transfers(), 1000U);
  EXPECT_EQ(bench->bus->stats().busy_clocks, 1000U * 33);
  EXPECT_EQ(load_stats().wait_clocks, 999U);  // the idle clocks
}

TEST_F(TrafficGeneratorTest, RequestsTheBusOnceAnIntervalFromItsFirstRequestOn) {
  build({kDevice, 8, 10 * kUs, kUs, 0});
  const std::uint64_t first = bench->bus->clock().edge_at_or_after(10 * kUs);
  bench->simulate_to_edge(first);
  EXPECT_EQ(bench->bus->stats().busy_clocks, 0U);
  bench->simulate_to_edge(first + 1);
  EXPECT_EQ(bench->bus->stats().busy_clocks, 1U);
  simulate_to(110 * kUs);
  EXPECT_EQ(load->transfers(), 100U);
  EXPECT_EQ(load_stats().words, 800U);
}

// The second transfer is due in clock 100, while the master has the bus in clocks 6..128. The third is due in
// clock 200 all the same.
TEST_F(TrafficGeneratorTest, KeepsItsTimesAfterATransferThatHadToWait) {
  build({kDevice, 4, 0, 3 * kUs, 0}, 255);
  target().read_delays = Clock::to_time(bench->edge(1 + 120) - bench->edge(1));
  master().bursts = {read_of(1)};
  bench->request_at(0);
  std::vector<std::uint64_t> transfers;
  for (const std::uint64_t clock : {105U, 134U, 135U, 204U, 206U}) {
    bench->simulate_to_edge(clock);
    transfers.push_back(load->transfers());
  }
  EXPECT_EQ(transfers, (std::vector<std::uint64_t>{1, 1, 2, 2, 3}));
}

TEST_F(TrafficGeneratorTest, ContinuesATransferThatWasCut) {
  build({kDevice, 100, 0, 1000 * kUs, 0}, 20);
  master().bursts = {write_of(1)};
  bench->request_at(0);
  simulate_to(100 * kUs);
  EXPECT_EQ(load->transfers(), 1U);
  EXPECT_EQ(load_stats().transactions, 2U);
  EXPECT_EQ(load_stats().words, 100U);
}

// The latency timer does not cut the wait for the first word.
TEST_F(TrafficGeneratorTest, OccupiesTheBusForTheAccessTimeOfItsDevice) {
  build({kDevice, 1, 0, 0, 50 * kUs});
  master().bursts = {write_of(1)};
  bench->request_at(1000);
  simulate_to(60 * kUs);
  const std::uint64_t first = bench->bus->clock().edge_at_or_after(bench->edge(1) + 50 * kUs);
  ASSERT_EQ(master().ended.size(), 1U);
  EXPECT_EQ(master().ended[0].address_ps, bench->edge(first + 2));
}

TEST_F(TrafficGeneratorTest, ReadsAnotherTarget) {
  build({PciBusBench::kBase + 0x40, 4, 0, 1000 * kUs, 0});
  simulate_to(kUs);
  ASSERT_EQ(target().accesses.size(), 1U);
  EXPECT_FALSE(target().accesses[0].write);
  EXPECT_EQ(target().accesses[0].address, 0x40U);
  EXPECT_EQ(target().accesses[0].words.size(), 4U);
}

TEST_F(TrafficGeneratorTest, ReportsAnAddressWithoutTarget) {
  build({0x10, 4, 0, 0, 0});
  expect_report("load: address = 16: no target answers");
}

TEST_F(TrafficGeneratorTest, ReportsATargetThatAnswersWithAnError) {
  build({PciBusBench::kBase, 4, 0, 0, 0});
  target().response = tlm::TLM_GENERIC_ERROR_RESPONSE;
  expect_report("load: address = 65536: the target answers with an error");
}

TEST(TrafficGeneratorDevice, ReadsAsZerosAfterItsAccessTimeAndRefusesOtherAccesses) {
  test::ProtocolOptions options;
  options.whole_words = false;
  options.streaming_bursts = true;
  test::MonitoringBinder binder(options);
  test::TestHost host("host");
  PciBusConfig bus_config;
  bus_config.masters = {"load"};
  PciBus bus("bus", bus_config);
  TrafficGenerator load("load", {0, 1, kUs, 0, 5'000});
  load.pci.bind(bus.slots[0]);
  binder.bind(host.socket, load.device, "host_to_device");
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  const auto answer = host.read(0x20);
  EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(answer.word, 0U);
  EXPECT_EQ(answer.at, Clock::to_time(5'000));
  const test::RefusedAccess refused[] = {
      {tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_WRITE_COMMAND},
      {tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_IGNORE_COMMAND},
      {tlm::TLM_BURST_ERROR_RESPONSE, tlm::TLM_READ_COMMAND, 0, 6, 6},
      {tlm::TLM_BURST_ERROR_RESPONSE, tlm::TLM_READ_COMMAND, 0, 8, 4},
      {tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, tlm::TLM_READ_COMMAND, 0, 4, 4, 4},
  };
  for (const test::RefusedAccess& access : refused) test::expect_refused(host.socket, access);
}

}  // namespace
}  // namespace stereotlm::pci
