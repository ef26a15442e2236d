// GenericCrossbar takes the same cycles at every clock: all kinds of banks, 1 to 1,000 MHz by steps of
// 0.333 MHz, one port and two, b_transport and nb_transport.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <vector>

#include "models/kernel_time.h"
#include "models/memory/generic_crossbar.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/traffic.h"
#include "tests/support/fork.h"

namespace stereotlm::memory {
namespace {

std::vector<SsramBankConfig> banks_at(double mhz) {
  return {{64, BankKind::kZbtPipelined, 0, mhz},
          {64, BankKind::kZbtFlowThrough, 0, mhz},
          {64, BankKind::kSyncBurst, 2, mhz},
          {64, BankKind::kQdr, 0, mhz},
          {64, BankKind::kSdram, 0, mhz, SdramTiming{}}};
}

// A crossbar whose ports access one bank after the other. A port is alone, then two contend, with b_transport
// from cycle 0 on, with nb_transport from cycle 1,000 on.
struct ClockedCrossbar {
  explicit ClockedCrossbar(double mhz)
      : crossbar(sc_core::sc_gen_unique_name("crossbar"),
                 {{"round_robin", {0, 1, 2, 3, 4, 5}}, banks_at(mhz)}) {
    using Style = test::TrafficInitiator::Style;
    for (const SsramBankConfig& bank : banks_at(mhz))
      crossbar.banks[banks.size()].bind(banks.emplace_back(sc_core::sc_gen_unique_name("bank"), bank).port);
    for (const int first_cycle : {1, 500, 500, 1000, 1500, 1500}) {
      std::vector<test::TrafficAccess> accesses;
      for (std::size_t bank = 0; bank < banks.size(); ++bank) {
        const auto here = test::random_traffic({bank, 4, crossbar_address(bank, 0), 64, 3, 40, {}});
        accesses.insert(accesses.end(), here.begin(), here.end());
      }
      accesses.front().pause = sc_core::sc_time((first_cycle - 0.5) / mhz, sc_core::SC_US);
      const Style style = first_cycle < 1000 ? Style::kBlocking : Style::kNonBlocking;
      ports.emplace_back(sc_core::sc_gen_unique_name("initiator"), accesses, style);
      ports.back().socket().bind(crossbar.ports[ports.size() - 1]);
    }
  }

  // The cycle with which each port ends, 0 if none begins at that time; and the contended cycles, the grants
  // and the blame of each bank.
  std::vector<std::uint64_t> figures() const {
    std::vector<std::uint64_t> figures;
    for (const test::TrafficInitiator& port : ports) {
      const std::uint64_t end_ps = kernel_time::to_ps(port.end());
      const std::uint64_t cycle = crossbar.clock().edge_at_or_after(end_ps);
      figures.push_back(port.is_done() && crossbar.clock().edge_ps(cycle) == end_ps ? cycle : 0);
    }
    for (std::size_t bank = 0; bank < banks.size(); ++bank) {
      const ArbiterStats stats = crossbar.stats(bank);
      figures.push_back(stats.contended_cycles());
      figures.insert(figures.end(), stats.counts().begin() + ArbiterStats::kFirstGrants,
                     stats.counts().end());
    }
    return figures;
  }

  GenericCrossbar crossbar;
  std::deque<SsramBank> banks;
  std::deque<test::TrafficInitiator> ports;
};

TEST(GenericCrossbar, TakesTheSameCyclesAtEveryClock) {
  constexpr int kChildren = 30;
  std::vector<test::ChildWork> jobs;
  for (int child = 0; child < kChildren; ++child) {
    jobs.emplace_back([child] {
      std::vector<double> mhz = {40};
      for (int step = child; step <= 3000; step += kChildren) mhz.push_back((1000 + 333 * step) / 1000.0);
      std::deque<ClockedCrossbar> crossbars;
      for (const double clock : mhz) crossbars.emplace_back(clock);
      sc_core::sc_start();
      std::string differing;
      for (std::size_t number = 0; number < mhz.size(); ++number)
        if (crossbars[number].figures() != crossbars[0].figures() || crossbars[number].figures()[0] == 0)
          differing += fmt::format(" {} MHz", mhz[number]);
      return differing;
    });
  }
  for (const test::ChildResult& result : test::run_in_children(jobs, 2)) EXPECT_EQ(result.text, "");
}

}  // namespace
}  // namespace stereotlm::memory
