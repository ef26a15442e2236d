#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "models/clock.h"
#include "sw/process/command.h"
#include "sw/trace/trace_board.h"
#include "tests/support/made_trace.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/vcd_file.h"

namespace stereotlm::trace {
namespace {

using test::VcdFile;

class VcdSinkTest : public ::testing::Test {
 protected:
  VcdFile written(const test::MadeTrace& trace, const TimeSpan& window = {}) {
    const auto sink = vcd_sink(path_, board_);
    trace.send(*sink);
    test::finish(*sink, window);
    return VcdFile(test::read_file(path_));
  }
  std::uint64_t ps(std::uint64_t cycle) const { return Clock(board_.fpga.clock_mhz).edge_ps(cycle); }
  std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(scratch_.path()), {});
  }

  test::ScratchFolder scratch_;
  std::filesystem::path path_ = scratch_.path() / "file.vcd";
  std::filesystem::path layout_ = scratch_.path() / "file.gtkw";
  platform::BoardConfig board_ = test::made_board();
};

std::string with_underscores(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

// The state of a port, as its signal shows it.
std::string state_of(const fpga::PortCycle& port, std::size_t requester) {
  switch (port.intent) {
    case fpga::Intent::kRequest:
      return !port.granted ? "waits" : test::kRequesters.writes(requester) ? "writes" : "reads";
    case fpga::Intent::kPass:
      return "passes";
    case fpga::Intent::kIdle:
      return "idle";
    case fpga::Intent::kBlocked:
      return "blocked";
    case fpga::Intent::kStarved:
      return "starved";
  }
  return "";
}

TEST_F(VcdSinkTest, ShowsEachPortInEachCycle) {
  board_.fpga.clock_mhz = 66.6;  // its cycles are no whole ps
  const test::MadeTrace trace = test::make_trace(board_, 2);
  const VcdFile file = written(trace);
  struct Held {
    std::string bank = "-";
    std::string address = "x";
  };
  std::array<Held, fpga::kGroupCount> held;  // by the last request of each port
  for (const fpga::CoreCycle& cycle : trace.cycles) {
    const std::uint64_t time = ps(cycle.cycle);
    for (std::size_t port = 0; port < fpga::kGroupCount; ++port) {
      const fpga::PortCycle& now = cycle.ports[port];
      const std::string name = fpga::kPortGroups[port].name;
      const bool requests = now.intent == fpga::Intent::kRequest;
      if (requests) held[port] = {board_.banks[now.bank].name, std::to_string(now.address)};
      ASSERT_EQ(file.at(name + ".state", time),
                state_of(now, test::kRequesters.of_port(port, cycle.host_traffic)));
      ASSERT_EQ(file.at(name + ".bank", time), held[port].bank);
      ASSERT_EQ(file.at(name + ".waits_for", time),
                requests && !now.granted ? with_underscores(test::kRequesters.name(now.by)) : "-");
      const std::string address = file.at(name + ".address", time);
      ASSERT_EQ(address == "x" ? address : std::to_string(file.number(name + ".address", time)),
                held[port].address);
    }
    ASSERT_EQ(file.at("host.traffic", time),
              cycle.ports[fpga::kHostGroup].intent == fpga::Intent::kRequest ? "capture" : "-");
  }
}

TEST_F(VcdSinkTest, ShowsEachBankAndQueueInEachCycle) {
  const test::MadeTrace trace = test::make_trace(board_, 1);
  const VcdFile file = written(trace);
  for (const fpga::CoreCycle& cycle : trace.cycles) {
    const std::uint64_t time = ps(cycle.cycle);
    for (std::size_t bank = 0; bank < 2; ++bank) {
      std::uint64_t requests = 0;
      std::string owner = "-";
      for (std::size_t port = 0; port < fpga::kGroupCount; ++port) {
        const fpga::PortCycle& now = cycle.ports[port];
        if (now.intent != fpga::Intent::kRequest || now.bank != bank) continue;
        ++requests;
        if (now.granted)
          owner =
              with_underscores(test::kRequesters.name(test::kRequesters.of_port(port, cycle.host_traffic)));
      }
      ASSERT_EQ(file.number(board_.banks[bank].name + ".requests", time), requests);
      ASSERT_EQ(file.at(board_.banks[bank].name + ".owner", time), owner);
    }
    ASSERT_EQ(file.number("left_lane.slots", time), cycle.lane_slots[0]);
    ASSERT_EQ(file.number("right_lane.slots", time), cycle.lane_slots[1]);
    ASSERT_EQ(file.number("results.words", time), cycle.result_words);
    ASSERT_EQ(file.at("matcher.works", time), cycle.works ? "1" : "0");
  }
}

TEST_F(VcdSinkTest, IsIdleWhereCyclesAreLeftOutAndBehindTheWindow) {
  test::MadeTrace trace = test::make_trace(board_, 1);
  trace.bursts.clear();
  trace.levels.clear();
  const auto gap = trace.cycles.begin() + 300;
  const std::uint64_t gap_ps = ps(gap->cycle);
  trace.cycles.erase(gap, gap + 20);
  trace.cycles.resize(400);
  const VcdFile file = written(trace);
  const std::uint64_t end_ps = ps(trace.cycles.back().cycle + 1);
  EXPECT_EQ(file.times().back(), end_ps);
  for (const std::uint64_t time : {gap_ps, end_ps}) {
    EXPECT_EQ(file.at("left_lut.state", time), "idle");
    EXPECT_EQ(file.at("bank0.owner", time), "-");
    EXPECT_EQ(file.number("left_lane.slots", time), 0);
  }
  EXPECT_NE(file.number("left_lane.slots", gap_ps - 1), 0);
}

TEST_F(VcdSinkTest, ShowsThePhasesOfBurstsAndTheLevelsOfQueues) {
  const test::MadeTrace trace = test::make_trace(board_, 1);
  const VcdFile file = written(trace);
  for (const platform::BusBurst& burst : trace.bursts) {
    const std::string bus = burst.bus == platform::BusBurst::Bus::kPci ? "pci" : "local_bus";
    EXPECT_EQ(file.at(bus + ".phase", burst.address_ps), "address");
    EXPECT_EQ(file.at(bus + ".phase", burst.data_ps), "data");
    EXPECT_EQ(file.at(bus + ".phase", burst.end_ps), "idle");
    EXPECT_EQ(file.at(bus + ".owner", burst.end_ps - 1), burst.master);
    EXPECT_EQ(file.at(bus + ".target", burst.end_ps - 1), burst.target);
    EXPECT_EQ(file.at(bus + ".direction", burst.end_ps - 1), burst.write ? "writes" : "reads");
    EXPECT_EQ(file.number(bus + ".address", burst.end_ps - 1), bus == "pci" ? burst.address : 0x100);
    EXPECT_EQ(file.at(bus + ".owner", burst.end_ps), "-");
  }
  EXPECT_EQ(file.number("left_capture.fifo", trace.levels[0].time_ps), 32);
  EXPECT_EQ(file.number("left_capture.fifo", trace.levels[1].time_ps), 0);
  EXPECT_EQ(file.number("posted.words", trace.levels[3].time_ps), 16);
  EXPECT_EQ(test::message_of([&] {
              vcd_sink(path_, board_)->level({"left", 0, 1});
            }),
            "queue = left: has no signal");
}

TEST_F(VcdSinkTest, ABurstThatBeginsAsAnotherEndsLeavesNoIdlePhaseBetween) {
  using Bus = platform::BusBurst::Bus;
  test::MadeTrace trace;
  trace.bursts = {{Bus::kPci, "bridge", "host_memory", false, 0, 1, 0, 10, 20, 30},
                  {Bus::kPci, "bridge", "host_memory", false, 4, 1, 0, 30, 40, 50}};
  const VcdFile file = written(trace);
  EXPECT_EQ(file.at("pci.phase", 30), "address");
  EXPECT_EQ(file.changes("pci.owner").size(), 3);  // with the value at the beginning
}

TEST_F(VcdSinkTest, ABankWithSeparatePortsHasTwoOwners) {
  board_.banks[0].kind = memory::BankKind::kQdr;
  fpga::CoreCycle cycle = test::idle_cycle();
  cycle.cycle = 7;
  cycle.ports[0] = {fpga::Intent::kRequest, true, 0, 4, 0, 0};
  cycle.ports[fpga::kResultGroup] = {fpga::Intent::kRequest, true, 0, 8, 0, 0};
  cycle.ports[2] = {
      fpga::Intent::kRequest, false, 1, 4, test::kRequesters.of_port(memory::kTurnaround, {}), 0};
  test::MadeTrace trace;
  trace.cycles = {cycle};
  const VcdFile file = written(trace);
  EXPECT_EQ(file.at("bank0.read_owner", ps(7)), "left_lut");
  EXPECT_EQ(file.at("bank0.write_owner", ps(7)), "result");
  EXPECT_EQ(file.number("bank0.requests", ps(7)), 2);
  EXPECT_EQ(file.at("bank1.owner", ps(7)), "turnaround");
  EXPECT_EQ(file.at("left_pixel.waits_for", ps(7)), "turnaround");
}

TEST_F(VcdSinkTest, SignalsOfABankAndOfAPartOfItsNameDiffer) {
  const std::vector<std::string> names = {"pci", "bank_pci", "matcher", "left_lut", "left-lane", "Local_Bus"};
  board_.banks.resize(names.size());
  for (std::size_t bank = 0; bank < names.size(); ++bank) board_.banks[bank].name = names[bank];
  board_.allocation = {{"pci"}, {"pci"}, {"bank_pci"}, "pci", "pci"};
  const VcdFile file = written({});
  for (const std::string& name : names) EXPECT_EQ(file.signals().count("bank_" + name + ".owner"), 1) << name;
  EXPECT_EQ(file.signals().count("pci.owner"), 1);
}

TEST_F(VcdSinkTest, AnAbsentPortHasNoSignals) {
  board_.allocation.left_lut.reset();
  const VcdFile file = written({});
  EXPECT_EQ(file.signals().count("left_lut.state"), 0);
  EXPECT_EQ(file.signals().count("right_lut.state"), 1);
  EXPECT_EQ(file.at("right_lut.state", 0), "idle");
}

TEST_F(VcdSinkTest, SixtyFourBanksHaveSignalsOfTheirOwn) {
  while (board_.banks.size() < 64) board_.banks.push_back({"bank" + std::to_string(board_.banks.size())});
  fpga::CoreCycle cycle = test::idle_cycle();
  cycle.ports[0] = {fpga::Intent::kRequest, true, 63, 4, 0, 0};
  test::MadeTrace trace;
  trace.cycles = {cycle};
  const VcdFile file = written(trace);
  for (const platform::BankConfig& bank : board_.banks)
    EXPECT_EQ(file.at(bank.name + ".owner", 0), bank.name == "bank63" ? "left_lut" : "-");
}

TEST_F(VcdSinkTest, TheLayoutNamesTheFileAndEachSignalOfWhatDoesSomething) {
  const VcdFile file = written(test::make_trace(board_, 1));
  const std::string layout = test::read_file(layout_);
  EXPECT_THAT(layout, ::testing::StartsWith("[*] stereotlm\n[dumpfile] \"file.vcd\"\n"));
  for (const auto& [signal, code] : file.signals()) {
    if (signal == "right_capture.fifo") continue;  // always empty here
    const bool is_number = file.at(signal, UINT64_MAX).find_first_not_of("01z") == std::string::npos;
    const std::string end = is_number && signal != "matcher.works" ? "[" : "\n";
    EXPECT_THAT(layout, ::testing::HasSubstr("} " + signal + end));
  }
}

TEST_F(VcdSinkTest, TheLayoutLeavesOutWhatDoesNothingInTheWindow) {
  fpga::CoreCycle cycle = test::idle_cycle();
  cycle.ports[0] = {fpga::Intent::kRequest, true, 1, 4, 0, 0};
  test::MadeTrace trace;
  trace.cycles = {cycle};
  written(trace);
  const std::string layout = test::read_file(layout_);
  for (const char* scope : {"bank1", "left_lut"}) EXPECT_THAT(layout, ::testing::HasSubstr(scope));
  for (const char* scope : {"bank0", "right_lut", "pci", "left_capture"})
    EXPECT_THAT(layout, ::testing::Not(::testing::HasSubstr(scope)));
}

TEST_F(VcdSinkTest, LeavesALayoutThatGtkwaveHasSaved) {
  test::write_file(layout_, "[*]\n[*] GTKWave Analyzer v3.3.118\n");
  written(test::make_trace(board_, 1));
  EXPECT_EQ(test::read_file(layout_), "[*]\n[*] GTKWave Analyzer v3.3.118\n");
}

// Nothing happens in the first and the last two cycles of the window. The layout has a marker where the
// longest wait begins.
TEST_F(VcdSinkTest, BeginsAndEndsWithTheWindow) {
  using Bus = platform::BusBurst::Bus;
  for (const char* name : {"file.vcd", "file.fst"}) {
    path_ = scratch_.path() / name;
    const bool is_vcd = path_.extension() == ".vcd";
    fpga::CoreCycle cycle = test::idle_cycle();
    cycle.cycle = 4;
    cycle.ports[0] = {fpga::Intent::kRequest, true, 0, 4, 0, 0};
    test::MadeTrace trace;
    trace.cycles = {cycle};
    trace.bursts = {{Bus::kPci, "bridge", "host_memory", false, 0, 1, 0, 10, 20, ps(6)},
                    {Bus::kPci, "bridge", "host_memory", false, 0, 1, 0, ps(8) + 1, ps(9), ps(10)}};
    const auto sink = vcd_sink(path_, board_);
    trace.send(*sink);
    test::finish(*sink, {ps(2), ps(8), is_vcd ? std::optional(ps(5)) : std::nullopt});
    EXPECT_THAT(test::read_file(layout_),
                ::testing::ContainsRegex(is_vcd ? "\n\\*-[0-9.]+ 125000 -1 -1" : "\n\\*-[0-9.]+ -1 -1 -1"));
    const VcdFile file(is_vcd ? test::read_file(path_)
                              : process::run_command({"fst2vcd", "-e", path_.string()}).out);
    EXPECT_EQ(file.times(), (std::vector<std::uint64_t>{ps(2), ps(4), ps(5), ps(6), ps(8)})) << name;
    EXPECT_EQ(file.at("pci.phase", ps(2)), "data");  // has begun before
    EXPECT_EQ(file.at("left_lut.state", ps(2)), "idle");
    EXPECT_EQ(file.at("left_lut.state", ps(4)), "reads");
    EXPECT_EQ(file.at("pci.phase", ps(8)), "idle");
  }
}

TEST_F(VcdSinkTest, HasTheChangesAtTheEndOfTheWindow) {
  const test::MadeTrace trace = test::make_trace(board_, 1);
  const VcdFile whole = written(trace);
  const std::string signal = "left_lut.state";
  const auto change = std::next(whole.changes(signal).begin(), 20);
  path_ = scratch_.path() / "window.vcd";
  const VcdFile window = written(trace, {ps(1), change->first, std::nullopt});
  EXPECT_EQ(window.times().back(), change->first);
  for (const auto& [name, code] : whole.signals())
    EXPECT_EQ(window.at(name, change->first), whole.at(name, change->first)) << name;
}

TEST_F(VcdSinkTest, RefusesFstWithoutItsProgram) {
  const std::string before = std::getenv("PATH");
  setenv("PATH", scratch_.path().c_str(), 1);
  EXPECT_THAT(test::message_of([&] { vcd_sink(scratch_.path() / "file.fst", board_); }),
              ::testing::HasSubstr("file.fst: FST is written by the program vcd2fst, which is not installed: "
                                   "install the package gtkwave"));
  setenv("PATH", before.c_str(), 1);
  EXPECT_EQ(files(), 0);
}

}  // namespace
}  // namespace stereotlm::trace
