#include "sw/trace/trace.h"

#include <algorithm>
#include <utility>

#include "sw/process/streams.h"

namespace stereotlm::trace {
namespace {

// The times of a window that names no frame.
TimeSpan span_of(const fpga::CycleWindow& window, const Clock& clock) {
  const std::uint64_t most_cycles = clock.edge_at_or_after(UINT64_MAX / 4);
  const auto begin_of = [&](std::uint64_t cycle) {
    return cycle < most_cycles ? clock.edge_ps(cycle) : UINT64_MAX;
  };
  return {begin_of(window.first), window.last < most_cycles ? begin_of(window.last + 1) : UINT64_MAX};
}

}  // namespace

void LongestWait::add(const fpga::CoreCycle& cycle) {
  if (next_cycle_ == 0) first_added_ = cycle.cycle;
  if (cycle.cycle != next_cycle_ || waited_.empty()) waited_.assign(cycle.ports.size(), 0);
  next_cycle_ = cycle.cycle + 1;
  const bool grew = std::exchange(grows_, false);
  for (std::size_t port = 0; port < waited_.size(); ++port) {
    const fpga::PortCycle& now = cycle.ports[port];
    const bool waits = now.intent == fpga::Intent::kRequest && !now.granted;
    waited_[port] = waits ? waited_[port] + 1 : 0;
    const bool is_better = waited_[port] == cycles() ? lacks_cycles_before() : waited_[port] > cycles();
    if (waited_[port] == 0 || !is_better) continue;
    first_ = next_cycle_ - waited_[port];
    end_ = next_cycle_;
    grows_ = true;
  }
  if (grew && !grows_) kept_ = recent_;
  if (cycles() != 0 && !grows_ && cycle.cycle < end_around()) kept_.push_back(cycle);
  recent_.push_back(cycle);
  const std::uint64_t under_way = *std::max_element(waited_.begin(), waited_.end());
  while (recent_.front().cycle + kBefore + under_way < next_cycle_) recent_.pop_front();
}

std::deque<fpga::CoreCycle> LongestWait::take_kept() {
  if (grows_) kept_ = std::move(recent_);
  while (!kept_.empty() && kept_.front().cycle < begin_around()) kept_.pop_front();
  return std::move(kept_);
}

std::vector<std::filesystem::path> outputs_of(const TraceFile& file) {
  namespace fs = std::filesystem;
  std::vector<fs::path> outputs = {file.path};
  if (file.format->second_file != nullptr)
    outputs.push_back(fs::path(file.path).replace_extension(file.format->second_file));
  for (fs::path& output : outputs) output = fs::weakly_canonical(files::linked_file(fs::absolute(output)));
  return outputs;
}

Trace::Trace(const std::vector<TraceFile>& files, const platform::BoardConfig& board,
             const std::optional<TraceWindow>& window)
    : clock_(board.fpga.clock_mhz),
      window_(window),
      is_of_frame_(window && window->cycles.frame),
      is_of_wait_(window && window->around_longest_wait) {
  for (const TraceFile& file : files) sinks_.push_back(file.format->make_sink(file.path, board));
  if (is_of_frame_)
    span_ = {UINT64_MAX, 0};
  else if (window)
    span_ = span_of(window->cycles, clock_);
}

void Trace::cycle(const fpga::CoreCycle& cycle) {
  is_empty_ = false;
  if (is_of_frame_) {
    span_.begin_ps = std::min(span_.begin_ps, clock_.edge_ps(cycle.cycle));
    span_.end_ps = clock_.edge_ps(cycle.cycle + 1);
  }
  wait_.add(cycle);
  if (!is_of_wait_) write(&TraceSink::cycle, cycle);
}

void Trace::burst(const platform::BusBurst& burst) {
  is_of_frame_ || is_of_wait_ ? bursts_.push_back(burst) : write(&TraceSink::burst, burst);
}

void Trace::level(const platform::QueueLevel& level) {
  is_of_frame_ || is_of_wait_ ? levels_.push_back(level) : write(&TraceSink::level, level);
}

void Trace::frame(const platform::FrameRuns& frame) {
  const fpga::CycleWindow cycles = window_.value_or(TraceWindow()).cycles;
  if (cycles.frame ? frame.frame == cycles.frame
                   : frame.first_cycle <= cycles.last && frame.end_cycle > cycles.first)
    write(&TraceSink::frame, frame);
}

void Trace::events(const platform::TimelineRecords& records) {
  for (const platform::TimelineEvent& event : records.events) write(&TraceSink::event, event);
}

void Trace::complete() {
  const bool has_wait = wait_.cycles() != 0;
  if (window_ && is_empty_)
    process::say("note", "--trace-window: has no cycle in which a frame ran or the host accessed a bank");
  else if (is_of_wait_ && !has_wait)
    process::say("note", "--trace-window: no port waits in it");
  if (is_of_wait_) {
    for (const fpga::CoreCycle& cycle : wait_.take_kept()) write(&TraceSink::cycle, cycle);
  }
  if (span_.begin_ps > span_.end_ps || (is_of_wait_ && !has_wait)) span_ = {0, 0};
  if (has_wait) span_.wait_ps = clock_.edge_ps(wait_.first_cycle());
  if (has_wait && is_of_wait_) {
    span_.begin_ps = clock_.edge_ps(wait_.begin_around());
    span_.end_ps = std::min(span_.end_ps, clock_.edge_ps(wait_.end_around()));
  }
  for (const platform::BusBurst& burst : bursts_) {
    if (burst.end_ps > span_.begin_ps && burst.request_ps < span_.end_ps) write(&TraceSink::burst, burst);
  }
  for (const platform::QueueLevel& level : levels_) {
    if (level.time_ps > span_.begin_ps && level.time_ps <= span_.end_ps) write(&TraceSink::level, level);
  }
  for (const auto& sink : sinks_) {
    sink->end(span_);
    for (files::OutputFile& file : sink->files()) file.complete();
  }
}

void Trace::commit() {
  for (const auto& sink : sinks_) {
    for (files::OutputFile& file : sink->files()) file.commit();
  }
}

}  // namespace stereotlm::trace
