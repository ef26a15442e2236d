// StereoCore at the fidelities fast and timing-only: direct frames, and fast-forward.
#include <algorithm>
#include <array>
#include <string>

#include "models/fpga/frame_counts.h"
#include "models/fpga/stereo_core.h"
#include "models/kernels/rectification_table.h"

namespace stereotlm::fpga {
namespace {

using memory::Port;
using memory::PortMask;

// Cycles between two checks of the stall timeout.
constexpr std::uint64_t kMostCycles = std::uint64_t{1} << 22U;
constexpr std::uint64_t kHostCycles = std::uint64_t{1} << 13U;  // the same while a burst is stepped
// [port that uses the buffer]
constexpr std::array<const char*, memory::kPortCount> kBufferNames = {
    "left_lut", "right_lut", "left_image", "right_image", "disparity", ""};
constexpr PortMask kHostPort = memory::mask_of(Port::kHost);

}  // namespace

// The data.

StereoCore::Buffers StereoCore::buffers_of(const FrameStart& start) const {
  const std::uint64_t picture_bytes = control().geometry().result_words * 4;
  const std::uint64_t table_bytes = picture_bytes * 4;
  Buffers buffers{};
  const auto set = [&buffers](Port port, std::uint32_t base, std::uint64_t bytes) {
    const std::uint64_t first = registers::base_address(base);
    buffers[memory::index_of(port)] = {first, first + bytes};
  };
  if (left_lut_) set(Port::kLeftLut, start.left_lut, table_bytes);
  if (right_lut_) set(Port::kRightLut, start.right_lut, table_bytes);
  set(Port::kLeftPixel, start.left_image, picture_bytes);
  set(Port::kRightPixel, start.right_image, picture_bytes);
  set(Port::kResult, start.disparity, picture_bytes);
  return buffers;
}

// Reads pictures and tables, and computes the disparities. False if the frame must be stepped cycle by cycle.
bool StereoCore::read_frame() {
  if (!buffers_are_apart() || (host_route_.bank && hazard_with(host_route_))) return false;
  const std::uint32_t* left_table = nullptr;
  const std::uint32_t* right_table = nullptr;
  if (left_lut_) {
    left_table = read_table(*left_lut_, Port::kLeftLut, left_pattern_, left_table_is_valid_);
    if (left_table == nullptr) return false;
  }
  if (right_lut_) {
    right_table = read_table(*right_lut_, Port::kRightLut, right_pattern_, right_table_is_valid_);
    if (right_table == nullptr) return false;
  }
  const std::uint8_t* const left = left_pixel_.image(config_.core.height);
  const std::uint8_t* const right = right_pixel_.image(config_.core.height);
  if (left == nullptr || right == nullptr ||
      result_writer_.buffer(control().geometry().result_words) == nullptr) {
    return false;
  }
  if (config_.fidelity != Fidelity::kTiming)
    pipeline_->run(left, right, left_table, right_table, disparities_.data());
  return true;
}

// Null if memory grants no direct access to the table, or if an entry points outside the image.
const std::uint32_t* StereoCore::read_table(LutReader& reader, Port port, AccessPattern& pattern,
                                            bool& is_valid) {
  const std::uint32_t* const entries = reader.table(config_.core.height);
  if (entries == nullptr) return nullptr;
  const AddressRange& table = buffer_of(port);
  if (crossbar_.may_have_changed(port, table.first, table.end)) {
    is_valid = kernels::entries_point_inside(entries, (table.end - table.first) / 4, config_.core.width,
                                             config_.core.height);
    if (is_valid) pattern.set_entries(entries);
  }
  return is_valid ? entries : nullptr;
}

// Whether the buffer of the disparities overlaps no other buffer.
bool StereoCore::buffers_are_apart() const {
  const AddressRange& disparity = buffer_of(Port::kResult);
  return std::count_if(buffers_.begin(), buffers_.end(), [&disparity](const AddressRange& buffer) {
           return buffer.overlaps(disparity);
         }) == 1;  // itself
}

// Called with the last write of the frame. The disparities cannot change a table: buffers_are_apart().
void StereoCore::write_frame() {
  const std::uint64_t words = control().geometry().result_words;
  std::uint64_t answered = 0;
  if (config_.fidelity != Fidelity::kTiming) {
    std::uint8_t* const buffer = result_writer_.buffer(words);
    if (buffer == nullptr) {
      fail("direct access to the disparities was taken back within a frame");
    } else {
      std::copy(disparities_.begin(), disparities_.end(), buffer);
    }
    answered = static_cast<std::uint64_t>(
        std::count_if(disparities_.begin(), disparities_.end(),
                      [](std::uint8_t d) { return d != kernels::kInvalidDisparity; }));
  }
  count_frame(answered);
}

void StereoCore::count_frame(std::uint64_t answered) {
  const FrameCounts counts(config_.core, left_pattern_, right_pattern_, control(), answered);
  sequencer_.count(Side::kLeft, counts.left.slots);
  sequencer_.count(Side::kRight, counts.right.slots);
  if (left_lut_) left_lut_->count(counts.left.table);
  if (right_lut_) right_lut_->count(counts.right.table);
  left_pixel_.count(counts.left.image);
  right_pixel_.count(counts.right.image);
  left_filter_.count(counts.filter);
  right_filter_.count(counts.filter);
  if (left_rows_) left_rows_->count(counts.rows);
  if (right_rows_) right_rows_->count(counts.rows);
  sad_array_.count(counts.sums);
  select_min_chain_.count(counts.chain);
  select_min_tree_.count(counts.tree);
  if (config_.fidelity != Fidelity::kTiming) lr_check_.count(counts.check);
  result_packer_.count(counts.packed);
  result_writer_.count({control().result().cycles().granted() - writes_before_,
                        static_cast<std::uint64_t>(control().result().most_queued()), 0});
  crossbar_.count_direct(Port::kLeftLut, counts.left.table.reads);
  crossbar_.count_direct(Port::kRightLut, counts.right.table.reads);
  crossbar_.count_direct(Port::kLeftPixel, counts.left.image.reads);
  crossbar_.count_direct(Port::kRightPixel, counts.right.image.reads);
  crossbar_.count_direct(Port::kResult, control().geometry().result_words);
}

// The port whose buffer makes the burst a hazard; none if there is no hazard.
std::optional<Port> StereoCore::hazard_with(const HostRoute& route) const {
  // Words that were moved before are no hazard.
  const AddressRange words{route.end - 4 * local_bus_.words_left(), route.end};
  for (std::size_t port = 0; port < buffers_.size(); ++port) {
    const bool is_exclusive = route.write || port == memory::index_of(Port::kResult);
    if (is_exclusive && buffers_[port].overlaps(words)) return static_cast<Port>(port);
  }
  return std::nullopt;
}

void StereoCore::check_burst(const HostRoute& route) {
  const std::optional<Port> noticed = hazard_with(route);
  if (!noticed) return;
  const auto word = [](std::uint64_t address) {
    return std::to_string((address - memory::crossbar_address(memory::bank_of_address(address), 0)) / 4);
  };
  fail("a burst of the local bus " + std::string(route.write ? "writes" : "reads") + " words " +
       word(route.first) + ".." + word(route.end - 4) + " of bank number " + std::to_string(*route.bank) +
       ", where the running frame has its " + kBufferNames[memory::index_of(*noticed)] +
       ": needs fidelity cycle");
}

// The running frame may differ from that at Fidelity::kCycle. Where reports are not thrown, it ends with the
// error flag.
void StereoCore::fail(const std::string& text) {
  failed_ = true;
  SC_REPORT_ERROR("/stereotlm/core", (std::string(name()) + ": " + text).c_str());
}

// The time.

void StereoCore::catch_up() {
  if (state_ != State::kRunning || !direct_frame_) return;
  cycle_ = timing_.run_ahead(cycle_, clock_.edge_at_or_after(Clock::to_ps(sc_core::sc_time_stamp())));
}

// Does what is due now, then waits for the next event. An event at the time of an edge belongs to the cycle
// that begins there.
void StereoCore::fast_forward() {
  const std::uint64_t now = Clock::to_ps(sc_core::sc_time_stamp());
  if (local_bus_.word_waits()) {
    if (host_contends()) {
      serve_contended();
    } else {
      serve_uncontended(now);
    }
    return;
  }
  if (state_ == State::kFinishing) {
    finish_frame(now);
    return;
  }
  if (state_ == State::kIdle) {
    wait(start_event_ | local_bus_.request_event());
    return;
  }
  if (now < next_check_ps_) {
    wait(Clock::to_time(next_check_ps_ - now), local_bus_.request_event());
    return;
  }
  // No event can occur in cycles before the next pending one.
  const std::uint64_t horizon = now + Clock::to_ps(sc_core::sc_time_to_pending_activity());
  const std::uint64_t most = clock_.edge_ps(cycle_ + kMostCycles);
  cycle_ = timing_.run_ahead(cycle_, clock_.edge_at_or_after(std::min(horizon, most)));
  if (control().frame_done()) {
    finish_cycles(cycle_);
    return;
  }
  next_check_ps_ = clock_.edge_ps(timing_.earliest_last_write(cycle_)) + 1;
}

// Whether the burst goes to a bank of the running frame, or another master of the registers may start the
// next frame as soon as this one ends.
bool StereoCore::host_contends() const {
  return state_ == State::kRunning &&
         (!nobody_else_starts() || crossbar_.arbitration().is_used_beside(Port::kHost, *host_route_.bank));
}

// Serves the words of a contended burst, cycle by cycle.
void StereoCore::serve_contended() {
  const std::uint64_t first = clock_.edge_at_or_after(local_bus_.request_ps());
  move_burst();
  cycle_ = timing_.run_ahead(cycle_, first);  // before the host is routed: its route prevents skipping
  join_host();
  const std::uint64_t now = Clock::to_ps(sc_core::sc_time_stamp());
  for (const std::uint64_t last = cycle_ + kHostCycles; cycle_ < last && !control().frame_done(); ++cycle_) {
    const std::uint64_t edge = clock_.edge_ps(cycle_);
    const PortMask granted = timing_.step(cycle_, local_bus_.requests(edge));
    if ((granted & kHostPort) == 0) continue;
    serve_word(cycle_, edge, now);
    if (local_bus_.word_waits()) continue;
    ++cycle_;
    break;
  }
  if (control().frame_done()) {
    finish_cycles(cycle_);
  } else {
    next_check_ps_ = clock_.edge_ps(timing_.earliest_last_write(cycle_)) + 1;
  }
}

// Serves the words of an uncontended burst. They may be served before their time, unless another master of
// the registers could start a frame that uses the bank at a pending event.
void StereoCore::serve_uncontended(std::uint64_t now_ps) {
  memory::Arbitration& arbitration = crossbar_.arbitration();
  const std::size_t bank = *host_route_.bank;
  count_served(UINT64_MAX, true);  // words of the previous burst, which has ended
  served_bank_ = bank;
  // The first undecided cycle: a word that was refused until the frame ended requests from here on.
  std::uint64_t cycle = state_ == State::kRunning ? 0 : cycle_;
  move_burst();
  if (burst_is_moved_ && !arbitration.needs_turnaround(bank) && local_bus_.is_in_step_with(clock_)) {
    serve_in_step(cycle);
  }
  while (local_bus_.word_waits()) {
    cycle = std::max(cycle, clock_.edge_at_or_after(local_bus_.request_ps()));
    const std::uint64_t edge = clock_.edge_ps(cycle);
    // Another master of the registers may start a frame that uses the bank: when the previous frame ends, and
    // at any pending event.
    if (!nobody_else_starts() && state_ == State::kFinishing && cycle >= done_cycle_) {
      count_served(UINT64_MAX, false);
      finish_frame(now_ps);
      return;
    }
    if (!nobody_else_starts() && edge >= now_ps &&
        edge >= now_ps + Clock::to_ps(sc_core::sc_time_to_pending_activity())) {
      count_served(UINT64_MAX, false);
      wait(Clock::to_time(edge + 1 - now_ps));
      return;
    }
    const auto outcome = arbitration.decide_unrouted(bank, cycle, Port::kHost, host_route_.write);
    served_.push_back({cycle, 1, outcome});
    if (arbitration.grants(bank, outcome)) serve_word(cycle, edge, now_ps);
    ++cycle;
  }
  if (state_ != State::kRunning) count_served(UINT64_MAX, false);
}

// Moves the data of a burst that has just begun at once, if no frame can start before its end and its bank
// grants direct access.
void StereoCore::move_burst() {
  const std::uint64_t bytes = host_route_.end - host_route_.first;
  if (burst_is_moved_ || !nobody_else_starts() || local_bus_.words_left() * 4 != bytes) return;
  unsigned char* const words = crossbar_.direct(host_route_.first, bytes);
  if (words == nullptr) return;
  local_bus_.move_words(words);
  if (host_route_.write) crossbar_.changes(host_route_.first, bytes);
  crossbar_.count_direct(*host_route_.bank, bytes / 4);
  burst_is_moved_ = true;
}

// The next word of the burst is granted in `cycle`.
void StereoCore::serve_word(std::uint64_t cycle, std::uint64_t edge_ps, std::uint64_t now_ps) {
  if (burst_is_moved_) {
    local_bus_.count_granted(1, edge_ps, clock_.edge_ps(cycle + host_read_latency_));
  } else {
    crossbar_.grant(kHostPort);
    access_host(cycle, Clock::to_time(std::max(edge_ps, now_ps) - now_ps));
  }
}

// Serves one word a cycle from `first_cycle` on, to the end of the burst.
void StereoCore::serve_in_step(std::uint64_t first_cycle) {
  memory::Arbitration& arbitration = crossbar_.arbitration();
  const std::size_t bank = *host_route_.bank;
  const std::uint64_t first = std::max(first_cycle, clock_.edge_at_or_after(local_bus_.request_ps()));
  const std::size_t words = local_bus_.words_left();
  const auto decide = [&](std::uint64_t cycle) {
    return arbitration.decide_unrouted(bank, cycle, Port::kHost, host_route_.write);
  };
  served_.push_back({first, 1, decide(first)});
  // After its own grant each further request has the same outcome.
  if (words > 1) served_.push_back({first + 1, words - 1, decide(first + 1)});
  const std::uint64_t last = first + words - 1;
  local_bus_.count_granted(words, clock_.edge_ps(last), clock_.edge_ps(last + host_read_latency_));
}

// Counts the words served before `end_cycle`. `in_frame`: they were served in counted cycles of a frame.
void StereoCore::count_served(std::uint64_t end_cycle, bool in_frame) {
  memory::Arbitration& arbitration = crossbar_.arbitration();
  auto next = served_.begin();
  for (; next != served_.end() && next->cycle < end_cycle; ++next) {
    const std::uint64_t cycles = std::min(next->cycles, end_cycle - next->cycle);
    arbitration.count_unrouted(served_bank_, next->cycle, next->outcome, cycles);
    if (in_frame) timing_.control().host_was_busy(arbitration.grants(served_bank_, next->outcome), cycles);
    next->cycle += cycles;
    next->cycles -= cycles;
    if (next->cycles != 0) break;
  }
  served_.erase(served_.begin(), next);
}

}  // namespace stereotlm::fpga
