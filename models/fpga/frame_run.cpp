#include "models/fpga/frame_run.h"

#include <algorithm>

namespace stereotlm::fpga {
namespace {

std::string text_of(Intent intent) {
  switch (intent) {
    case Intent::kRequest:
      return "asks for bank number ";
    case Intent::kPass:
      return "passes a slot";
    case Intent::kBlocked:
      return "is blocked: its lane is full";
    case Intent::kStarved:
      return "is starved";
    case Intent::kIdle:
      break;
  }
  return "is idle";
}

std::string losses_of(std::size_t port, const memory::ArbiterStats& arbiter, const CorePorts& ports) {
  std::size_t by = memory::kRefresh;
  for (std::size_t other = by; other-- > 0;) {
    const bool is_cause = other < ports.size() || other >= memory::kTurnaround;
    if (is_cause && arbiter.blame(port, other) >= arbiter.blame(port, by)) by = other;
  }
  const std::uint64_t most = arbiter.blame(port, by);
  if (most == 0) return {};
  const std::string name = by < ports.size() ? ports.name(by) : memory::name_of_cause(by);
  return ", lost " + std::to_string(most) + " cycles to " + name;
}

// What each port does in the next cycle of a frame. For a port that requests a bank, the text also names the
// port to which it has lost that bank most often.
std::string waits_of_ports(const CoreControl& control, const memory::Arbitration& arbitration,
                           bool host_requests) {
  const CoreControl::Decision decision = control.decide();
  std::string text;
  const CorePorts& ports = control.ports();
  for (std::size_t port = 0; port < ports.size(); ++port) {
    const Intent host = host_requests ? Intent::kRequest : Intent::kIdle;
    const Intent intent = port < ports.core_size() ? decision.intents[port] : host;
    text += std::string(port == 0 ? "" : "; ") + ports.name(port) + ' ' + text_of(intent);
    if (intent != Intent::kRequest) continue;
    const std::size_t bank = arbitration.bank_of(port);
    text += std::to_string(bank) + losses_of(port, arbitration.stats(bank), ports);
  }
  return text;
}

}  // namespace

FrameRun::FrameRun(const CoreConfig& config, const std::vector<memory::SsramBankConfig>& banks,
                   memory::Arbitration& arbitration, std::uint64_t stall_timeout_cycles)
    : config_(config), core_(config, arbitration), stall_timeout_cycles_(stall_timeout_cycles) {
  for (const memory::SsramBankConfig& bank : banks) latencies_.push_back(memory::read_latency_cycles(bank));
  direct_counts_.accesses.resize(banks.size());
}

bool FrameRun::has_banks(const FrameBases& bases) const {
  for (std::size_t group = 0; group < kCoreGroupCount; ++group) {
    if (has_group(config_, group) && registers::bank_of(bases[group]) >= latencies_.size()) return false;
  }
  return true;
}

void FrameRun::start_stepped(std::uint64_t cycle, const FrameBases& bases) {
  patterns_ = nullptr;
  begin(cycle, bases);
}

void FrameRun::start_direct(std::uint64_t cycle, const FrameBases& bases, const AccessPatterns& patterns) {
  patterns_ = &patterns;
  begin(cycle, bases);
  core_.start_direct_frame(patterns);
}

void FrameRun::begin(std::uint64_t cycle, const FrameBases& bases) {
  state_ = State::kRunning;
  cycle_ = std::max(cycle_, cycle);
  first_cycle_ = cycle_;
  writes_before_ = all_writes();
  work_ = control().work();
  work_cycle_ = cycle_;
  placements_ = placements_of(config_, bases);
  core_.start_frame(route_ports(), placements_);
  core_.arbitration().begin_counting(first_cycle_);
  const bool is_recorded =
      conflicts_ != nullptr && conflicts_->start_frame(first_cycle_, core_.arbitration());
  if (cycles_ != nullptr && is_recorded) cycles_->start_frame(frame_cycles_.size(), first_cycle_, bases);
  core_.record(is_recorded ? conflicts_ : nullptr, is_recorded ? cycles_ : nullptr);
}

FrameLatencies FrameRun::route_ports() {
  FrameLatencies latencies{};
  const CorePorts& ports = control().ports();
  for (std::size_t port = 0; port < ports.core_size(); ++port) {
    const std::size_t group = ports.group_of(port);
    if (!has_group(config_, group)) continue;
    core_.arbitration().route_stripe(port, placements_[group].banks(), kPortGroups[group].write);
    latencies[group] = latencies_[registers::bank_of(placements_[group].parts().front())];
  }
  return latencies;
}

std::uint64_t FrameRun::stalled_cycles() {
  const std::uint64_t work = this->work();
  const std::uint64_t cycles = work == work_ ? cycle_ - work_cycle_ : 0;
  if (work == work_ && cycles < stall_timeout_cycles_) return 0;
  work_ = work;
  work_cycle_ = cycle_;
  return cycles;
}

void FrameRun::finish() {
  state_ = State::kFinishing;
  done_cycle_ = cycle_ + static_cast<std::uint64_t>(config_.pipeline_latency_cycles);
  if (patterns_ != nullptr) core_.end_direct_frame(cycle_);
  core_.arbitration().end_counting(cycle_);
  if (patterns_ != nullptr) count_direct();
  if (core_.conflicts() == nullptr) return;
  conflicts_->end_frame(cycle_);
  if (cycles_ != nullptr) cycles_->end_frame(cycle_);
  core_.record(nullptr, nullptr);
}

// The slots and words are those of the control, so that an audit can compare them with the geometry. The
// accesses are those of the tables.
void FrameRun::count_direct() {
  // `of_rows`: returns [lane][row], the accesses to each row of the buffer; called only if it is striped.
  const auto count = [this](std::size_t group, std::uint64_t accesses, const auto& of_rows) {
    const std::vector<std::uint32_t>& parts = placements_[group].parts();
    if (parts.size() == 1) direct_counts_.accesses[registers::bank_of(parts.front())] += accesses;
    for (std::size_t part = 0; parts.size() > 1 && part < parts.size(); ++part) {
      std::uint64_t& of_bank = direct_counts_.accesses[registers::bank_of(parts[part])];
      for (const std::vector<std::uint64_t>& of_lane : of_rows()) {
        for (std::size_t row = part; row < of_lane.size(); row += parts.size()) of_bank += of_lane[row];
      }
    }
  };
  using RowAccesses = AccessPattern::RowAccesses;
  for (const Side side : kSides) {
    const AccessPattern& pattern = (*patterns_)[index_of(side)];
    const auto of_entries = [&]() -> const RowAccesses& { return pattern.table_accesses_of_rows(); };
    const auto of_pixels = [&]() -> const RowAccesses& { return pattern.pixel_accesses_of_rows(); };
    if (has_group(config_, lut_group(side))) count(lut_group(side), pattern.table_accesses(), of_entries);
    count(pixel_group(side), pattern.pixel_accesses(), of_pixels);
  }
  const Placement& results = placements_[kResultGroup];
  for (std::size_t part = 0; part < results.parts().size(); ++part) {
    direct_counts_.accesses[registers::bank_of(results.parts()[part])] +=
        results.rows_of_part(part, config_.height) * results.row_words();
  }
  for (std::size_t lane = 0; lane < control().lanes().size(); ++lane)
    direct_counts_.slots[index_of(control().side_of(lane))] += control().lane(lane).taken();
  direct_counts_.packed_words += control().match().words();
  direct_counts_.written_words += writes();
}

void FrameRun::end() {
  state_ = State::kIdle;
  frame_cycles_.push_back(done_cycle_ - first_cycle_);
  const auto pipeline = static_cast<std::uint64_t>(config_.pipeline_latency_cycles);
  for (FrameObserver* const observer : observers_)
    observer->frame_ended({strobe_ps_, first_cycle_, done_cycle_ - pipeline, done_cycle_, writes()});
  if (core_.rows().is_on()) row_profiles_.push_back(core_.rows().profile(first_cycle_));
}

std::string FrameRun::waits() {
  if (!is_running()) return "the core runs no frame";
  run_ahead(cycle_);  // after serve_host() the core has an older state
  return "frame " + std::to_string(frame_cycles_.size()) + " of the core, cycle " +
         std::to_string(cycle_ - first_cycle_) + "; " +
         waits_of_ports(control(), core_.arbitration(), host_ && host_());
}

}  // namespace stereotlm::fpga
