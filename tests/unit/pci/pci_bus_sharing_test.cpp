// Arbitration between several masters. The random boards of pci_bus_random_test.cpp have them in turn.
#include <gtest/gtest.h>

#include <ostream>

#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

using Slots = std::vector<std::size_t>;

// The masters of all bursts, in the order of their address clocks.
Slots order_of(const PciBusBench& bench) {
  std::vector<std::pair<std::uint64_t, std::size_t>> bursts;
  for (std::size_t master = 0; master < bench.masters.size(); ++master) {
    for (const auto& burst : bench.masters[master]->ended) bursts.emplace_back(burst.address_ps, master);
  }
  std::sort(bursts.begin(), bursts.end());
  Slots order;
  for (const auto& burst : bursts) order.push_back(burst.second);
  return order;
}

// Master 1 requests clock 5 at its edge, master 0 some deltas or ps later. It has the first turn.
struct Order {
  const char* name;
  std::uint64_t offset_ps;
  int deltas;
  Slots granted;
};
void PrintTo(const Order& order, std::ostream* out) { *out << order.name; }

class PciBusOrder : public testing::TestWithParam<Order> {};

TEST_P(PciBusOrder, IsThatOfTheSlots) {
  PciBusBench bench(PciBusBench::with_window(0), 2);
  for (auto& master : bench.masters) master->bursts = {write_of(4)};
  bench.request_at(bench.edge(5), 1);
  bench.request_at(bench.edge(5) + GetParam().offset_ps, 0, GetParam().deltas);
  sc_core::sc_start();
  EXPECT_EQ(order_of(bench), GetParam().granted);
}

INSTANTIATE_TEST_SUITE_P(PciBus, PciBusOrder,
                         testing::Values(Order{"with_a_request_in_any_delta_at_the_edge", 0, 20, {0, 1}},
                                         Order{"without_a_request_a_ps_behind_the_edge", 1, 0, {1, 0}}),
                         [](const auto& tested) { return tested.param.name; });

// A change at the time of the edge counts, in whatever delta cycle; a change 1 ps later does not.
TEST(PciBus, DecidesFromTheStateAtTheEdgeOfTheClock) {
  PciBusBench bench(PciBusBench::with_window(0));
  bench.bind_stop();
  std::size_t room = 0;
  bench.targets[0]->writable = [&room](auto, auto words) { return std::min(room, words); };
  bench.masters[0]->bursts = {write_of(4)};
  bench.request_at(bench.edge(5) - 1);
  bench.at(
      bench.edge(5), [&room] { room = 2; }, 4);
  bench.at(bench.edge(5) + 1, [&room] { room = 4; });
  sc_core::sc_start();
  EXPECT_EQ(bench.masters[0]->ended.at(0).address_ps, bench.edge(5));
  EXPECT_EQ(bench.masters[0]->ended.at(0).result.words, 2U);
}

TEST(PciBus, PassesAnUnusedGrantToTheNextMasterInTheSameClock) {
  PciBusBench bench(PciBusBench::with_window(0), 3);
  bench.masters[2]->bursts = {write_of(1)};
  for (const std::size_t master : {0U, 1U, 2U}) bench.request_at(bench.edge(5), master);
  sc_core::sc_start();
  EXPECT_EQ(bench.masters[2]->ended.at(0).address_ps, bench.edge(5));
  EXPECT_EQ(bench.bus->stats().masters[0].transactions, 0U);
}

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
  EXPECT_EQ(order_of(bench), (Slots{1, 0}));
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

TEST(PciBus, DoesNotCutABurstWhoseOwnMasterAloneRequestsAgain) {
  PciBusBench bench(PciBusBench::with_window(3, 20));
  TestMaster& master = *bench.masters[0];
  master.bursts = {write_of(100), write_of(1)};
  master.at_once = false;
  bench.request_at(0);
  bench.request_at(bench.edge(5));
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 2U);
  EXPECT_EQ(master.ended[0].result.words, 100U);
}

TEST(PciBus, KeepsTheFirstOfTwoRequestsOfAMaster) {
  PciBusBench bench(PciBusBench::with_window(0));
  TestMaster& master = *bench.masters[0];
  master.bursts = {write_of(1)};
  bench.at(0, [&] {
    master.pci->request(master, bench.edge(5));
    master.pci->request(master, bench.edge(9));
  });
  sc_core::sc_start();
  EXPECT_EQ(master.ended.at(0).address_ps, bench.edge(5));
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

}  // namespace
}  // namespace stereotlm::pci
