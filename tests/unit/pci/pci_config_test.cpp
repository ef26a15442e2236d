#include "models/pci/pci_config.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "models/pci/pci_bus.h"
#include "models/pci/traffic_generator.h"

namespace stereotlm::pci {
namespace {

using Problems = std::vector<std::string>;

PciBusConfig good() {
  PciBusConfig config;
  config.masters = {"a", "b"};
  config.windows = {{0x1000, 0x1000, 0}, {0x2000, 0x1000, 255}, {0x8000'0000, 0x8000'0000, 0}};
  return config;
}

TEST(PciBusConfig, AllowsTheEndsOfEachRange) {
  EXPECT_EQ(problems(good()), Problems{});
  for (const double clock_mhz : {1.0, 1000.0}) {
    for (const int timer : {0, 255}) {
      PciBusConfig config = good();
      config.clock_mhz = clock_mhz;
      config.latency_timer_clocks = timer;
      EXPECT_EQ(problems(config), Problems{});
    }
  }
}

TEST(PciBusConfig, RefusesWhatLiesOutsideItsRange) {
  PciBusConfig config = good();
  config.clock_mhz = 0.999;
  config.latency_timer_clocks = 256;
  config.windows[0].wait_clocks = 256;
  config.windows[1].wait_clocks = -1;
  EXPECT_EQ(problems(config),
            (Problems{"clock_mhz = 0.999000: must be 1..1000", "latency_timer_clocks = 256: must be 0..255",
                      "windows[0].wait_clocks = 256: must be 0..255",
                      "windows[1].wait_clocks = -1: must be 0..255"}));
  config = good();
  config.latency_timer_clocks = -1;
  config.clock_mhz = 1001;
  EXPECT_EQ(problems(config).size(), 2U);
}

TEST(PciBusConfig, RefusesAWindowOfBrokenWords) {
  PciBusConfig config = good();
  config.windows = {{2, 4, 0}, {16, 6, 0}, {32, 0, 0}};
  EXPECT_EQ(problems(config), (Problems{"windows[0].base = 2: must be 0..4294967292, a multiple of 4",
                                        "windows[1].bytes = 6: must be 4..2147483648, a multiple of 4",
                                        "windows[2].bytes = 0: must be 4..2147483648, a multiple of 4"}));
}

TEST(PciBusConfig, RefusesAWindowThatLeavesTheAddresses) {
  PciBusConfig config = good();
  config.windows = {{0xFFFF'FFF8, 12, 0}};
  EXPECT_EQ(problems(config), Problems{"windows[0].bytes = 12: must be at most 8 from its base on"});
}

TEST(PciBusConfig, RefusesWindowsThatOverlap) {
  PciBusConfig config = good();
  config.windows = {{0x1000, 0x1000, 0}, {0x1FFC, 8, 0}};
  EXPECT_EQ(problems(config), Problems{"windows[1].base = 8188: must not overlap windows[0]"});
}

TEST(PciBusConfig, RefusesMastersWithoutNamesOfTheirOwn) {
  PciBusConfig config = good();
  config.masters = {"a", "", "a"};
  EXPECT_EQ(problems(config), (Problems{"masters = \"\": must be names, each once",
                                        "masters = \"a\": must be names, each once"}));
  config.masters.clear();
  EXPECT_EQ(problems(config), Problems{"masters = 0: must be 1..64"});
}

TEST(PciBus, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(PciBus("bus", PciBusConfig{}), std::invalid_argument);
  PciBusConfig config = good();
  config.clock_mhz = 0;
  EXPECT_THROW(PciBus("bus", config), std::invalid_argument);
}

TEST(TrafficGeneratorConfig, AllowsTheEndsOfEachRange) {
  EXPECT_EQ(problems(TrafficGeneratorConfig{0, 1, 0, 0, 0}), Problems{});
  EXPECT_EQ(problems(TrafficGeneratorConfig{0xFFFF'F000, 1024, 1'000'000'000'000'000, 1'000'000'000'000'000,
                                   1'000'000'000'000}),
            Problems{});
}

TEST(TrafficGeneratorConfig, RefusesWhatLiesOutsideItsRange) {
  EXPECT_EQ(
      problems(TrafficGeneratorConfig{2, 0, 1'000'000'000'000'001, 1'000'000'000'000'002, 1'000'000'000'001}),
      (Problems{"address = 2: must be 0..4294967292, a multiple of 4", "burst_words = 0: must be 1..1024",
                "first_request_ps = 1000000000000001: must be 0..1000000000000000",
                "interval_ps = 1000000000000002: must be 0..1000000000000000",
                "access_ps = 1000000000001: must be 0..1000000000000"}));
  EXPECT_EQ(problems(TrafficGeneratorConfig{0, 1025, 0, 0, 0}), Problems{"burst_words = 1025: must be 1..1024"});
}

TEST(TrafficGeneratorConfig, RefusesATransferThatLeavesTheAddresses) {
  EXPECT_EQ(problems(TrafficGeneratorConfig{0xFFFF'FFF8, 2, 0, 0, 0}), Problems{});
  EXPECT_EQ(problems(TrafficGeneratorConfig{0xFFFF'FFF8, 3, 0, 0, 0}),
            Problems{"burst_words = 3: must be at most 2 from its address on"});
}

TEST(TrafficGenerator, RefusesAConfigurationWithProblems) {
  TrafficGeneratorConfig config;
  config.burst_words = 0;
  EXPECT_THROW(TrafficGenerator("load", config), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::pci
