// The recorder, told by hand what the blocks do. random_computers_test.cpp has whole computers.
#include "platform/records/timeline.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "models/pci/bridge_registers.h"
#include "platform/config/board_yaml.h"

namespace stereotlm::platform {
namespace {

namespace bridge_map = pci::bridge;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::uint64_t kCyclePs = 25'000;  // of the core, ps

std::string text_of(const std::optional<std::uint64_t>& number) {
  return number ? fmt::to_string(*number) : "-";
}

// kind, class, frame / camera frame, beginning..end, and what else there is.
std::string line_of(const TimelineEvent& event) {
  std::string line =
      fmt::format("{} {} {}/{} {}..{}", kEventKindNames[static_cast<std::size_t>(event.kind)], event.what,
                  text_of(event.frame), text_of(event.camera_frame), event.begin_ps, event.end_ps);
  if (event.words != 0) line += fmt::format(" words {}", event.words);
  if (event.dropped_pixels != 0) line += fmt::format(" dropped {}", event.dropped_pixels);
  if (*event.why != '\0') line += fmt::format(" {}", event.why);
  return line;
}

class TimelineSteps : public ::testing::Test {
 protected:
  explicit TimelineSteps(const std::vector<std::string>& sets = {"allocation.disparity=bank4"})
      : board(load_board("fpl2003", sets)), timeline(board) {}

  std::vector<std::string> lines(TimelineRecords records) {
    std::vector<std::string> lines;
    for (const TimelineEvent& event : records.events) lines.push_back(line_of(event));
    latencies.insert(latencies.end(), records.latencies.begin(), records.latencies.end());
    return lines;
  }
  std::uint64_t address_of(Buffer buffer) const {
    const std::vector<PlacedBuffer> all = buffers(board);
    std::size_t index = 0;
    while (all[index].buffer != buffer) ++index;
    return all[index].range.first;
  }

  void transfer(unsigned channel, Buffer buffer, std::uint64_t begin_ps, std::uint64_t end_ps,
                std::uint64_t words) {
    timeline.transfer_begun(channel, begin_ps, {buffer == Buffer::kDisparity, 0, address_of(buffer), words});
    timeline.transfer_ended(channel, end_ps);
  }
  void upload_tables() {
    timeline.dma_started(0, 100);
    transfer(0, Buffer::kLeftLut, 100, 1000, 30);
    transfer(0, Buffer::kRightLut, 1000, 2000, 30);
    interrupt(bridge_map::kDmaDone, 2000, 2100);
  }
  void interrupt(std::uint32_t bit, std::uint64_t raised_ps, std::uint64_t cleared_ps) {
    timeline.interrupts_raised(raised_ps, bit);
    timeline.interrupts_cleared(cleared_ps, bridge_map::kAllInterrupts);
  }
  void begin_capture(std::uint64_t frame, std::uint64_t begin_ps) {
    for (const std::size_t side : {0U, 1U}) {
      timeline.capture_board(side).frame_begun(frame, begin_ps);
      timeline.capture_board(side).capture_begun(frame, begin_ps);
    }
  }
  void drop(std::size_t side, std::uint64_t frame, std::uint64_t begin_ps, capture::DropReason reason) {
    timeline.capture_board(side).frame_begun(frame, begin_ps);
    timeline.capture_board(side).frame_dropped(frame, begin_ps, reason);
  }
  void end_capture(std::size_t side, std::uint64_t frame, std::uint64_t begin_ps, std::uint64_t end_ps) {
    timeline.capture_board(side).capture_ended({frame, begin_ps, end_ps, side, 0, 10});
    timeline.capture_board(side).interrupt_cleared(end_ps + 50);
  }
  // The left capture ends 1000 ps before the right one.
  void capture(std::uint64_t frame, std::uint64_t begin_ps, std::uint64_t end_ps) {
    begin_capture(frame, begin_ps);
    end_capture(0, frame, begin_ps, end_ps - 1000);
    end_capture(1, frame, begin_ps, end_ps);
  }
  // The driver starts number `number` of an activity, and has waited for those so many before it.
  struct Before {
    Activity activity;
    std::size_t back;
    const char* reason;
  };
  void start(Activity activity, std::uint64_t number, const std::vector<Before>& conditions) {
    std::vector<Awaited> awaited;
    for (const Before& before : conditions) {
      if (number >= before.back) awaited.push_back({before.activity, number - before.back, before.reason});
    }
    timeline.starts(activity, awaited);
  }
  void begin_frame(std::uint64_t strobe_ps) {
    const Activity of_pair = copies_ > 0 ? Activity::kCopy : Activity::kCapture;
    start(Activity::kFrame, frames_++,
          {{Activity::kFrame, 1, "core"},
           {of_pair, 0, "pair"},
           {Activity::kReadBack, board.allocation.disparity.size(), "output_buffer"}});
    timeline.frame_begun(strobe_ps);
  }
  void begin_copy(std::uint64_t begin_ps) {
    start(Activity::kCopy, copies_++,
          {{Activity::kCopy, 1, "copy"},
           {Activity::kCapture, 0, "pair"},
           {Activity::kFrame, board.allocation.left_image.size(), "input_buffer"}});
    timeline.dma_started(0, begin_ps);
  }
  void begin_read_back(std::uint64_t begin_ps) {
    start(Activity::kReadBack, read_backs_++,
          {{Activity::kReadBack, 1, "read_back"}, {Activity::kFrame, 0, "frame"}});
    timeline.dma_started(1, begin_ps);
  }
  void run_core(std::uint64_t strobe_ps, std::uint64_t first, std::uint64_t end, std::uint64_t done) {
    begin_frame(strobe_ps);
    timeline.frame_ended({strobe_ps, first, end, done, 8});
    interrupt(bridge_map::kDoorbell, done * kCyclePs, done * kCyclePs + 50);
  }
  void read_back(std::uint64_t begin_ps, std::uint64_t end_ps) {
    begin_read_back(begin_ps);
    transfer(1, Buffer::kDisparity, begin_ps, end_ps, 8);
    interrupt(bridge_map::kDmaDone << 1U, end_ps, end_ps + 50);
  }

  BoardConfig board;
  Timeline timeline;
  std::vector<FrameLatency> latencies;
  ComputerCounters counters;

 private:
  std::uint64_t frames_ = 0;
  std::uint64_t copies_ = 0;
  std::uint64_t read_backs_ = 0;
};

// Two frames. The second pair waits for the core, and then for the only output buffer.
class TwoRecordedFrames : public TimelineSteps {
 protected:
  void run() {
    for (const std::size_t side : {0U, 1U}) drop(side, 0, 0, capture::DropReason::kNotArmed);
    upload_tables();
    capture(1, 10'000, 21'000);
    run_core(24'990, 1, 4, 5);
    capture(2, 30'000, 41'000);
    read_back(127'000, 200'000);
    timeline.deliver({10'000, 201'000});
    early = lines(timeline.take());
    run_core(202'025, 9, 10, 11);
    read_back(300'000, 310'000);
    drop(0, 3, 309'999, capture::DropReason::kPartner);
    drop(1, 3, 309'999, capture::DropReason::kBusy);
    timeline.deliver({30'000, 311'000});
    counters.bridge.dma_words = 76;
    for (auto& camera : counters.cameras) camera.capture.words = 20;
    counters.cameras[1].capture.dropped_pixels = 2;
  }
  // The figures of this run.
  Statistics statistics() const {
    Statistics found;
    found.frames = 2;
    found.frame_cycles = {4, 2};
    found.ports.resize(fpga::kGroupCount);
    found.ports[fpga::kResultGroup].grants = 16;
    ComputerStatistics& computer = found.computer.emplace();
    computer.dma_words = 76;
    computer.pci_masters.resize(4);
    computer.pci_masters[1].words = computer.pci_masters[2].words = 20;
    for (const char* name : {"left", "right"}) {
      CameraStatistics& camera = computer.cameras.emplace_back();
      camera.name = name;
      camera.captured_frames = 2;
      camera.dropped_not_armed = 1;
    }
    computer.cameras[0].dropped_by_partner = 1;
    computer.cameras[1].dropped_busy = 1;
    computer.cameras[1].dropped_pixels = 2;
    return found;
  }

  std::vector<std::string> early;  // handed out after the first delivery
};

TEST_F(TwoRecordedFrames, AreHandedOutByTheEndsOfTheirEvents) {
  run();
  timeline.mark_end(counters);
  EXPECT_THAT(early, SizeIs(6)) << "those before the capture of the frame that was delivered";
  std::vector<std::string> all = early;
  for (std::string& line : lines(timeline.take())) all.push_back(std::move(line));
  for (std::string& line : lines(timeline.finish())) all.push_back(std::move(line));
  EXPECT_THAT(
      all,
      ElementsAre("drop left -/0 0..0 not_armed", "drop right -/0 0..0 not_armed",
                  "upload left_lut -/- 100..1000 words 30", "wait core 0/1 0..2000 upload",
                  "upload right_lut -/- 1000..2000 words 30", "interrupt upload -/- 2000..2100",
                  "wait core 0/1 2000..10000 camera", "capture left 0/1 10000..20000 words 10",
                  "interrupt left 0/1 20000..20050", "capture right 0/1 10000..21000 words 10 dropped 1",
                  "wait core 0/1 10000..21000 capture", "interrupt right 0/1 21000..21050",
                  "wait core 0/1 21000..24990 host", "wait pair 0/1 21000..24990 host",
                  "frame strobe 0/1 24990..25000", "capture left 1/2 30000..40000 words 10",
                  "interrupt left 1/2 40000..40050", "capture right 1/2 30000..41000 words 10 dropped 1",
                  "interrupt right 1/2 41000..41050", "frame cycles 0/1 25000..100000 words 8",
                  "wait pair 1/2 41000..125000 core", "frame pipeline 0/1 100000..125000",
                  "interrupt core 0/1 125000..125050", "wait result 0/1 125000..127000 host",
                  "wait core 1/2 125000..200000 output_buffer", "wait pair 1/2 125000..200000 output_buffer",
                  "read_back disparity 0/1 127000..200000 words 8", "interrupt read_back 0/1 200000..200050",
                  "wait core 1/2 200000..202025 host", "wait pair 1/2 200000..202025 host",
                  "frame strobe 1/2 202025..225000", "frame cycles 1/2 225000..250000 words 8",
                  "frame pipeline 1/2 250000..275000", "interrupt core 1/2 275000..275050",
                  "wait result 1/2 275000..300000 host", "drop left -/3 309999..309999 partner",
                  "drop right -/3 309999..309999 busy", "read_back disparity 1/2 300000..310000 words 8",
                  "interrupt read_back 1/2 310000..310050"));
  EXPECT_THAT(timeline.failed(statistics()), IsEmpty());
  ASSERT_THAT(latencies, SizeIs(2));
  EXPECT_EQ(std::tie(latencies[1].frame, latencies[1].camera_frame, latencies[1].begin_ps),
            std::tuple(1, 2, 30'000));
  EXPECT_THAT(latencies[1].parts_ps, ElementsAre(11'000, 0, 0, 161'025, 72'975, 25'000, 10'000, 1000));
}

TEST_F(TwoRecordedFrames, FailIfAFigureOfTheRunIsAnother) {
  run();
  timeline.mark_end(counters);
  lines(timeline.finish());
  const auto expect_failed = [this](const auto& change, const std::string& text) {
    Statistics changed = statistics();
    change(changed, *changed.computer);
    EXPECT_THAT(timeline.failed(changed), ElementsAre(text));
  };
  using Figures = ComputerStatistics;
  expect_failed([](auto&, Figures& computer) { ++computer.cameras[0].captured_frames; },
                "recorded: camera left: captures = 2, but captured_frames = 3");
  expect_failed([](auto&, Figures& computer) { ++computer.cameras[1].dropped_pixels; },
                "recorded: camera right: dropped pixels = 2, but dropped_pixels = 3");
  expect_failed([](auto&, Figures& computer) { ++computer.pci_masters[1].words; },
                "recorded: camera left: words = 20, but words of its PCI master = 21");
  expect_failed([](auto&, Figures& computer) { ++computer.cameras[0].dropped_not_armed; },
                "recorded: camera left: dropped: not_armed = 1, but dropped_not_armed = 2");
  expect_failed([](auto&, Figures& computer) { ++computer.cameras[0].dropped_busy; },
                "recorded: camera left: dropped: busy = 0, but dropped_busy = 1");
  expect_failed([](auto&, Figures& computer) { ++computer.cameras[0].dropped_by_partner; },
                "recorded: camera left: dropped: partner = 1, but dropped_partner = 2");
  expect_failed([](auto&, Figures& computer) { ++computer.dma_words; },
                "recorded: words of transfers = 76, but dma_words = 77");
  expect_failed([](Statistics& found, auto&) { ++found.ports[fpga::kResultGroup].grants; },
                "recorded: words of results = 16, but grants of port result = 17");
  expect_failed([](Statistics& found, auto&) { ++found.frame_cycles[1]; },
                "recorded: cycles of frames = 6, but sum of frame_cycles = 7");
  Statistics more = statistics();
  ++more.frames;
  EXPECT_THAT(timeline.failed(more), ElementsAre("recorded: frames of the core = 2, but frames = 3",
                                                 "recorded: interrupts of the core = 2, but frames = 3",
                                                 "recorded: latencies = 2, but frames = 3"));
}

TEST_F(TwoRecordedFrames, FailIfTheirTimesDisagree) {
  run();
  transfer(1, Buffer::kDisparity, 309'999, 310'500, 8);  // before the last one has ended
  capture(4, 400'000, 430'000);
  run_core(425'000, 17, 18, 18);  // before its pair is captured
  read_back(460'000, 470'000);
  timeline.deliver({399'999, 480'000});  // its capture began at 400000
  timeline.mark_end(counters);
  lines(timeline.finish());
  const auto failed = timeline.failed(statistics());
  const std::uint64_t latencies_ps = 191'000 + 281'000 + 80'000;
  for (const std::string& text :
       {fmt::format("recorded: parts of the latencies, ps = {}, but time from capture to host = {}",
                    latencies_ps, latencies_ps + 1),
        std::string("recorded: events of one resource that overlap = 1, but allowed = 0"),
        std::string("recorded: frames with times out of order = 1, but allowed = 0")})
    EXPECT_THAT(failed, ::testing::Contains(text));
}

TEST_F(TwoRecordedFrames, EndWhatIsUnderWayAtTheEndOfTheRun) {
  run();
  begin_capture(4, 310'500);
  timeline.capture_board(0).frame_begun(5, 310'999);
  timeline.interrupts_raised(310'900, bridge_map::kDoorbell);
  counters.cameras[0].capture.words += 3;
  counters.cameras[1].capture.dropped_pixels += 4;
  timeline.mark_end(counters);
  lines(timeline.take());
  std::vector<std::string> last = lines(timeline.finish());
  ASSERT_GT(last.size(), 4U);
  last.erase(last.begin(), last.end() - 4);
  EXPECT_THAT(last,
              ElementsAre("drop left -/5 310999..310999 not_armed", "capture left 2/4 310500..311000 words 3",
                          "capture right 2/4 310500..311000 dropped 4", "interrupt core 1/2 310900..311000"));
}

TEST_F(TwoRecordedFrames, LeaveOutWhatComesAfterTheEndOfTheRun) {
  run();
  timeline.mark_end(counters);
  std::vector<std::string> handed_out = lines(timeline.take());
  capture(4, 400'000, 430'000);
  drop(0, 5, 450'000, capture::DropReason::kNotArmed);
  EXPECT_THAT(lines(timeline.take()), IsEmpty());
  for (std::string& line : lines(timeline.finish())) handed_out.push_back(std::move(line));
  EXPECT_THAT(handed_out, SizeIs(33));
  EXPECT_EQ(handed_out.back(), "interrupt read_back 1/2 310000..310050");
  EXPECT_THAT(timeline.failed(statistics()), IsEmpty());
}

// A ring of pairs in host memory, one input buffer or more, and no tables.
class RecordedRing : public TimelineSteps {
 protected:
  RecordedRing()
      : TimelineSteps({"capture.destination=host_memory", "allocation.left_image=bank0",
                       "allocation.right_image=bank2", "allocation.left_lut=none",
                       "allocation.right_lut=none"}) {}
  void copy(std::uint64_t begin_ps, std::uint64_t end_ps) {
    begin_copy(begin_ps);
    transfer(0, Buffer::kLeftImage, begin_ps, (begin_ps + end_ps) / 2, 10);
    transfer(0, Buffer::kRightImage, (begin_ps + end_ps) / 2, end_ps, 10);
    interrupt(bridge_map::kDmaDone, end_ps, end_ps + 50);
  }
};

TEST_F(RecordedRing, NamesWhyAPairWaitsForItsCopy) {
  capture(0, 0, 10'000);
  copy(11'000, 41'000);
  capture(1, 20'000, 30'000);
  run_core(50'000, 2, 3, 4);
  copy(101'000, 110'000);
  read_back(120'000, 130'000);
  run_core(125'000, 5, 6, 6);
  timeline.deliver({0, 131'000});
  timeline.mark_end(counters);
  std::vector<std::string> waits;
  for (const std::string& line : lines(timeline.finish())) {
    if (line.rfind("wait", 0) == 0) waits.push_back(line);
  }
  EXPECT_THAT(waits,
              ElementsAre("wait core 0/0 0..10000 capture", "wait ring 0/0 10000..11000 host",
                          "wait core 0/0 10000..41000 copy", "wait ring 1/1 30000..41000 copy",
                          "wait core 0/0 41000..50000 host", "wait pair 0/0 41000..50000 host",
                          "wait ring 1/1 41000..100000 input_buffer", "wait ring 1/1 100000..101000 host",
                          "wait core 1/1 100000..110000 copy", "wait result 0/0 100000..120000 host",
                          "wait core 1/1 110000..125000 host", "wait pair 1/1 110000..125000 host"));
  EXPECT_THAT(latencies[0].parts_ps, ElementsAre(10'000, 1000, 30'000, 9000, 50'000, 20'000, 10'000, 1000));
}

TEST_F(RecordedRing, CountsTheWordsOfACopyThatTheEndOfTheRunCuts) {
  capture(0, 0, 10'000);
  begin_copy(11'000);
  transfer(0, Buffer::kLeftImage, 11'000, 12'000, 10);
  timeline.transfer_begun(0, 12'000, {false, 0, address_of(Buffer::kRightImage), 10});
  capture(1, 20'000, 30'000);
  begin_frame(40'000);
  timeline.frame_ended({40'000, 2, 3, 4, 8});
  begin_read_back(110'000);
  timeline.deliver({0, 120'000});
  counters.bridge.dma_words = 13;
  timeline.mark_end(counters);
  lines(timeline.take());
  const std::vector<std::string> last = lines(timeline.finish());
  EXPECT_EQ(last.back(), "upload right_image 0/0 12000..120000 words 3");
}

// The DMA fetches the descriptor of the left picture, or of the right one.
TEST_F(RecordedRing, HasACopyWithoutAWordThatTheEndOfTheRunCuts) {
  capture(0, 0, 10'000);
  copy(11'000, 41'000);
  capture(1, 20'000, 30'000);
  run_core(50'000, 2, 3, 4);
  read_back(101'000, 110'000);
  begin_copy(111'000);
  timeline.deliver({0, 112'000});
  counters.bridge.dma_words = 28;
  timeline.mark_end(counters);
  transfer(0, Buffer::kLeftImage, 111'000, 120'000, 10);
  EXPECT_EQ(lines(timeline.finish()).back(), "upload left_image 1/1 111000..112000");

  timeline.deliver({0, 121'000});
  counters.bridge.dma_words = 38;
  timeline.mark_end(counters);
  EXPECT_EQ(lines(timeline.finish()).back(), "upload right_image 1/1 120000..121000");
}

}  // namespace
}  // namespace stereotlm::platform
