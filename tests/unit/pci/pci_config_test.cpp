#include "models/pci/pci_config.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "models/pci/pci_bridge.h"
#include "models/pci/pci_bus.h"
#include "models/pci/traffic_generator.h"

namespace stereotlm::pci {
namespace {

using Problems = std::vector<std::string>;

template <class Config>
struct Case {
  Config config;
  Problems expected;
};

TEST(PciBusConfig, NamesEveryProblem) {
  const std::vector<std::string> two = {"a", "b"};
  const std::vector<PciWindow> windows = {
      {0x1000, 0x1000, 0}, {0x2000, 0x1000, 255}, {0x8000'0000, 0x8000'0000, 0}};
  const Case<PciBusConfig> cases[] = {
      {{1, 0, two, windows}, {}},
      {{1000, 255, two, windows}, {}},
      {{0.999, -1, two, {{0, 4, -1}}},
       {"clock_mhz = 0.999000: must be 1..1000", "latency_timer_clocks = -1: must be 0..255",
        "windows[0].wait_clocks = -1: must be 0..255"}},
      {{1001, 256, two, {{0, 4, 0}, {4, 4, 256}}},
       {"clock_mhz = 1001.000000: must be 1..1000", "latency_timer_clocks = 256: must be 0..255",
        "windows[1].wait_clocks = 256: must be 0..255"}},
      {{33, 0, two, {{2, 4, 0}, {16, 6, 0}, {32, 0, 0}}},
       {"windows[0].base = 2: must be 0..4294967292, a multiple of 4",
        "windows[1].bytes = 6: must be 4..2147483648, a multiple of 4",
        "windows[2].bytes = 0: must be 4..2147483648, a multiple of 4"}},
      {{33, 0, two, {{0xFFFF'FFF8, 12, 0}}}, {"windows[0].bytes = 12: must be at most 8 from its base on"}},
      {{33, 0, two, {{0x1000, 0x1000, 0}, {0x1FFC, 8, 0}}},
       {"windows[1].base = 8188: must not overlap windows[0]"}},
      {{33, 0, {"a", "", "a"}, windows},
       {"masters = \"\": must be names, each once", "masters = \"a\": must be names, each once"}},
      {{33, 0, {}, windows}, {"masters = 0: must be 1..64"}},
      {{33, 0, two, windows, 64}, {}},
      {{33, 0, two, windows, 16}, {"width_bits = 16: must be 32..64, a multiple of 32"}},
      {{33, 0, two, windows, 48}, {"width_bits = 48: must be 32..64, a multiple of 32"}},
      {{33, 0, two, windows, 96}, {"width_bits = 96: must be 32..64, a multiple of 32"}},
  };
  for (const auto& [config, expected] : cases) {
    EXPECT_EQ(problems(config), expected);
    if (!expected.empty()) {
      EXPECT_THROW(PciBus("bus", config), std::invalid_argument);
    }
  }
}

TEST(TrafficGeneratorConfig, NamesEveryProblem) {
  const Case<TrafficGeneratorConfig> cases[] = {
      {{0, 1, 0, 0, 0}, {}},
      {{0xFFFF'F000, 1024, 1'000'000'000'000'000, 1'000'000'000'000'000, 1'000'000'000'000}, {}},
      {{2, 0, 1'000'000'000'000'001, 1'000'000'000'000'002, 1'000'000'000'001},
       {"address = 2: must be 0..4294967292, a multiple of 4", "burst_words = 0: must be 1..1024",
        "first_request_ps = 1000000000000001: must be 0..1000000000000000",
        "interval_ps = 1000000000000002: must be 0..1000000000000000",
        "access_ps = 1000000000001: must be 0..1000000000000"}},
      {{0, 1025, 0, 0, 0}, {"burst_words = 1025: must be 1..1024"}},
      {{0xFFFF'FFF8, 2, 0, 0, 0}, {}},
      {{0xFFFF'FFF8, 3, 0, 0, 0}, {"burst_words = 3: must be at most 2 from its address on"}},
  };
  for (const auto& [config, expected] : cases) {
    EXPECT_EQ(problems(config), expected);
    if (!expected.empty()) {
      EXPECT_THROW(TrafficGenerator("load", config), std::invalid_argument);
    }
  }
}

TEST(PciBridgeConfig, NamesEveryProblem) {
  EXPECT_EQ(problems(PciBridgeConfig{1, 1}), Problems{});
  EXPECT_EQ(problems(PciBridgeConfig{1024, 4096}), Problems{});
  EXPECT_EQ(problems(PciBridgeConfig{0, 0}),
            (Problems{"dma_burst_words = 0: must be 1..1024", "posted_words = 0: must be 1..4096"}));
  EXPECT_EQ(problems(PciBridgeConfig{1025, 4097}),
            (Problems{"dma_burst_words = 1025: must be 1..1024", "posted_words = 4097: must be 1..4096"}));
  EXPECT_THROW(PciBridge("bridge", {0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::pci
