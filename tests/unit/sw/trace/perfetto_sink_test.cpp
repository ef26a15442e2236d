#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "models/clock.h"
#include "sw/trace/trace_board.h"
#include "tests/support/made_trace.h"
#include "tests/support/perfetto_file.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::trace {
namespace {

using test::PerfettoFile;

class PerfettoSinkTest : public ::testing::Test {
 protected:
  PerfettoFile written(const test::MadeTrace& trace) {
    const auto sink = perfetto_sink(path_, board_);
    trace.send(*sink);
    test::finish(*sink);
    return test::PerfettoFile(bytes_ = test::read_file(path_));
  }
  // Sum of the argument `cycles` of the slices whose names contain `part`.
  static std::uint64_t cycles_of(const std::vector<PerfettoFile::Slice>& slices, const std::string& part) {
    std::uint64_t sum = 0;
    for (const PerfettoFile::Slice& slice : slices) {
      if (slice.name.find(part) != std::string::npos) sum += slice.arguments.at("cycles");
    }
    return sum;
  }
  std::uint64_t ns(std::uint64_t cycle) const { return Clock(board_.fpga.clock_mhz).edge_ps(cycle) / 1000; }

  test::ScratchFolder scratch_;
  std::filesystem::path path_ = scratch_.path() / "file.perfetto-trace";
  platform::BoardConfig board_ = test::made_board();
  std::string bytes_;
};

TEST_F(PerfettoSinkTest, SlicesOfATrackNeverCross) {
  board_.fpga.clock_mhz = 333.3;  // its cycles are no whole ns
  const PerfettoFile file = written(test::make_trace(board_, 1));
  for (const auto& [uuid, track] : file.tracks) {
    std::uint64_t free_ns = 0;
    for (const PerfettoFile::Slice& slice : file.slices) {
      if (slice.track != uuid || slice.depth > 0) continue;
      EXPECT_GE(slice.begin_ns, free_ns) << track;
      EXPECT_GE(slice.end_ns, slice.begin_ns) << track;
      free_ns = slice.end_ns;
    }
  }
  for (const PerfettoFile::Slice& slice : file.slices_of("left_lut cycles")) {
    if (slice.arguments.count("slot") != 0) {
      EXPECT_THAT(slice.end_ns - slice.begin_ns, ::testing::AnyOf(3, 4));
    }
  }
}

// Returns the number of waits. Each has an arrow from the accesses of its winner at its bank.
std::size_t expect_arrows_to_waits(const PerfettoFile& file) {
  std::size_t waits = 0;
  for (const PerfettoFile::Slice& wait : file.slices) {
    static const std::regex kWait("(.*) waits (1 cycle|[0-9]+ cycles) for (.*) on (.*)");
    std::smatch parts;
    if (!std::regex_match(wait.name, parts, kWait)) continue;
    ++waits;
    EXPECT_NE(parts[2], "1 cycles");
    const bool is_cycles = file.tracks.at(wait.track).find(" cycles") != std::string::npos;
    EXPECT_EQ(wait.flows.size(), 1);
    std::size_t found = 0;
    for (const PerfettoFile::Slice& slice : file.slices_of(parts[3].str() + (is_cycles ? " cycles" : ""))) {
      if (std::count(slice.flows.begin(), slice.flows.end(), wait.flows.at(0)) == 0) continue;
      ++found;
      EXPECT_NE(slice.name.find(parts[4]), std::string::npos) << wait.name << ": " << slice.name;
      EXPECT_LE(slice.begin_ns, wait.begin_ns);
      if (is_cycles) {
        EXPECT_EQ(slice.begin_ns, wait.begin_ns);
      }
    }
    EXPECT_EQ(found, 1) << wait.name;
  }
  return waits;
}

TEST_F(PerfettoSinkTest, AnArrowLeadsFromTheAccessesAtTheBankOfTheWaitAlone) {
  const std::size_t host = test::kRequesters.host(fpga::HostTraffic::kCapture);
  platform::FrameRuns frame;
  frame.strip_ends = {100};
  frame.runs = {{0, 0, 100, 0, 0, std::nullopt, 4},    {0, 0, 100, 0, 0, host, 1},
                {0, 0, 100, 1, 1, std::nullopt, 4},    {0, 0, 100, 1, 1, host, 3},
                {0, 0, 100, host, 0, std::nullopt, 1}, {0, 0, 100, host, 1, std::nullopt, 3}};
  test::MadeTrace trace;
  trace.frames = {frame};
  EXPECT_EQ(expect_arrows_to_waits(written(trace)), 2);
  EXPECT_GT(expect_arrows_to_waits(written(test::make_trace(board_, 1))), 20);
}

bool is_wait(const PerfettoFile::Slice& slice) { return slice.name.find(" waits ") != std::string::npos; }

using SlicesByFlow = std::map<std::uint64_t, std::vector<const PerfettoFile::Slice*>>;

SlicesByFlow by_flow(const PerfettoFile& file) {
  SlicesByFlow found;
  for (const PerfettoFile::Slice& slice : file.slices) {
    for (const std::uint64_t flow : slice.flows) found[flow].push_back(&slice);
  }
  return found;
}

TEST_F(PerfettoSinkTest, ArrowsLeadFromATableEntryToItsPixelAndFromThereToItsResult) {
  const PerfettoFile file = written(test::make_trace(board_, 1));
  std::size_t to_pixels = 0;
  std::size_t to_results = 0;
  for (const auto& [flow, slices] : by_flow(file)) {
    if (slices.size() < 2 || is_wait(*slices[1])) continue;
    const std::string to = file.tracks.at(slices[1]->track);
    if (to == "left_pixel cycles") {
      ++to_pixels;
      EXPECT_EQ(file.tracks.at(slices[0]->track), "left_lut cycles");
      EXPECT_EQ(slices[1]->arguments.at("slot"), slices[0]->arguments.at("slot"));
    } else if (to == "result cycles") {
      ++to_results;
      EXPECT_EQ(slices.size(), 2);
      EXPECT_EQ(file.tracks.at(slices[0]->track), "left_pixel cycles");
      EXPECT_EQ(slices[1]->arguments.at("row"), slices[0]->arguments.at("row"));
      EXPECT_EQ(slices[1]->arguments.at("column"), slices[0]->arguments.at("column") / 4 * 4);
    }
  }
  EXPECT_GE(to_pixels, 16 * 6);
  EXPECT_EQ(to_results, 16 * 6);
}

// Its word is held, or its entry is not valid. Every fourth pixel is read here.
TEST_F(PerfettoSinkTest, NoArrowLeadsOverAPixelThatIsPassed) {
  test::MadeTrace trace = test::make_trace(board_, 1);
  for (fpga::CoreCycle& cycle : trace.cycles) {
    for (const fpga::Side side : fpga::kSides) {
      fpga::PortCycle& pixel = cycle.ports[fpga::pixel_group(side)];
      if (pixel.granted && pixel.item % 4 != 0) pixel = {fpga::Intent::kPass, false, 0, 0, 0, pixel.item};
    }
  }
  const PerfettoFile file = written(trace);
  std::size_t arrows = 0;
  for (const auto& [flow, slices] : by_flow(file)) {
    if (slices.size() < 2 || is_wait(*slices[0]) || is_wait(*slices[1])) continue;
    ++arrows;
    EXPECT_EQ(slices[0]->arguments.at("slot") % 4, 0);
    const bool from_entry = file.tracks.at(slices[0]->track).find("_lut") != std::string::npos;
    EXPECT_EQ(from_entry, file.tracks.at(slices[1]->track).find("_pixel") != std::string::npos);
  }
  EXPECT_GT(arrows, 16 * 6 / 4);
}

// The second columns of the guide's tables of tracks.
std::set<std::string> names_of_guide() {
  const std::string guide = test::read_file(STEREOTLM_TRACE_GUIDE);
  const std::size_t begin = guide.find("## Perfetto");
  const std::string part = guide.substr(begin, guide.find("## Waveforms") - begin);
  static const std::regex kRow("\n\\|[^|\n]*\\|([^|\n]*)\\|");
  static const std::regex kName("`([^`]*)`");
  std::set<std::string> names;
  for (std::sregex_iterator row(part.begin(), part.end(), kRow), end; row != end; ++row) {
    const std::string cell = (*row)[1];
    for (std::sregex_iterator name(cell.begin(), cell.end(), kName); name != end; ++name)
      names.insert((*name)[1]);
  }
  return names;
}

// The guide names the first port, bank, interrupt and wait for all.
TEST_F(PerfettoSinkTest, TheGuideHasTheNameOfEachTrack) {
  using platform::EventKind;
  board_.banks[1].kind = memory::BankKind::kQdr;
  test::MadeTrace trace = test::make_trace(board_, 1);
  for (const EventKind kind : {EventKind::kUpload, EventKind::kFrame, EventKind::kInterrupt}) {
    trace.events.push_back(trace.events[0]);
    trace.events.back().kind = kind;
  }
  const std::set<std::string> guide = names_of_guide();
  const PerfettoFile file = written(trace);
  for (auto [uuid, name] : file.tracks) {
    for (const auto& [all, first] :
         {std::pair("^(right_lut|(left|right)_pixel|result|host capture)( cycles| waits.*)?$", "left_lut$3"),
          std::pair("^bank1", "bank0"), std::pair("^interrupt .*", "interrupt left"),
          std::pair("^wait .*", "wait pair")})
      name = std::regex_replace(name, std::regex(all), first);
    const bool is_group = file.parents.count(uuid) == 0 || file.parents.count(file.parents.at(uuid)) == 0;
    EXPECT_TRUE(is_group || guide.count(name) == 1) << name;
  }
}

TEST_F(PerfettoSinkTest, CountersHaveUseAndWaitsOfEachRowAndEndAtZero) {
  const test::MadeTrace trace = test::make_trace(board_, 1);
  const PerfettoFile file = written(trace);
  const auto waits = file.counts_of("left_lut waits in each row");
  const auto use = file.counts_of("bank0 use");
  ASSERT_FALSE(waits.empty() || use.empty());
  const platform::FrameRuns& frame = trace.frames[0];
  for (std::size_t strip = 0; strip < frame.strip_ends.size(); ++strip) {
    double sum = 0;
    double accesses = 0;
    std::uint64_t first = 0;
    for (const platform::TraceRun& run : frame.runs) {
      if (run.strip != strip) continue;
      first = run.first_cycle;
      if (run.by && run.requester == 0) sum += static_cast<double>(run.count);
      if (!run.by && run.bank == 0) accesses += static_cast<double>(run.count);
    }
    const auto value_at = [&](const auto& counts) {
      double value = 0;
      for (const auto& [time, count] : counts) {
        if (time <= ns(first)) value = count;
      }
      return value;
    };
    EXPECT_EQ(value_at(waits), sum);
    EXPECT_DOUBLE_EQ(value_at(use), 100 * accesses / static_cast<double>(frame.strip_ends[strip] - first));
  }
  EXPECT_EQ(waits.back(), std::pair(ns(frame.end_cycle), 0.0));
  EXPECT_EQ(use.back(), std::pair(ns(frame.end_cycle), 0.0));
}

TEST_F(PerfettoSinkTest, TheLastStripHasTheNameOfItsRows) {
  board_.matcher.rows = 4;  // of 6
  platform::FrameRuns frame;
  frame.strip_ends = {100, 200, 300};
  for (std::uint64_t strip = 0; strip < 3; ++strip)
    frame.runs.push_back({strip, 100 * strip, 100 * (strip + 1), 0, 0, std::nullopt, 4});
  test::MadeTrace trace;
  trace.frames = {frame};
  std::set<std::string> names;
  for (const PerfettoFile::Slice& slice : written(trace).slices) names.insert(slice.name);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"fill", "rows 0..3", "rows 4..5"}));
}

TEST_F(PerfettoSinkTest, ABurstHasItsPhasesAndItsWait) {
  const PerfettoFile file = written(test::make_trace(board_, 1));
  const auto bursts = file.slices_of("pci");
  ASSERT_EQ(bursts.size(), 6);
  const std::uint64_t first = ns(100);
  EXPECT_EQ(bursts[0].name, "left_capture writes bridge");
  EXPECT_EQ(bursts[0].begin_ns, first + 30);
  EXPECT_EQ(bursts[0].end_ns, first + 900);
  EXPECT_EQ(bursts[0].arguments.at("words"), 32);
  EXPECT_EQ(bursts[1].name, "address");
  EXPECT_EQ(bursts[1].depth, 1);
  EXPECT_EQ(bursts[2].name, "data");
  EXPECT_EQ(bursts[2].begin_ns, first + 60);
  const auto waits = file.slices_of("pci waits");
  ASSERT_EQ(waits.size(), 2);
  EXPECT_EQ(waits[1].name, "bridge waits");
  EXPECT_EQ(waits[1].end_ns - waits[1].begin_ns, 430);
  EXPECT_EQ(file.counts_of("posted").size(), 2);
}

TEST_F(PerfettoSinkTest, EventsThatOverlapHaveTracksOfOneName) {
  const PerfettoFile file = written(test::make_trace(board_, 1));
  const auto waits = file.slices_of("wait pair");
  ASSERT_EQ(waits.size(), 2);
  EXPECT_NE(waits[0].track, waits[1].track);
  EXPECT_EQ(file.parents.at(waits[0].track), file.parents.at(waits[1].track));
  EXPECT_EQ(waits[0].name, "pair waits: core");
  const auto capture = file.slices_of("left");
  ASSERT_EQ(capture.size(), 1);
  EXPECT_EQ(capture[0].end_ns, 1500);  // rounded down from 1500.5 ns
  EXPECT_EQ(capture[0].arguments.at("dropped pixels"), 3);
  const auto drop = file.slices_of("right");
  ASSERT_EQ(drop.size(), 1);
  EXPECT_TRUE(drop[0].is_instant);
  EXPECT_EQ(drop[0].name, "drop: not_armed");
}

TEST_F(PerfettoSinkTest, QueuesAndPortsAreEmptyWhereCyclesAreLeftOut) {
  test::MadeTrace trace = test::make_trace(board_, 1);
  const auto gap = trace.cycles.begin() + 300;
  const std::uint64_t begin = gap->cycle;
  trace.cycles.erase(gap, gap + 20);
  trace.cycles.resize(400);
  const PerfettoFile file = written(trace);
  EXPECT_THAT(file.counts_of("left lane"), ::testing::Contains(std::pair(ns(begin), 0.0)));
  EXPECT_EQ(file.counts_of("left lane").back(), std::pair(ns(trace.cycles.back().cycle + 1), 0.0));
  for (const PerfettoFile::Slice& slice : file.slices) {
    if (file.tracks.at(slice.track).find(" cycles") != std::string::npos) {
      EXPECT_FALSE(slice.begin_ns < ns(begin + 20) && slice.end_ns > ns(begin)) << slice.name;
    }
  }
}

TEST_F(PerfettoSinkTest, TheTableOfNamesIsBegunAnewWhenItIsFull) {
  board_ = {};
  platform::FrameRuns frame;
  for (std::uint64_t strip = 0; strip < 5000; ++strip) {
    frame.strip_ends.push_back((strip + 1) * 10'000);
    frame.runs.push_back({strip, strip * 10'000, (strip + 1) * 10'000, 0, 0, std::nullopt, strip + 1});
  }
  test::MadeTrace trace;
  trace.frames = {frame};
  const auto slices = written(trace).slices_of("left_lut");
  ASSERT_EQ(slices.size(), 5000);
  EXPECT_EQ(slices.back().name, "reads bank0 x5000");
  EXPECT_EQ(slices.back().begin_ns, ns(4999 * 10'000));
}

}  // namespace
}  // namespace stereotlm::trace
