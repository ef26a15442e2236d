#include "models/fpga/stereo_core.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace stereotlm::fpga {
namespace {

using memory::Port;
using memory::PortMask;

// Cycles between two returns to the kernel.
constexpr std::uint64_t kQuantumCycles = 8192;

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

constexpr bool has(PortMask mask, Port port) { return (mask & memory::mask_of(port)) != 0; }

}  // namespace

StereoCore::StereoCore(const sc_core::sc_module_name& name, const StereoCoreConfig& config, Binder& binder)
    : sc_module(name),
      banks("bank", config.memory.banks.size()),
      config_(config),
      clock_(config.core.clock_mhz),
      period_ps_(clock_.edge_ps(1)),
      period_(Clock::to_time(period_ps_)) {
  SC_HAS_PROCESS(StereoCore);
  if (const double banks_mhz = config.memory.banks.front().clock_mhz; banks_mhz != config.core.clock_mhz) {
    throw std::invalid_argument(std::string(this->name()) +
                                ": clock_mhz = " + std::to_string(config.core.clock_mhz) +
                                ": must be that of the banks, " + std::to_string(banks_mhz));
  }
  bind_memory(binder);
  bind_streams();
  if (config.fidelity == Fidelity::kFast) {
    const CoreConfig& core = config.core;
    pipeline_ = std::make_unique<kernels::StereoPipeline>(
        core.width, core.height,
        kernels::StereoConfig{core.window, core.disparities, core.filter, core.lr_tolerance});
    disparities_.resize(static_cast<std::size_t>(core.width) * static_cast<std::size_t>(core.height));
  }
  SC_THREAD(run);
}

void StereoCore::bind_memory(Binder& binder) {
  const auto bind = [this, &binder](InitiatorSocket& from, Port port) {
    binder.bind(from, crossbar_.ports[memory::index_of(port)],
                std::string(memory::name_of(port)) + "_to_crossbar");
  };
  if (config_.core.left_table) {
    left_lut_ = std::make_unique<LutReader>("left_lut", config_.core.width);
    bind(left_lut_->port, Port::kLeftLut);
  }
  if (config_.core.right_table) {
    right_lut_ = std::make_unique<LutReader>("right_lut", config_.core.width);
    bind(right_lut_->port, Port::kRightLut);
  }
  bind(left_pixel_.port, Port::kLeftPixel);
  bind(right_pixel_.port, Port::kRightPixel);
  bind(result_writer_.port, Port::kResult);
  local_bus.bind(local_bus_.bus);
  binder.bind(local_bus_.memory, crossbar_.ports[memory::index_of(Port::kHost)], "host_to_crossbar");
  binder.bind(local_bus_.registers, register_file_.local_bus, "local_bus_to_registers");
  local_bus_.route_out.bind(route_in_);
  for (std::size_t bank = 0; bank < banks.size(); ++bank) crossbar_.banks[bank].bind(banks[bank]);
  registers.bind(register_file_.registers);
  register_file_.done(done);
  register_file_.start_out.bind(start_in_);
}

void StereoCore::bind_streams() {
  if (left_lut_) {
    sequencer_.left_out.bind(left_lut_->slots_in);
    left_lut_->entries_out.bind(left_pixel_.entries_in);
  } else {
    sequencer_.left_out.bind(left_pixel_.slots_in);
  }
  if (right_lut_) {
    sequencer_.right_out.bind(right_lut_->slots_in);
    right_lut_->entries_out.bind(right_pixel_.entries_in);
  } else {
    sequencer_.right_out.bind(right_pixel_.slots_in);
  }
  left_pixel_.pixels_out.bind(left_filter_.pixels_in);
  right_pixel_.pixels_out.bind(right_filter_.pixels_in);
  if (config_.core.fetch == Fetch::kLineBuffer) {
    left_rows_ = std::make_unique<RowBuffer>("left_rows", config_.core.width, config_.core.window);
    right_rows_ = std::make_unique<RowBuffer>("right_rows", config_.core.width, config_.core.window);
    left_filter_.columns_out.bind(left_rows_->columns_in);
    right_filter_.columns_out.bind(right_rows_->columns_in);
    left_rows_->columns_out.bind(sad_array_.left_in);
    right_rows_->columns_out.bind(sad_array_.right_in);
  } else {
    left_filter_.columns_out.bind(sad_array_.left_in);
    right_filter_.columns_out.bind(sad_array_.right_in);
  }
  sad_array_.chain_out.bind(select_min_chain_.sums_in);
  sad_array_.tree_out.bind(select_min_tree_.sums_in);
  select_min_chain_.matches_out.bind(lr_check_.right_in);
  select_min_tree_.matches_out.bind(lr_check_.left_in);
  lr_check_.disparities_out.bind(result_packer_.disparities_in);
  result_packer_.words_out.bind(result_writer_.words_in);
}

bool StereoCore::has_bank(std::uint32_t base) const {
  return memory::bank_of_address(registers::base_address(base)) < config_.memory.banks.size();
}

int StereoCore::latency_of(std::uint32_t base) const {
  return memory::read_latency_cycles(
      config_.memory.banks[memory::bank_of_address(registers::base_address(base))].kind);
}

void StereoCore::start_frame(const FrameStart& start) {
  if (!has_bank(start.left_image) || !has_bank(start.right_image) || !has_bank(start.disparity) ||
      (left_lut_ && !has_bank(start.left_lut)) || (right_lut_ && !has_bank(start.right_lut))) {
    register_file_.refuse_start();
    return;
  }
  const auto route = [this](Port port, std::uint32_t base, bool write) {
    const std::uint64_t address = registers::base_address(base);
    crossbar_.route(port, memory::bank_of_address(address), write);
    return address;
  };
  FrameLatencies latencies;
  if (left_lut_) {
    left_lut_->start_frame(route(Port::kLeftLut, start.left_lut, false));
    latencies.left_lut = latency_of(start.left_lut);
  }
  if (right_lut_) {
    right_lut_->start_frame(route(Port::kRightLut, start.right_lut, false));
    latencies.right_lut = latency_of(start.right_lut);
  }
  left_pixel_.start_frame(route(Port::kLeftPixel, start.left_image, false));
  right_pixel_.start_frame(route(Port::kRightPixel, start.right_image, false));
  result_writer_.start_frame(route(Port::kResult, start.disparity, true));
  latencies.left_image = latency_of(start.left_image);
  latencies.right_image = latency_of(start.right_image);
  left_filter_.start_frame();
  right_filter_.start_frame();
  if (left_rows_) left_rows_->start_frame();
  if (right_rows_) right_rows_->start_frame();
  sad_array_.start_frame();
  select_min_chain_.start_frame();
  lr_check_.start_frame();
  result_packer_.start_frame();
  errors_before_ = access_errors();
  buffers_ = buffers_of(start);
  failed_ = false;
  writes_before_ = control().result().cycles().granted();
  direct_frame_ = config_.fidelity != Fidelity::kCycle && read_frame();
  if (direct_frame_) {
    timing_.start_frame(latencies, left_pattern_, right_pattern_);
  } else {
    timing_.start_frame(latencies);
    ++stepped_frames_;
  }

  // Cycle 0 is the first that begins at or after the strobe.
  state_ = State::kRunning;
  cycle_ = std::max(cycle_, clock_.edge_at_or_after(Clock::to_ps(sc_core::sc_time_stamp() + start.delay)));
  first_cycle_ = cycle_;
  next_check_ps_ = 0;
  work_cycle_ = cycle_;
  crossbar_.begin_counting(first_cycle_);
  if (!fast_forwards()) join_host();
  start_event_.notify(sc_core::SC_ZERO_TIME);
}

void StereoCore::run() {
  for (;;) {
    if (state_ == State::kRunning) check_progress();
    if (fast_forwards()) {
      fast_forward();
    } else {
      run_ahead();
    }
  }
}

bool StereoCore::fast_forwards() const {
  return config_.fidelity != Fidelity::kCycle && (state_ != State::kRunning || direct_frame_);
}

void StereoCore::check_progress() {
  const std::uint64_t work = control().left().consumed() + control().result().cycles().granted();
  if (work != work_) {
    work_ = work;
    work_cycle_ = cycle_;
  } else if (cycle_ - work_cycle_ >= config_.stall_timeout_cycles) {
    const std::string text = std::string(name()) + ": no slot consumed and no result written for " +
                             std::to_string(cycle_ - work_cycle_) + " cycles; " + waits();
    work_cycle_ = cycle_;
    SC_REPORT_ERROR("/stereotlm/core", text.c_str());
  }
}

std::string StereoCore::waits() const {
  if (state_ != State::kRunning) return "the core runs no frame";
  const CoreControl::Decision decision = control().decide();
  std::array<Intent, memory::kPortCount> intents{};
  intents[memory::index_of(Port::kLeftLut)] = decision.left.lut;
  intents[memory::index_of(Port::kRightLut)] = decision.right.lut;
  intents[memory::index_of(Port::kLeftPixel)] = decision.left.pixel;
  intents[memory::index_of(Port::kRightPixel)] = decision.right.pixel;
  intents[memory::index_of(Port::kResult)] = decision.result;
  intents[memory::index_of(Port::kHost)] = local_bus_.word_waits() ? Intent::kRequest : Intent::kIdle;
  std::string text = "frame " + std::to_string(frame_cycles_.size()) + " of the core, cycle " +
                     std::to_string(cycle_ - first_cycle_);
  for (std::size_t index = 0; index < intents.size(); ++index) {
    text += std::string("; ") + memory::kPortNames[index] + ' ' + text_of(intents[index]);
    if (intents[index] != Intent::kRequest) continue;
    const std::size_t bank = crossbar_.bank_of(static_cast<Port>(index));
    const auto blame = crossbar_.arbiters()[bank].stats().blame[index];
    const auto most = std::max_element(blame.begin(), blame.end());
    const auto by = static_cast<std::size_t>(most - blame.begin());
    text += std::to_string(bank);
    if (*most == 0) continue;
    text += ", lost " + std::to_string(*most) + " cycles to " +
            (by == memory::ArbiterStats::kTurnaround ? "turnaround" : memory::kPortNames[by]);
  }
  return text;
}

// Runs the cycles before the next pending event, then waits for it. An event at the time of an edge belongs
// to the cycle that begins there: while one is pending at that time, the cycle waits until 1 ps later.
void StereoCore::run_ahead() {
  const std::uint64_t now = Clock::to_ps(sc_core::sc_time_stamp());
  const auto horizon_after = [now] { return now + Clock::to_ps(sc_core::sc_time_to_pending_activity()); };
  std::uint64_t horizon = horizon_after();
  sc_core::sc_time at;  // of the cycle, from now; mostly one period later than that of the last
  std::uint64_t offset_before = 0;
  for (const std::uint64_t last = cycle_ + kQuantumCycles;; ++cycle_) {
    std::uint64_t next = cycle_;
    if (state_ != State::kRunning) {
      // No cycle matters before the next request. (A frame may begin before it.)
      const bool pending = local_bus_.word_waits();
      if (pending) next = std::max(next, clock_.edge_at_or_after(local_bus_.request_ps()));
      if (state_ == State::kFinishing && (!pending || next >= done_cycle_)) {
        finish_frame(now);
        return;
      }
      if (!pending) {
        wait(start_event_ | local_bus_.request_event());
        return;
      }
    }
    const std::uint64_t edge = clock_.edge_ps(next);
    if (edge >= now && (edge >= horizon || next >= last)) {
      wait(Clock::to_time(edge + 1 - now));
      return;
    }
    cycle_ = next;
    const std::uint64_t offset = edge > now ? edge - now : 0;
    at = offset == offset_before + period_ps_ ? at + period_ : Clock::to_time(offset);
    offset_before = offset;
    if (step(edge, at)) horizon = horizon_after();  // the answer may have made other events pending
  }
}

// Waits for the end of the frame, or for a request before it. The frame ends at exactly its time.
void StereoCore::finish_frame(std::uint64_t now_ps) {
  const std::uint64_t end = clock_.edge_ps(done_cycle_);
  if (end > now_ps) {
    wait(Clock::to_time(end - now_ps), local_bus_.request_event());
  } else {
    end_frame();
  }
}

void StereoCore::route_host(const HostRoute& route) {
  host_route_ = route;
  burst_is_moved_ = false;
  if (!route.bank) {
    if (!host_is_routed_) return;
    host_is_routed_ = false;
    timing_.host_route_changes();
    crossbar_.unroute(Port::kHost);
    return;
  }
  host_read_latency_ =
      static_cast<std::uint64_t>(memory::read_latency_cycles(config_.memory.banks[*route.bank].kind));
  crossbar_.aim(Port::kHost, *route.bank, route.write);
  if (fast_forwards()) {
    if (state_ == State::kRunning) check_burst(route);
    if (nobody_else_starts() && !host_contends()) serve_uncontended(Clock::to_ps(sc_core::sc_time_stamp()));
  } else {
    join_host();
  }
}

// The host takes part in the arbitration of its burst's bank from now on.
void StereoCore::join_host() {
  if (!host_route_.bank || host_is_routed_) return;
  host_is_routed_ = true;
  timing_.host_route_changes();
  crossbar_.route(Port::kHost, *host_route_.bank, host_route_.write);
}

// One cycle. True if a burst of the local bus has been answered in it.
bool StereoCore::step(std::uint64_t edge_ps, const sc_core::sc_time& at) {
  const bool host_requests = local_bus_.requests(edge_ps);
  if (state_ != State::kRunning) {
    const PortMask host_request = host_requests ? memory::mask_of(Port::kHost) : PortMask{0};
    return has(crossbar_.arbitrate(cycle_, host_request), Port::kHost) && access_host(cycle_, at);
  }
  const PortMask granted = timing_.step(
      cycle_, host_requests, [this, &at](const CoreControl::Decision& decision, PortMask grants) {
        crossbar_.grant(grants);
        move(decision, grants, at);
        return EntriesRead{left_lut_ && left_lut_->entry_valid(), right_lut_ && right_lut_->entry_valid()};
      });
  if (control().frame_done()) finish_cycles(cycle_ + 1);
  return has(granted, Port::kHost) && access_host(cycle_, at);
}

// The data of one cycle.
void StereoCore::move(const CoreControl::Decision& decision, PortMask granted, const sc_core::sc_time& at) {
  const auto moving = static_cast<PortMask>(granted | decision.passes());
  const auto issue_left = [this, &at] { sequencer_.issue(Side::kLeft, control().left().next_slot(), at); };
  const auto issue_right = [this, &at] { sequencer_.issue(Side::kRight, control().right().next_slot(), at); };
  if (has(moving, Port::kLeftLut)) issue_left();
  if (has(moving, Port::kRightLut)) issue_right();
  if (has(moving, Port::kLeftPixel)) left_lut_ ? left_pixel_.handle(at) : issue_left();
  if (has(moving, Port::kRightPixel)) right_lut_ ? right_pixel_.handle(at) : issue_right();
  if (has(granted, Port::kResult)) result_writer_.write(at);
  if (!decision.consume) return;
  if (decision.drain) {
    left_pixel_.release_blank();
    right_pixel_.release_blank();
  } else {
    left_pixel_.release();
    right_pixel_.release();
  }
}

// The last write was granted in the cycle before this one.
void StereoCore::finish_cycles(std::uint64_t end_cycle) {
  state_ = State::kFinishing;
  done_cycle_ = end_cycle + static_cast<std::uint64_t>(config_.core.pipeline_latency_cycles);
  count_served(end_cycle, true);
  timing_.end_frame();
  crossbar_.end_counting(end_cycle);
  count_served(UINT64_MAX, false);
  if (direct_frame_) write_frame();
}

// The host's word is granted. True if its burst is answered with it.
bool StereoCore::access_host(std::uint64_t cycle, const sc_core::sc_time& at) {
  local_bus_.access(at, clock_.edge_ps(cycle), clock_.edge_ps(cycle + host_read_latency_));
  return !local_bus_.word_waits();
}

void StereoCore::end_frame() {
  state_ = State::kIdle;
  frame_cycles_.push_back(done_cycle_ - first_cycle_);
  if (timing_.rows().is_on()) row_profiles_.push_back(timing_.rows().profile(first_cycle_));
  register_file_.finish_frame(frame_cycles_.back(), failed_ || access_errors() != errors_before_);
}

std::uint64_t StereoCore::access_errors() const {
  return (left_lut_ ? left_lut_->stats().errors : 0) + (right_lut_ ? right_lut_->stats().errors : 0) +
         left_pixel_.stats().errors + right_pixel_.stats().errors + result_writer_.stats().errors;
}

}  // namespace stereotlm::fpga
