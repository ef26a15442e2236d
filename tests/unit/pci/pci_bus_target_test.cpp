// The effect of targets and addresses on a burst. The random computers have several masters, and their times.
#include <gtest/gtest.h>

#include "models/testing/expected_report.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

// One master, whose first burst begins in clock 0. The second follows at once.
class PciBusTarget : public testing::Test {
 protected:
  PciBusTarget()
      : bench(PciBusBench::with_window(kWait)), master(*bench.masters[0]), target(*bench.targets[0]) {
    bench.bind_stop();
  }
  void simulate(const Script& script) {
    master.bursts = {script, write_of(1)};
    bench.request_at(0);
    sc_core::sc_start();
    ASSERT_EQ(master.ended.size(), 2U);
  }
  const TestMaster::Ended& burst() const { return master.ended[0]; }
  // The clock behind the burst is idle, and the next address clock follows.
  void expect_end_clock(std::uint64_t clock) const {
    EXPECT_EQ(burst().end_ps, bench.edge(clock));
    EXPECT_EQ(master.ended[1].address_ps, bench.edge(clock + 1));
  }
  void expect_nothing_transferred(BurstEnd end) const {
    EXPECT_EQ(burst().result.end, end);
    EXPECT_EQ(burst().result.words, 0U);
    EXPECT_EQ(bench.bus->stats().masters[0].words, 1U);
  }
  // The burst stops the simulation with this report. It is not thrown: the address sanitizer cannot follow an
  // exception through SystemC's stacks.
  void expect_report(const Script& script, const std::string& text) {
    sc_core::sc_report_handler::set_actions("/stereotlm/pci_bus", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
    test::ExpectedReport report("/stereotlm/pci_bus");
    master.bursts = {script};
    bench.request_at(0);
    sc_core::sc_start();
    EXPECT_EQ(report.text(), text);
  }

  PciBusBench bench;
  TestMaster& master;
  TestTarget& target;
};

// A write of 8 words to a target that has room for some of them.
struct Room {
  std::size_t words;
  BurstEnd end;
  std::uint64_t end_clock;
};

class PciBusRoom : public PciBusTarget, public testing::WithParamInterface<Room> {};

TEST_P(PciBusRoom, EndsAWriteAfterTheWordsThatTheTargetAccepts) {
  const Room& room = GetParam();
  std::vector<std::pair<std::uint64_t, std::size_t>> asked;
  target.writable = [&](auto address, auto words) {
    asked.emplace_back(address, words);
    return asked.size() == 1 ? room.words : words;
  };
  simulate(write_of(8, 0x20));
  EXPECT_EQ(asked[0], std::make_pair(std::uint64_t{0x20}, std::size_t{8}));
  EXPECT_EQ(burst().result.end, room.end);
  EXPECT_EQ(burst().result.words, room.words);
  expect_end_clock(room.end_clock);
  EXPECT_EQ(target.accesses.size(), room.words == 0 ? 1U : 2U);
  if (room.words != 0) {
    EXPECT_EQ(target.accesses[0].words, words_from(PciBusBench::kBase + 0x20, room.words));
  }
  EXPECT_EQ(bench.bus->stats().masters[0].retries, room.words == 0 ? 1U : 0U);
  EXPECT_EQ(bench.bus->stats().busy_clocks, room.end_clock + 1 + kWait + 1);
}

INSTANTIATE_TEST_SUITE_P(PciBus, PciBusRoom,
                         testing::Values(Room{0, BurstEnd::kDisconnect, 1},
                                         Room{3, BurstEnd::kDisconnect, 1 + kWait + 3},
                                         Room{8, BurstEnd::kComplete, 1 + kWait + 8}),
                         [](const auto& room) { return std::to_string(room.param.words) + "_words"; });

TEST_F(PciBusTarget, IsReportedIfItAcceptsMoreWordsThanAsked) {
  target.writable = [](auto, auto words) { return words + 1; };
  expect_report(write_of(8), "bus.stop_0: 9 of 8 words can be written");
}

TEST_F(PciBusTarget, OccupiesTheBusForTheTimeThatAWriteTakes) {
  constexpr std::uint64_t kEnd = 1 + kWait + 3;
  target.write_delays = kernel_time::to_time(bench.edge(kEnd + 2) - bench.edge(kEnd) + 1);
  simulate(write_of(3));
  EXPECT_EQ(burst().result.first_data_clock, 1U + kWait);
  EXPECT_EQ(burst().result.words, 3U);
  expect_end_clock(kEnd + 3);
}

class PciBusTargetError : public PciBusTarget, public testing::WithParamInterface<bool> {};

TEST_P(PciBusTargetError, EndsAWriteAfterItsWordsAndAReadWithTheClockOfItsFirstWord) {
  const bool write = GetParam();
  target.response = write ? tlm::TLM_GENERIC_ERROR_RESPONSE : tlm::TLM_ADDRESS_ERROR_RESPONSE;
  bench.at(bench.edge(write ? 1 + kWait + 3 : 1) + 1, [this] { target.response = tlm::TLM_OK_RESPONSE; });
  simulate({write, PciBusBench::kBase, 3});
  expect_nothing_transferred(BurstEnd::kTargetError);
  expect_end_clock(1 + kWait + (write ? 3 : 1));
  EXPECT_EQ(bench.bus->stats().masters[0].aborts, 1U);
  if (!write) {
    EXPECT_EQ(burst().words, std::vector<std::uint32_t>(3));
  }
}

INSTANTIATE_TEST_SUITE_P(PciBus, PciBusTargetError, testing::Bool(),
                         [](const auto& write) { return write.param ? "write" : "read"; });

TEST_F(PciBusTarget, LeavesABurstThatIsNotInsideItsWindowToAMasterAbortAfterFourClocks) {
  const std::uint64_t base = PciBusBench::kBase;
  const std::uint64_t end = base + PciBusBench::kBytes;
  for (const bool write : {true, false}) {
    for (const std::uint64_t address : {std::uint64_t{0}, base - 4, end, (std::uint64_t{1} << 32U) + base})
      master.bursts.push_back({write, address, 1});
    master.bursts.push_back({write, end - 16, 5});
  }
  master.bursts.push_back({true, end - 16, 4});
  bench.request_at(0);
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), 11U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(master.ended[i].result.end, BurstEnd::kMasterAbort);
    EXPECT_EQ(master.ended[i].result.words, 0U);
    EXPECT_EQ(master.ended[i].address_ps, bench.edge(6 * i));
    EXPECT_EQ(master.ended[i].end_ps, bench.edge(6 * i + 5));
  }
  EXPECT_EQ(master.ended[10].result.words, 4U);  // up to the end of the window
  EXPECT_EQ(target.accesses.size(), 1U);
  EXPECT_EQ(bench.bus->stats().masters[0].aborts, 10U);
  EXPECT_EQ(bench.bus->stats().busy_clocks, 10U * 5 + 1 + kWait + 4);
}

TEST_F(PciBusTarget, IsNotReachedAtAnAddressThatIsNotAMultipleOfFour) {
  expect_report(write_of(1, 2), "address = 65538: must be a multiple of 4");
}

// Windows in any order, up to the end of the address space, and the rate of a real bus with their wait
// clocks: bursts of 32 words, 33.33 MHz.
TEST(PciBus, ReachesEachWindowWithinOnePercentOfTheRateOfARealBus) {
  constexpr std::size_t kBursts = 1000;
  constexpr std::size_t kWords = 32;
  const std::vector<double> megabytes_per_second = {122, 115, 107, 89};
  PciBusConfig config;
  config.windows = {{0x8000, 0x1000, 1}, {0x1000, 0x1000, 3}, {0xFFFF'F000, 0x1000, 6}, {0x3000, 0x1000, 14}};
  PciBusBench bench(config);
  TestMaster& master = *bench.masters[0];
  for (const PciWindow& window : config.windows) {
    for (std::size_t i = 0; i < kBursts; ++i) master.bursts.push_back({i % 2 == 0, window.base + 8U, kWords});
  }
  bench.request_at(0);
  sc_core::sc_start();
  ASSERT_EQ(master.ended.size(), kBursts * config.windows.size());
  for (std::size_t window = 0; window < config.windows.size(); ++window) {
    ASSERT_EQ(bench.targets[window]->accesses.size(), kBursts);
    EXPECT_EQ(bench.targets[window]->accesses[0].address, 8U);
    const auto first_ps = master.ended[window * kBursts].address_ps;
    const auto end_ps = master.ended[(window + 1) * kBursts - 1].end_ps;
    const double rate = 4e6 * kBursts * kWords / static_cast<double>(end_ps - first_ps);
    EXPECT_NEAR(rate, megabytes_per_second[window], 0.01 * megabytes_per_second[window]);
  }
}

}  // namespace
}  // namespace stereotlm::pci
