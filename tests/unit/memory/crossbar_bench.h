#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <systemc>
#include <vector>

#include "models/memory/crossbar.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {

// A crossbar with a host on each port and three banks of 16 words, one of each kind, every link under a
// monitor. The test plays the clocked process: it calls arbitrate() for the cycles of a 40 MHz clock.
class CrossbarBench : public testing::Test {
 protected:
  static constexpr std::uint32_t kWords = 16;
  static constexpr std::size_t kPipelined = 0;
  static constexpr std::size_t kFlowThrough = 1;
  static constexpr std::size_t kBurst = 2;
  static constexpr std::uint64_t kPeriodPs = 25'000;

  CrossbarBench() {
    const CrossbarConfig config{kFixedPriority,
                                {{kWords, BankKind::kZbtPipelined},
                                 {kWords, BankKind::kZbtFlowThrough},
                                 {kWords, BankKind::kSyncBurst, 2}}};
    crossbar = std::make_unique<Crossbar>("crossbar", config);
    for (std::size_t port = 0; port < kGroupCount; ++port)
      binder.bind(hosts[port].socket, crossbar->ports[port], "port" + std::to_string(port) + "_to_crossbar");
    for (std::size_t bank = 0; bank < config.banks.size(); ++bank) {
      const std::string number = std::to_string(bank);
      banks.push_back(std::make_unique<SsramBank>(("ssram" + number).c_str(), config.banks[bank]));
      binder.bind(crossbar->banks[bank], banks.back()->port, "crossbar_to_bank" + number);
    }
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }

  test::TestHost& at(Port port) { return hosts[port]; }
  void route(Port port, std::size_t bank, bool write) {
    crossbar->arbitration().route(port, bank, write);
    crossbar->aim(port, bank, write);
  }
  // One cycle with these requests.
  PortMask arbitrate(std::uint64_t cycle, PortMask requests = 0) {
    return crossbar->arbitrate(cycle, requests);
  }
  static sc_core::sc_time cycles(std::uint64_t count) {
    return sc_core::sc_time::from_value(count * kPeriodPs);
  }
  std::uint64_t accesses(std::size_t bank) const {
    const SsramBank::Stats& stats = banks[bank]->stats();
    return stats.reads + stats.writes + stats.errors;
  }

  test::MonitoringBinder binder;
  sc_core::sc_vector<test::TestHost> hosts{"test_host", kGroupCount};
  std::vector<std::unique_ptr<SsramBank>> banks;
  std::unique_ptr<Crossbar> crossbar;
};

}  // namespace stereotlm::memory
