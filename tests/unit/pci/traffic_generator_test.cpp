#include "models/pci/traffic_generator.h"

#include <gtest/gtest.h>

#include "tests/support/expected_report.h"
#include "tests/support/test_host.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

constexpr std::uint32_t kDevice = 0x4000'0000;
constexpr std::uint32_t kDeviceBytes = 0x1000;

// A load with its device in a window without wait clocks, a scripted master m0 and its target.
class TrafficGeneratorTest : public testing::Test {
 protected:
  void build(const TrafficGeneratorConfig& config, int latency_timer_clocks = 64) {
    PciBusConfig bus_config;
    bus_config.latency_timer_clocks = latency_timer_clocks;
    bus_config.masters = {"load", "m0"};
    bus_config.windows = {{kDevice, kDeviceBytes, 0}, {PciBusBench::kBase, PciBusBench::kBytes, 0}};
    bus = std::make_unique<PciBus>("bus", bus_config);
    load = std::make_unique<TrafficGenerator>("load", config);
    load->pci.bind(bus->slots[0]);
    binder.bind(bus->targets[0], load->device, "bus_to_device");
    master.pci.bind(bus->slots[1]);
    binder.bind(bus->targets[1], target.socket, "bus_to_target");
  }
  static TrafficGeneratorConfig reads(int burst_words, std::uint64_t interval_ps) {
    return {kDevice, burst_words, 0, interval_ps, 0};
  }
  std::uint64_t edge(std::uint64_t clock) const { return bus->clock().edge_ps(clock); }
  void simulate_to_edge(std::uint64_t clock) { sc_core::sc_start(Clock::to_time(edge(clock))); }
  std::uint64_t load_words() const { return bus->stats().masters[0].words; }

  test::MonitoringBinder binder;
  std::unique_ptr<PciBus> bus;
  std::unique_ptr<TrafficGenerator> load;
  TestMaster master{"m0"};
  TestTarget target{"target"};
};

TEST_F(TrafficGeneratorTest, HogsTheBusWithoutInterval) {
  build(reads(32, 0));
  simulate_to_edge(1000 * 34);
  EXPECT_EQ(load->transfers(), 1000U);
  EXPECT_EQ(bus->stats().busy_clocks, 1000U * 33);
  EXPECT_EQ(bus->stats().masters[0].wait_clocks, 999U);  // the idle clocks
}

TEST_F(TrafficGeneratorTest, AsksOnceAnInterval) {
  const std::uint64_t interval_ps = 1'000'000;
  build(reads(8, interval_ps));
  sc_core::sc_start(Clock::to_time(100 * interval_ps));
  EXPECT_EQ(load->transfers(), 100U);
  EXPECT_EQ(load_words(), 800U);
}

TEST_F(TrafficGeneratorTest, BeginsWithItsFirstRequest) {
  TrafficGeneratorConfig config = reads(8, 0);
  config.first_request_ps = 10'000'000;
  build(config);
  const std::uint64_t first = bus->clock().edge_at_or_after(config.first_request_ps);
  simulate_to_edge(first);
  EXPECT_EQ(bus->stats().busy_clocks, 0U);
  sc_core::sc_start(Clock::to_time(edge(first + 1) - edge(first)));
  EXPECT_EQ(bus->stats().busy_clocks, 1U);
}

// The second transfer comes due while another master has the bus, and still ends before the third does.
TEST_F(TrafficGeneratorTest, KeepsItsTimesAfterATransferThatHadToWait) {
  const std::uint64_t interval_ps = 3'000'000;  // 100 clocks
  build(reads(4, interval_ps), 255);
  target.read_delays = Clock::to_time(edge(1 + 120) - edge(1));
  master.bursts = {read_of(1)};
  sc_core::sc_spawn(
      [this] { master.request(); });  // clocks 6..128, between the first transfer and the second
  std::vector<std::uint64_t> transfers;
  for (const std::uint64_t clock : {105U, 134U, 135U, 204U, 206U}) {
    sc_core::sc_start(Clock::to_time(edge(clock)) - sc_core::sc_time_stamp());
    transfers.push_back(load->transfers());
  }
  EXPECT_EQ(transfers, (std::vector<std::uint64_t>{1, 1, 2, 2, 3}));
}

TEST_F(TrafficGeneratorTest, SharesTheBusWithAMasterThatIsAsBusy) {
  build(reads(32, 0));
  master.bursts.assign(100, write_of(32));
  sc_core::sc_spawn([this] { master.request(); });
  simulate_to_edge(200 * 34);
  EXPECT_EQ(master.words_done(), 3200U);
  EXPECT_EQ(load_words(), 3200U);
}

TEST_F(TrafficGeneratorTest, GoesOnWithTheRestOfATransferThatWasCut) {
  build(reads(100, 1'000'000'000), 20);
  master.bursts = {write_of(1)};
  sc_core::sc_spawn([this] { master.request(); });
  sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_US) * 100);
  EXPECT_EQ(load->transfers(), 1U);
  EXPECT_EQ(bus->stats().masters[0].transactions, 2U);
  EXPECT_EQ(load_words(), 100U);
}

// The wait for the first word keeps the others off the bus, whatever the latency timer says.
TEST_F(TrafficGeneratorTest, HoldsTheBusForTheAccessTimeOfItsDevice) {
  TrafficGeneratorConfig config = reads(1, 0);
  config.access_ps = 50'000'000;
  build(config);
  master.bursts = {write_of(1)};
  sc_core::sc_spawn([this] {
    sc_core::wait(sc_core::sc_time(1, sc_core::SC_NS));
    master.request();
  });
  sc_core::sc_start(sc_core::sc_time(60, sc_core::SC_US));
  const std::uint64_t first = bus->clock().edge_at_or_after(edge(1) + config.access_ps);
  ASSERT_EQ(master.ended.size(), 1U);
  EXPECT_EQ(master.ended[0].address_ps, edge(first + 2));
}

TEST_F(TrafficGeneratorTest, ReadsAnotherTarget) {
  build({PciBusBench::kBase + 0x40, 4, 0, 1'000'000'000, 0});
  sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_US));
  ASSERT_EQ(target.accesses.size(), 1U);
  EXPECT_FALSE(target.accesses[0].write);
  EXPECT_EQ(target.accesses[0].address, 0x40U);
  EXPECT_EQ(target.accesses[0].words.size(), 4U);
}

TEST_F(TrafficGeneratorTest, ReportsAnAddressWithoutTarget) {
  build({0x10, 4, 0, 0, 0});
  test::ExpectedReport report("/stereotlm/traffic_generator");
  EXPECT_THROW(sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_US)), sc_core::sc_report);
  EXPECT_EQ(report.text(), "load: address = 16: no target answers");
}

TEST_F(TrafficGeneratorTest, ReportsATargetThatAnswersWithAnError) {
  build({PciBusBench::kBase, 4, 0, 0, 0});
  target.response = tlm::TLM_GENERIC_ERROR_RESPONSE;
  test::ExpectedReport report("/stereotlm/traffic_generator");
  EXPECT_THROW(sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_US)), sc_core::sc_report);
  EXPECT_EQ(report.text(), "load: address = 65536: the target answers with an error");
}

// The device by itself.
class PciLoadDevice : public testing::Test {
 protected:
  PciLoadDevice() {
    payload.set_command(tlm::TLM_READ_COMMAND);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
    payload.set_data_length(8);
    payload.set_streaming_width(8);
  }
  // Leaves the load's own side of the bus to a bus without windows.
  void build(const test::ProtocolOptions& options = {}) {
    PciBusConfig config;
    config.masters = {"load"};
    bus = std::make_unique<PciBus>("bus", config);
    load = std::make_unique<TrafficGenerator>("load", TrafficGeneratorConfig{0, 1, 1'000'000, 0, 5'000});
    load->pci.bind(bus->slots[0]);
    binder = std::make_unique<test::MonitoringBinder>(options);
    binder->bind(host.socket, load->device, "host_to_device");
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  tlm::tlm_response_status answer() {
    delay = sc_core::SC_ZERO_TIME;
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    host.socket->b_transport(payload, delay);
    return payload.get_response_status();
  }

  std::unique_ptr<test::MonitoringBinder> binder;
  std::unique_ptr<PciBus> bus;
  std::unique_ptr<TrafficGenerator> load;
  test::TestHost host{"host"};
  tlm::tlm_generic_payload payload;
  std::array<std::uint32_t, 2> words{7, 7};
  std::array<unsigned char, 4> enables{};
  sc_core::sc_time delay;
};

TEST_F(PciLoadDevice, ReadsAsZerosAfterItsAccessTime) {
  build();
  EXPECT_EQ(answer(), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(words, (std::array<std::uint32_t, 2>{0, 0}));
  EXPECT_EQ(delay, sc_core::sc_time(5, sc_core::SC_NS));
}

TEST_F(PciLoadDevice, RefusesWritesByteEnablesAndBrokenWords) {
  test::ProtocolOptions options;
  options.whole_words = false;
  options.streaming_bursts = true;
  build(options);
  payload.set_command(tlm::TLM_WRITE_COMMAND);
  EXPECT_EQ(answer(), tlm::TLM_COMMAND_ERROR_RESPONSE);
  payload.set_command(tlm::TLM_READ_COMMAND);
  payload.set_data_length(6);
  EXPECT_EQ(answer(), tlm::TLM_BURST_ERROR_RESPONSE);
  payload.set_data_length(8);
  payload.set_streaming_width(4);
  EXPECT_EQ(answer(), tlm::TLM_BURST_ERROR_RESPONSE);
  payload.set_streaming_width(8);
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  EXPECT_EQ(answer(), tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  EXPECT_EQ(delay, sc_core::SC_ZERO_TIME);
  EXPECT_EQ(words, (std::array<std::uint32_t, 2>{7, 7}));
}

}  // namespace
}  // namespace stereotlm::pci
