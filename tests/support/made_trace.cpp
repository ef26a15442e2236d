#include "tests/support/made_trace.h"

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <random>
#include <tuple>

#include "models/clock.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/record/conflict_recorder.h"

namespace stereotlm::test {
namespace {

using fpga::CoreCycle;
using fpga::Intent;
using fpga::PortCycle;
using platform::TraceRun;

constexpr std::uint64_t kLatency = 2;
constexpr std::uint64_t kGapCycles = 50;  // between two frames

// One lane: the numbers of the slots that its ports take next, and when each slot can be used.
struct Lane {
  std::uint64_t taken = 0;
  std::uint64_t handled = 0;
  std::deque<std::uint64_t> pixel_ready;
  std::deque<std::uint64_t> match_ready;
};

class PlainRun {
 public:
  explicit PlainRun(const platform::BoardConfig& board)
      : core_(platform::core_config(board)), geometry_(core_), random_(1) {}

  void frame(std::uint64_t number, MadeTrace& trace) {
    lanes_ = {};
    consumed_ = words_made_ = words_written_ = 0;
    frame_ = {number, cycle_, 0, {}, {}};
    counts_.clear();
    while (words_written_ < geometry_.result_words) {
      CoreCycle now = request(number);
      arbitrate(now);
      advance(now);
      count(now);
      trace.cycles.push_back(now);
      ++cycle_;
      const std::uint64_t row_words = geometry_.columns_per_strip() / 4;
      const std::uint64_t strip = frame_.strip_ends.size();
      const bool is_end = strip == 0 ? words_made_ > 0 : words_made_ >= strip * row_words;
      if (is_end && strip < static_cast<std::uint64_t>(geometry_.height)) end_strip();
    }
    end_strip();
    frame_.end_cycle = cycle_;
    trace.frames.push_back(frame_);
    cycle_ += kGapCycles;
  }

 private:
  static std::size_t bank_of(std::size_t port) { return port == fpga::kResultGroup ? 1 : port % 2; }

  CoreCycle request(std::uint64_t frame) {
    CoreCycle now = idle_cycle();
    now.cycle = cycle_;
    now.frame = frame;
    for (std::size_t side = 0; side < 2; ++side) {
      const Lane& lane = lanes_[side];
      now.lane_slots[side] = static_cast<std::uint32_t>(lane.taken - consumed_);
      PortCycle& lut = now.ports[fpga::lut_group(fpga::kSides[side])];
      lut.item = lane.taken;
      if (lane.taken == geometry_.slots)
        lut.intent = Intent::kIdle;
      else if (now.lane_slots[side] >= 16)
        lut.intent = Intent::kBlocked;
      else
        lut.intent = is_empty(lane.taken) ? Intent::kPass : Intent::kRequest;
      PortCycle& pixel = now.ports[fpga::pixel_group(fpga::kSides[side])];
      pixel.item = lane.handled;
      if (lane.handled == geometry_.slots || lane.taken == 0)
        pixel.intent = Intent::kIdle;
      else if (lane.pixel_ready.empty() || lane.pixel_ready.front() > cycle_)
        pixel.intent = Intent::kStarved;
      else
        pixel.intent = is_empty(lane.handled) ? Intent::kPass : Intent::kRequest;
    }
    PortCycle& result = now.ports[fpga::kResultGroup];
    result.item = words_written_;
    now.result_words = static_cast<std::uint32_t>(words_made_ - words_written_);
    if (now.result_words > 0)
      result.intent = Intent::kRequest;
    else
      result.intent = words_made_ == 0 ? Intent::kIdle : Intent::kStarved;
    if (random_() % 16 == 0) now.ports[fpga::kHostGroup].intent = Intent::kRequest;
    return now;
  }

  bool is_empty(std::uint64_t slot) const {
    fpga::SlotCursor cursor(geometry_, 0);
    cursor.advance(slot);
    return cursor.empty();
  }

  static void arbitrate(CoreCycle& now) {
    constexpr std::array<std::size_t, fpga::kGroupCount> kOrder = {fpga::kHostGroup,
                                                                   fpga::kResultGroup,
                                                                   fpga::pixel_group(fpga::Side::kLeft),
                                                                   fpga::pixel_group(fpga::Side::kRight),
                                                                   fpga::lut_group(fpga::Side::kLeft),
                                                                   fpga::lut_group(fpga::Side::kRight)};
    std::array<std::size_t, 2> winners = {fpga::kGroupCount, fpga::kGroupCount};
    for (const std::size_t port : kOrder) {
      PortCycle& cycle = now.ports[port];
      if (cycle.intent != Intent::kRequest) continue;
      cycle.bank = bank_of(port);
      cycle.address = 4 * (port * 1024 + cycle.item % 1024);
      std::size_t& winner = winners[cycle.bank];
      cycle.granted = winner == fpga::kGroupCount;
      if (cycle.granted)
        winner = port;
      else
        cycle.by = winner == fpga::kHostGroup ? kRequesters.host(now.host_traffic) : winner;
    }
  }

  void advance(CoreCycle& now) {
    const bool can_match = !lanes_[0].match_ready.empty() && !lanes_[1].match_ready.empty() &&
                           lanes_[0].match_ready.front() <= cycle_ && lanes_[1].match_ready.front() <= cycle_;
    const bool drains = consumed_ + drained_ >= geometry_.slots && consumed_ == geometry_.slots;
    now.works = can_match || drains;
    for (std::size_t side = 0; side < 2; ++side) {
      Lane& lane = lanes_[side];
      const auto passes = [&now](std::size_t port) {
        return now.ports[port].granted || now.ports[port].intent == Intent::kPass;
      };
      if (passes(fpga::pixel_group(fpga::kSides[side]))) {
        ++lane.handled;
        lane.pixel_ready.pop_front();
        lane.match_ready.push_back(cycle_ + kLatency);
      }
      if (passes(fpga::lut_group(fpga::kSides[side]))) {
        ++lane.taken;
        lane.pixel_ready.push_back(cycle_ + kLatency);
      }
      if (can_match) lane.match_ready.pop_front();
    }
    if (now.ports[fpga::kResultGroup].granted) ++words_written_;
    if (can_match) ++consumed_;
    drained_ = drains ? drained_ + 1 : 0;
    const auto slots = static_cast<std::uint64_t>(geometry_.slots_per_column);
    const std::uint64_t columns = (consumed_ + drained_) / slots;
    if (columns > geometry_.result_delay_columns)
      words_made_ = std::min((columns - geometry_.result_delay_columns) / 4, geometry_.result_words);
  }

  void count(const CoreCycle& now) {
    for (std::size_t port = 0; port < fpga::kGroupCount; ++port) {
      const PortCycle& cycle = now.ports[port];
      if (cycle.intent != Intent::kRequest) continue;
      const std::size_t requester = port == fpga::kHostGroup ? kRequesters.host(now.host_traffic) : port;
      ++counts_[{requester, cycle.bank, cycle.granted ? std::nullopt : std::optional(cycle.by)}];
    }
  }

  void end_strip() {
    const std::size_t strip = frame_.strip_ends.size();
    const std::uint64_t first = strip == 0 ? frame_.first_cycle : frame_.strip_ends.back();
    for (const auto& [key, cycles] : counts_) {
      const auto& [requester, bank, by] = key;
      frame_.runs.push_back({strip, first, cycle_, requester, bank, by, cycles});
    }
    counts_.clear();
    frame_.strip_ends.push_back(cycle_);
  }

  fpga::CoreConfig core_;
  fpga::FrameGeometry geometry_;
  std::mt19937 random_;
  std::uint64_t cycle_ = 100;
  std::array<Lane, 2> lanes_;
  std::uint64_t consumed_ = 0;
  std::uint64_t drained_ = 0;
  std::uint64_t words_made_ = 0;
  std::uint64_t words_written_ = 0;
  platform::FrameRuns frame_;
  std::map<std::tuple<std::size_t, std::size_t, std::optional<std::size_t>>, std::uint64_t> counts_;
};

}  // namespace

void MadeTrace::send(trace::TraceSink& sink) const {
  for (const platform::BusBurst& burst : bursts) sink.burst(burst);
  for (const platform::QueueLevel& level : levels) sink.level(level);
  for (const CoreCycle& cycle : cycles) sink.cycle(cycle);
  for (const platform::FrameRuns& frame : frames) sink.frame(frame);
  for (const platform::TimelineEvent& event : events) sink.event(event);
}

fpga::CoreCycle idle_cycle() {
  fpga::CoreCycle cycle;
  cycle.ports.resize(kRequesters.ports().size());
  cycle.lane_slots.resize(2);
  return cycle;
}

void finish(trace::TraceSink& sink, const trace::TimeSpan& window) {
  sink.end(window);
  for (files::OutputFile& file : sink.files()) file.complete();
  for (files::OutputFile& file : sink.files()) file.commit();
}

platform::BoardConfig made_board() {
  platform::BoardConfig board;
  board.name = "made";
  board.image = {16, 6};
  board.matcher.window = 3;
  board.matcher.disparities = 4;
  board.matcher.filter.reset();
  board.banks = {{"bank0"}, {"bank1"}};
  board.allocation = {{"bank0"}, {"bank1"}, {"bank1"}, "bank0", "bank1"};
  return board;
}

MadeTrace make_trace(const platform::BoardConfig& board, std::uint64_t frames) {
  using Bus = platform::BusBurst::Bus;
  using platform::EventKind;
  MadeTrace trace;
  PlainRun run(board);
  for (std::uint64_t frame = 0; frame < frames; ++frame) run.frame(frame, trace);
  const Clock clock(board.fpga.clock_mhz);
  const std::uint64_t first_ps = clock.edge_ps(trace.cycles.front().cycle);
  trace.bursts = {{Bus::kPci, "left_capture", "bridge", true, 0x8000, 32, first_ps, first_ps + 30'000,
                   first_ps + 60'000, first_ps + 900'000},
                  {Bus::kPci, "bridge", "host_memory", false, 0x9000, 4, first_ps + 500'000,
                   first_ps + 930'000, first_ps + 960'000, first_ps + 1'500'000},
                  {Bus::kLocal, "posted", "bank1", true, (std::uint64_t{1} << 28U) + 0x100, 16,
                   first_ps + 1'000'000, first_ps + 1'000'000, first_ps + 1'050'000, first_ps + 1'600'000}};
  trace.levels = {{"left_capture", first_ps, 32},
                  {"left_capture", first_ps + 900'000, 0},
                  {"posted", first_ps + 900'000, 32},
                  {"posted", first_ps + 1'600'000, 16}};
  trace.events = {{EventKind::kDrop, "right", std::nullopt, 0, 0, 0, 0, 0, "not_armed"},
                  {EventKind::kCapture, "left", 0, 1, 1'000'000, 1'500'500, 24, 3, ""},
                  {EventKind::kWait, "pair", 0, 1, 1'100'000, 1'600'000, 0, 0, "core"},
                  {EventKind::kWait, "pair", 1, 2, 1'400'000, 1'700'000, 0, 0, "core"},
                  {EventKind::kReadBack, "disparity", 0, 1, 1'000'000, 20'000'000, 24, 0, ""}};
  return trace;
}

}  // namespace stereotlm::test
