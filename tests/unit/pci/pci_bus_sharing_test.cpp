// What the random computers do not reach.
#include <gtest/gtest.h>

#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

TEST(PciBus, CountsAnUnusedGrantAsTheTurnOfItsMaster) {
  PciBusBench bench(PciBusBench::with_window(0), 2);
  bench.request_at(0, 0);  // without a burst
  bench.at(bench.edge(5), [&bench] {
    for (auto& master : bench.masters) {
      master->bursts = {write_of(4)};
      master->request();
    }
  });
  sc_core::sc_start();
  EXPECT_LT(bench.masters[1]->ended.at(0).address_ps, bench.masters[0]->ended.at(0).address_ps);
}

TEST(PciBus, GrantsTheNextClockToAMasterThatRequestsAgainAsItReturnsItsGrant) {
  PciBusBench bench(PciBusBench::with_window(0));
  TestMaster& master = *bench.masters[0];
  int unused = 0;
  master.on_unused = [&] {
    if (++unused == 3) master.bursts = {write_of(1)};
    master.request();
  };
  bench.request_at(bench.edge(5));
  sc_core::sc_start();
  EXPECT_EQ(unused, 3);
  EXPECT_EQ(master.ended.at(0).address_ps, bench.edge(8));
  EXPECT_EQ(bench.bus->stats().busy_clocks, 2U);
}

// Each bus decides when nothing else is pending.
TEST(PciBus, DecidesBesideAnotherBusWithTheSameEdges) {
  struct Machine : sc_core::sc_module {
    explicit Machine(const sc_core::sc_module_name& name) : sc_module(name) {}
    PciBusBench bench{PciBusBench::with_window(0)};
  };
  Machine left("left");
  Machine right("right");
  for (Machine* machine : {&left, &right}) {
    machine->bench.masters[0]->bursts = {write_of(2), write_of(2)};
    machine->bench.request_at(machine->bench.edge(5));
  }
  sc_core::sc_start();
  for (const Machine* machine : {&left, &right}) {
    ASSERT_EQ(machine->bench.masters[0]->ended.size(), 2U);
    EXPECT_EQ(machine->bench.masters[0]->ended[1].address_ps, machine->bench.edge(5 + 4));
  }
}

TEST(PciBus, CountsClocksAndWordsUpToNow) {
  PciBusBench bench(PciBusBench::with_window(kWait));
  bench.masters[0]->bursts = {write_of(5)};
  bench.request_at(bench.edge(10));
  const auto expect_at = [&bench](std::uint64_t time_ps, std::uint64_t clocks, std::uint64_t busy) {
    bench.at(time_ps, [&bench, clocks, busy] {
      const auto stats = bench.bus->stats();
      EXPECT_EQ(stats.clocks, clocks);
      EXPECT_EQ(stats.busy_clocks, busy) << "at clock " << clocks;
    });
  };
  constexpr std::uint64_t kEnd = 10 + 1 + kWait + 5;
  expect_at(bench.edge(10), 10, 0);
  expect_at(bench.edge(12) - 1, 11, 1);
  expect_at(bench.edge(12), 12, 2);
  expect_at(bench.edge(kEnd) - 1, kEnd - 1, kWait + 5);
  expect_at(bench.edge(kEnd), kEnd, 1 + kWait + 5);
  expect_at(bench.edge(kEnd + 30), kEnd + 30, 1 + kWait + 5);
  sc_core::sc_start();
  const auto stats = bench.bus->stats();
  EXPECT_EQ(stats.masters.at(0).name, "m0");
  EXPECT_EQ(stats.masters[0].words, 5U);
  EXPECT_EQ(stats.masters[0].retries, 0U);
  EXPECT_EQ(stats.masters[0].aborts, 0U);
}

}  // namespace
}  // namespace stereotlm::pci
