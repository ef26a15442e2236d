#include "sw/trace/perfetto_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace stereotlm::trace {

using platform::TraceRun;

PerfettoRows::PerfettoRows(const TraceBoard& board, PerfettoTree& tree)
    : board_(board),
      frames_(tree, TrackGroup::kCore, 0, "frames"),
      strips_(tree, TrackGroup::kCore, 1, "rows") {
  for (std::size_t requester = 0; requester < fpga::kRequesters; ++requester) {
    const std::string name = fpga::requester_name(requester);
    ports_.push_back({{tree, TrackGroup::kPorts, 3 * requester, name}});
    port_waits_.emplace_back(tree, TrackGroup::kPorts, 3 * requester + 2, name + " waits in each row",
                             "cycles");
  }
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
    const std::string& name = board.bank_name(bank);
    const bool is_separate = board.has_separate_ports(bank);
    banks_.push_back({{tree, TrackGroup::kBanks, 5 * bank, is_separate ? name + " reads" : name}});
    banks_.push_back({{tree, TrackGroup::kBanks, 5 * bank + 1, name + " writes"}});
    bank_use_.emplace_back(tree, TrackGroup::kBanks, 5 * bank + 4, name + " use", "%");
  }
}

void PerfettoRows::frame(const platform::FrameRuns& frame) {
  frames_->slice(ns(frame.first_cycle), ns(frame.end_cycle), fmt::format("frame {}", frame.frame), {});
  const TraceRun* run = frame.runs.data();
  const TraceRun* const end = run + frame.runs.size();
  std::uint64_t first_cycle = frame.first_cycle;
  for (std::size_t number = 0; number < frame.strip_ends.size(); ++number) {
    const TraceRun* const next =
        std::find_if(run, end, [number](const TraceRun& later) { return later.strip != number; });
    const Strip strip{number, first_cycle, frame.strip_ends[number], run, next, next_flow_};
    write_strip(strip);
    next_flow_ += static_cast<std::uint64_t>(next - run);
    run = next;
    first_cycle = strip.end_cycle;
  }
  end_counters(frame.end_cycle);
}

std::string PerfettoRows::name_of(std::size_t strip) const {
  if (strip == 0) return "fill";
  const int first = (static_cast<int>(strip) - 1) * board_.geometry.rows;
  const int last = std::min(first + board_.geometry.rows, board_.geometry.height) - 1;
  return first == last ? fmt::format("row {}", first) : fmt::format("rows {}..{}", first, last);
}

// The accesses of all ports come before the waits. A wait may then have an arrow from the accesses of the
// winner: of two slices that begin at one time, the arrow leads from the first in the file.
void PerfettoRows::write_strip(const Strip& strip) {
  strips_->slice(ns(strip.first_cycle), ns(strip.end_cycle), name_of(strip.number),
                 {{"cycles", strip.end_cycle - strip.first_cycle}});
  for (Row& row : ports_) row.free_cycle = std::max(row.free_cycle, strip.first_cycle);
  for (Row& row : banks_) row.free_cycle = std::max(row.free_cycle, strip.first_cycle);
  for (const TraceRun* run = strip.begin; run != strip.end; ++run) {
    if (!run->by) write_grant(strip, *run);
  }
  for (const TraceRun* run = strip.begin; run != strip.end; ++run) {
    if (run->by) write_wait(strip, *run);
  }
  write_counters(strip);
}

void PerfettoRows::write_grant(const Strip& strip, const TraceRun& run) {
  std::vector<std::uint64_t> flows;
  for (const TraceRun* wait = strip.begin; wait != strip.end; ++wait) {
    if (wait->by == run.requester && wait->bank == run.bank)
      flows.push_back(strip.first_flow + static_cast<std::uint64_t>(wait - strip.begin));
  }
  const bool write = writes(run.requester);
  write_run(ports_[run.requester], run,
            fmt::format("{} {} x{}", write ? "writes" : "reads", board_.bank_name(run.bank), run.count),
            flows);
  const bool is_second = write && board_.has_separate_ports(run.bank);
  write_run(banks_[2 * run.bank + (is_second ? 1 : 0)], run,
            fmt::format("{} x{}", fpga::requester_name(run.requester), run.count), {});
}

void PerfettoRows::write_wait(const Strip& strip, const TraceRun& run) {
  std::vector<std::uint64_t> flows;
  if (*run.by != fpga::kTurnaroundToBlame)
    flows.push_back(strip.first_flow + static_cast<std::uint64_t>(&run - strip.begin));
  write_run(ports_[run.requester], run, board_.wait_text(run.requester, run.count, *run.by, run.bank), flows);
}

void PerfettoRows::write_run(Row& row, const TraceRun& run, std::string_view name,
                             const std::vector<std::uint64_t>& flows) {
  const std::uint64_t end_cycle = row.free_cycle + run.count;
  row.track->slice(ns(row.free_cycle), ns(end_cycle), name, {}, flows);
  row.free_cycle = end_cycle;
}

void PerfettoRows::write_counters(const Strip& strip) {
  std::array<std::uint64_t, fpga::kRequesters> waits{};
  std::vector<std::uint64_t> uses(board_.banks.size());
  for (const TraceRun* run = strip.begin; run != strip.end; ++run)
    (run->by ? waits[run->requester] : uses[run->bank]) += run->count;
  const std::uint64_t begin = ns(strip.first_cycle);
  for (std::size_t requester = 0; requester < waits.size(); ++requester) {
    LazyTrack& track = port_waits_[requester];
    if (waits[requester] != 0 || track.is_written())
      track->count(begin, static_cast<double>(waits[requester]));
  }
  const auto cycles = static_cast<double>(std::max<std::uint64_t>(strip.end_cycle - strip.first_cycle, 1));
  for (std::size_t bank = 0; bank < uses.size(); ++bank) {
    LazyTrack& track = bank_use_[bank];
    if (uses[bank] != 0 || track.is_written())
      track->count(begin, 100 * static_cast<double>(uses[bank]) / cycles);
  }
}

void PerfettoRows::end_counters(std::uint64_t end_cycle) {
  for (std::vector<LazyTrack>* const tracks : {&port_waits_, &bank_use_}) {
    for (LazyTrack& track : *tracks) {
      if (track.is_written()) track->count(ns(end_cycle), 0);
    }
  }
}

}  // namespace stereotlm::trace
