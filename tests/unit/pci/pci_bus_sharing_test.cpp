#include <gtest/gtest.h>

#include <numeric>

#include "tests/unit/pci/pci_bus_bench.h"

// Several masters: who gets the bus when.
namespace stereotlm::pci {
namespace {

// The slots in the order of their address clocks.
std::vector<std::size_t> order_of(const PciBusBench& bench) {
  std::vector<std::pair<std::uint64_t, std::size_t>> bursts;
  for (std::size_t master = 0; master < bench.masters.size(); ++master) {
    for (const auto& burst : bench.masters[master]->ended) bursts.emplace_back(burst.address_ps, master);
  }
  std::sort(bursts.begin(), bursts.end());
  std::vector<std::size_t> order;
  for (const auto& burst : bursts) order.push_back(burst.second);
  return order;
}

TEST(PciBus, GrantsInTurnFromTheFirstSlotOn) {
  PciBusBench bench(PciBusBench::with_window(0), 3);
  for (std::size_t master : {2U, 1U, 0U}) {
    bench.masters[master]->bursts = {write_of(2), write_of(2)};
    bench.request_at(0, master);
  }
  sc_core::sc_start();
  EXPECT_EQ(order_of(bench), (std::vector<std::size_t>{0, 1, 2, 0, 1, 2}));
}

TEST(PciBus, SearchesFromTheSlotAfterTheLastOneGranted) {
  PciBusBench bench(PciBusBench::with_window(0), 4);
  for (std::size_t master = 0; master < 4; ++master) bench.masters[master]->bursts = {write_of(4)};
  bench.request_at(0, 2);
  for (const std::size_t master : {0U, 1U, 3U}) bench.request_at(bench.edge(2), master);
  sc_core::sc_start();
  EXPECT_EQ(order_of(bench), (std::vector<std::size_t>{2, 3, 0, 1}));
}

TEST(PciBus, SharesFairlyBetweenTwoMasters) {
  constexpr std::size_t kBursts = 200;
  PciBusBench bench(PciBusBench::with_window(4, 64), 2);
  for (auto& master : bench.masters) master->bursts.assign(kBursts, write_of(32));
  bench.request_at(0, 0);
  bench.request_at(0, 1);
  sc_core::sc_start();
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < 2 * kBursts; ++i) expected.push_back(i % 2);
  EXPECT_EQ(order_of(bench), expected);
}

// Two masters with far more to say than the timer allows get the same number of words.
TEST(PciBus, SharesFairlyBetweenLongBursts) {
  constexpr int kTimer = 64;
  constexpr int kWait = 4;
  PciBusBench bench(PciBusBench::with_window(kWait, kTimer), 2);
  for (auto& master : bench.masters) {
    master->bursts.assign(100, write_of(1000));
    bench.request_at(0, master == bench.masters[1] ? 1 : 0);
  }
  sc_core::sc_start(Clock::to_time(bench.edge(100 * (kTimer + 2))));
  EXPECT_EQ(bench.masters[0]->words_done(), 50U * (kTimer - kWait));
  EXPECT_EQ(bench.masters[1]->words_done(), 50U * (kTimer - kWait));
}

TEST(PciBus, CountsARequestAtTheEdgeInAnyDelta) {
  PciBusBench bench(PciBusBench::with_window(0), 2);
  bench.masters[0]->bursts = {write_of(1)};
  bench.masters[1]->bursts = {write_of(1)};
  bench.request_at(bench.edge(5), 1);
  bench.at(
      bench.edge(5), [&bench] { bench.masters[0]->request(); }, 20);
  sc_core::sc_start();
  EXPECT_EQ(order_of(bench), (std::vector<std::size_t>{0, 1}));
}

TEST(PciBus, DoesNotCountARequestAPicosecondAfterTheEdge) {
  PciBusBench bench(PciBusBench::with_window(0), 2);
  bench.masters[0]->bursts = {write_of(1)};
  bench.masters[1]->bursts = {write_of(1)};
  bench.request_at(bench.edge(5), 1);
  bench.request_at(bench.edge(5) + 1, 0);
  sc_core::sc_start();
  EXPECT_EQ(order_of(bench), (std::vector<std::size_t>{1, 0}));
}

TEST(PciBus, CountsTheClocksFromARequestToItsAddressClock) {
  PciBusBench bench(PciBusBench::with_window(0), 3);
  for (auto& master : bench.masters) master->bursts = {write_of(10)};
  bench.request_at(0, 0);                  // clocks 0..10, idle 11
  bench.request_at(0, 1);                  // from 12 on: waited 12
  bench.request_at(bench.edge(3) + 1, 2);  // could have begun in clock 4, does in 24
  sc_core::sc_start();
  const auto stats = bench.bus->stats();
  EXPECT_EQ(stats.masters[0].wait_clocks, 0U);
  EXPECT_EQ(stats.masters[1].wait_clocks, 12U);
  EXPECT_EQ(stats.masters[2].wait_clocks, 20U);
  EXPECT_EQ(stats.busy_clocks, 33U);
}

TEST(PciBus, CountsARepeatedRequestFromTheFirstOn) {
  PciBusBench bench(PciBusBench::with_window(0), 2);
  for (auto& master : bench.masters) master->bursts = {write_of(10)};
  bench.request_at(0, 0);              // clocks 0..10, idle 11
  bench.request_at(bench.edge(2), 1);  // granted clock 12
  bench.request_at(bench.edge(5), 1);
  bench.request_at(bench.edge(12) + 1, 1);  // at the time of the decision
  sc_core::sc_start();
  ASSERT_EQ(bench.masters[1]->ended.size(), 1U);
  EXPECT_EQ(bench.masters[1]->ended[0].address_ps, bench.edge(12));
  EXPECT_EQ(bench.bus->stats().masters[1].wait_clocks, 10U);
}

TEST(PciBus, TakesARequestThatIsAnnouncedFromItsTimeOn) {
  PciBusBench bench(PciBusBench::with_window(0), 2);
  bench.masters[0]->bursts = {write_of(1)};
  bench.masters[1]->bursts = {write_of(1)};
  bench.at(0, [&bench] { bench.masters[0]->pci->request(*bench.masters[0], bench.edge(10) + 1); });
  bench.request_at(bench.edge(3), 1);
  sc_core::sc_start();
  ASSERT_EQ(bench.masters[0]->ended.size(), 1U);
  ASSERT_EQ(bench.masters[1]->ended.size(), 1U);
  EXPECT_EQ(bench.masters[1]->ended[0].address_ps, bench.edge(3));
  EXPECT_EQ(bench.masters[0]->ended[0].address_ps, bench.edge(11));
  EXPECT_EQ(bench.masters[0]->ended[0].granted_ps, bench.edge(11));
  EXPECT_EQ(bench.bus->stats().masters[0].wait_clocks, 0U);
}

TEST(PciBus, PassesAGrantThatIsGivenBackToTheNextInTheSameClock) {
  PciBusBench bench(PciBusBench::with_window(0), 3);
  bench.masters[2]->bursts = {write_of(1)};
  for (const std::size_t master : {0U, 1U, 2U}) bench.request_at(bench.edge(5), master);
  sc_core::sc_start();
  EXPECT_EQ(bench.masters[0]->grants, 1);
  EXPECT_EQ(bench.masters[1]->grants, 1);
  ASSERT_EQ(bench.masters[2]->ended.size(), 1U);
  EXPECT_EQ(bench.masters[2]->ended[0].address_ps, bench.edge(5));
  EXPECT_EQ(bench.bus->stats().masters[0].transactions, 0U);
}

TEST(PciBus, TakesTheTurnOfAMasterThatGivesItsGrantBack) {
  PciBusBench bench(PciBusBench::with_window(0), 2);
  bench.request_at(0, 0);  // with nothing to transfer
  bench.at(bench.edge(5), [&bench] {
    for (auto& master : bench.masters) {
      master->bursts = {write_of(1)};
      master->request();
    }
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.masters[0]->grants, 2);
  EXPECT_EQ(order_of(bench), (std::vector<std::size_t>{1, 0}));
}

TEST(PciBus, GivesAMasterThatAsksAgainWhenItGivesTheBusBackTheNextClock) {
  PciBusBench bench(PciBusBench::with_window(0), 1);
  TestMaster& master = *bench.masters[0];
  master.on_begin = [&] {
    if (master.grants < 4) {
      master.request();
    } else {
      master.bursts = {write_of(1)};
    }
  };
  bench.request_at(bench.edge(5));
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 1U);
  EXPECT_EQ(master.ended[0].address_ps, bench.edge(8));
  EXPECT_EQ(bench.bus->stats().busy_clocks, 2U);
}

// What happens at the very time of the edge counts, in whatever delta cycle; what happens 1 ps later does not.
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
  ASSERT_EQ(bench.masters[0]->ended.size(), 1U);
  EXPECT_EQ(bench.masters[0]->ended[0].address_ps, bench.edge(5));
  EXPECT_EQ(bench.masters[0]->ended[0].result.words, 2U);
}

// Each waits with its decision until nothing else is pending.
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

TEST(PciBus, HasTheClockOfEachSlot) {
  PciBusBench bench(PciBusBench::with_window(0), 1);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  EXPECT_EQ(bench.masters[0]->pci->clock().edge_ps(7), bench.edge(7));
}

}  // namespace
}  // namespace stereotlm::pci
