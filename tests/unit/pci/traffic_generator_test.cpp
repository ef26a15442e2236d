#include "models/pci/traffic_generator.h"

#include <gtest/gtest.h>

#include "models/testing/expected_report.h"
#include "models/testing/test_host.h"
#include "tests/support/refused_access.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

constexpr std::uint64_t kUs = 1'000'000;  // ps

// The load on a bus with a target. random_computers_test.cpp compares its times and words with a plain load.
class TrafficGeneratorTest : public testing::Test {
 protected:
  void build(std::uint32_t address) {
    PciBusConfig bus_config = PciBusBench::with_window(0, 0);
    bus_config.masters = {"load"};
    bench = std::make_unique<PciBusBench>(bus_config);
    load = std::make_unique<TrafficGenerator>("load", TrafficGeneratorConfig{address, 4, 0, 1000 * kUs, 0});
    load->pci.bind(bench->bus->slots[0]);
  }
  TestTarget& target() { return *bench->targets[0]; }
  void expect_report(const std::string& text) {
    test::ExpectedReport report("/stereotlm/traffic_generator");
    EXPECT_THROW(sc_core::sc_start(1, sc_core::SC_US), sc_core::sc_report);
    EXPECT_EQ(report.text(), text);
  }

  std::unique_ptr<PciBusBench> bench;
  std::unique_ptr<TrafficGenerator> load;
};

TEST_F(TrafficGeneratorTest, ReportsAnAddressWithoutTarget) {
  build(0x10);
  expect_report("load: address = 16: no target answers");
}

TEST_F(TrafficGeneratorTest, ReportsATargetThatAnswersWithAnError) {
  build(PciBusBench::kBase);
  target().response = tlm::TLM_GENERIC_ERROR_RESPONSE;
  expect_report("load: address = 65536: the target answers with an error");
}

TEST(TrafficGeneratorDevice, ReadsAsZerosAfterItsAccessTimeAndRefusesOtherAccesses) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  test::ProtocolOptions options;
  options.whole_words = false;
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
  EXPECT_EQ(answer.at, kernel_time::to_time(5'000));
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
