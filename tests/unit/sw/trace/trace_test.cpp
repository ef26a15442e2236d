// The part of a run that its traces show.
#include "sw/trace/trace.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "models/clock.h"
#include "sw/sqlite/database.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/made_trace.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/vcd_file.h"

namespace stereotlm::trace {
namespace {

// Ports that wait in cycles `first` to `last`.
struct Wait {
  std::size_t port;
  std::uint64_t first;
  std::uint64_t last;
};

fpga::CoreCycle cycle_of(std::uint64_t number, const std::vector<Wait>& waits) {
  fpga::CoreCycle cycle = test::idle_cycle();
  cycle.cycle = number;
  for (const Wait& wait : waits) {
    if (wait.first <= number && number <= wait.last)
      cycle.ports[wait.port] = {fpga::Intent::kRequest, false, 0, 4, 1, 0};
  }
  return cycle;
}

// The longest wait of cycles 1000 to 1299, and the cycles kept around it, as "first+cycles: from..to".
std::string longest(const std::vector<Wait>& waits, std::uint64_t left_out = 0) {
  LongestWait found;
  for (std::uint64_t cycle = 1000; cycle < 1300; ++cycle) {
    if (cycle != left_out) found.add(cycle_of(cycle, waits));
  }
  if (found.cycles() == 0) return "none";
  std::string text = fmt::format("{}+{}:", found.first_cycle(), found.cycles());
  std::uint64_t next = 0;
  const auto kept = found.take_kept();
  for (const fpga::CoreCycle& cycle : kept) {
    if (cycle.cycle != next) text += fmt::format(" {}..", cycle.cycle);
    next = cycle.cycle + 1;
  }
  return text + fmt::format("{}", next - 1);
}

TEST(LongestWait, HasSixtyCyclesAroundIt) {
  EXPECT_EQ(longest({{0, 1050, 1052}, {1, 1100, 1104}, {2, 1200, 1204}}), "1100+5: 1070..1134")
      << "the first of equal ones";
  EXPECT_EQ(longest({{0, 1029, 1031}, {1, 1030, 1032}, {2, 1200, 1202}}), "1030+3: 1000..1062")
      << "that has 30 cycles before it";
  EXPECT_EQ(longest({{0, 1100, 1109}, {1, 1104, 1114}}), "1104+11: 1074..1144");
  EXPECT_EQ(longest({{0, 1100, 1250}}), "1100+151: 1070..1280") << "all of it is shown";
  EXPECT_EQ(longest({}), "none");
}

TEST(LongestWait, HasTheCyclesOfTheWindowAlone) {
  EXPECT_EQ(longest({{0, 1010, 1011}}), "1010+2: 1000..1061") << "more behind it, so that there are 60";
  EXPECT_EQ(longest({{0, 1280, 1289}}), "1280+10: 1250..1299");
  EXPECT_EQ(longest({{0, 1290, 1400}}), "1290+10: 1260..1299") << "it is under way at the end";
}

TEST(LongestWait, EndsWhereCyclesAreLeftOut) {
  EXPECT_EQ(longest({{0, 1100, 1110}}, 1104), "1105+6: 1075.. 1105..1140");
}

class TraceWindowTest : public ::testing::Test {
 protected:
  std::unique_ptr<Trace> writer(const TraceWindow& window) const {
    const auto format = [](const std::string& name) {
      return std::find_if(std::begin(kTraceFormats), std::end(kTraceFormats),
                          [&](const TraceFormat& each) { return each.name == name; });
    };
    const std::vector<TraceFile> files = {{format("sqlite"), database_}, {format("vcd"), waveform_}};
    return std::make_unique<Trace>(files, board_, window);
  }
  static void finish(Trace& trace) {
    trace.complete();
    trace.commit();
  }
  std::string column(const std::string& sql) const {
    const sqlite::Database database(database_, sqlite::Database::Access::kRead);
    sqlite::Statement rows(database, sql);
    std::string text;
    while (rows.step()) text += rows.text(0) + ' ';
    return text;
  }
  std::uint64_t ps(std::uint64_t cycle) const { return Clock(board_.fpga.clock_mhz).edge_ps(cycle); }

  test::ScratchFolder scratch_;
  platform::BoardConfig board_ = test::made_board();
  std::string database_ = scratch_.path() / "file.db";
  std::string waveform_ = scratch_.path() / "file.vcd";
};

// BusTrace reports the whole frame, of which cycles 100 to 119 are in the window.
TEST_F(TraceWindowTest, InAFrameHasTheBurstsAndLevelsOfItsCyclesAlone) {
  TraceWindow window;
  window.cycles.frame = 0;
  const auto writer = this->writer(window);
  const auto burst = [&writer](std::uint64_t request_ps, std::uint64_t end_ps) {
    writer->burst({platform::BusBurst::Bus::kPci, "host", "host_memory", true, 0, 1, request_ps, request_ps,
                   request_ps, end_ps});
  };
  burst(1, ps(100));
  burst(2, ps(100) + 1);
  burst(ps(120) - 1, ps(200));
  burst(ps(120), ps(200));
  for (const std::uint64_t time_ps : {ps(100), ps(100) + 1, ps(120), ps(120) + 1})
    writer->level({"posted", time_ps, 1});
  for (std::uint64_t cycle = 100; cycle < 120; ++cycle) writer->cycle(cycle_of(cycle, {}));
  finish(*writer);
  EXPECT_EQ(column("SELECT request_ps FROM bursts"), fmt::format("2 {} ", ps(120) - 1));
  EXPECT_EQ(column("SELECT time_ps FROM levels"), fmt::format("{} {} ", ps(100) + 1, ps(120)));
  const test::VcdFile file(test::read_file(waveform_));
  EXPECT_EQ(file.times().front(), ps(100));
  EXPECT_EQ(file.times().back(), ps(120));
}

// A wait of 3 cycles, in two kinds of windows.
TEST_F(TraceWindowTest, AroundTheLongestWaitHasTheSameCyclesInEachFormat) {
  for (const bool is_of_frame : {true, false}) {
    TraceWindow window;
    window.around_longest_wait = true;
    if (is_of_frame) window.cycles.frame = 0;
    const auto writer = this->writer(window);
    for (std::uint64_t cycle = 1000; cycle < 1300; ++cycle) {
      fpga::CoreCycle now = cycle_of(cycle, {{0, 1100, 1102}});
      now.ports[1] = {fpga::Intent::kRequest, true, 1, 4, 0, 0};
      writer->cycle(now);
    }
    writer->level({"posted", ps(1069), 1});
    writer->level({"posted", ps(1133), 2});
    finish(*writer);
    EXPECT_EQ(column("SELECT min(cycle) || '..' || max(cycle) FROM transactions"), "1070..1132 ");
    EXPECT_EQ(column("SELECT words FROM levels"), "2 ");
    const test::VcdFile file(test::read_file(waveform_));
    EXPECT_EQ(file.times().front(), ps(1070));
    EXPECT_EQ(file.times().back(), ps(1133));
    const std::string layout = test::read_file(scratch_.path() / "file.gtkw");
    EXPECT_NE(layout.find(fmt::format(" {} -1 -1", ps(1100))), std::string::npos) << layout;
  }
}

// Each format: what a trace with its second file leaves behind.
class EachFormat : public ::testing::TestWithParam<std::size_t> {
 protected:
  void write(const test::MadeTrace& trace) const {
    const auto sink = format_.make_sink(path_, board_);
    trace.send(*sink);
    test::finish(*sink);
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> texts;
    for (const auto& output : outputs_of({&format_, path_})) texts.push_back(test::read_file(output));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch_.path()), {}), texts.size());
    return texts;
  }

  const TraceFormat& format_ = kTraceFormats[GetParam()];
  test::ScratchFolder scratch_;
  std::string path_ = scratch_.path() / "file";
  platform::BoardConfig board_ = test::made_board();
};

TEST_P(EachFormat, LeavesTheEarlierFilesWithoutACommitOrWhenTheDiskIsFull) {
  const test::MadeTrace trace = test::make_trace(board_, 1);
  write({});
  const std::vector<std::string> earlier = texts();
  trace.send(*format_.make_sink(path_, board_));
  EXPECT_EQ(texts(), earlier);
  EXPECT_NE(test::message_of([&] {
              const auto sink = format_.make_sink(path_, board_);
              trace.send(*sink);
              const test::FileSizeLimit limit(100);
              test::finish(*sink);
            }).find(path_),
            std::string::npos);
  EXPECT_EQ(texts(), earlier);
  write(trace);
  EXPECT_NE(texts(), earlier);
}

INSTANTIATE_TEST_SUITE_P(Traces, EachFormat, ::testing::Range<std::size_t>(0, std::size(kTraceFormats)),
                         [](const auto& format) { return std::string(kTraceFormats[format.param].name); });

}  // namespace
}  // namespace stereotlm::trace
