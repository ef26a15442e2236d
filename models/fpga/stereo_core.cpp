#include "models/fpga/stereo_core.h"

#include <stdexcept>

namespace stereotlm::fpga {
namespace {

using memory::PortMask;

// The largest number of cycles between two returns to the kernel while the process steps. After each return
// the process checks for a stall.
constexpr std::uint64_t kMostSteppedCycles = 8192;

std::uint64_t present_ps() { return kernel_time::to_ps(sc_core::sc_time_stamp()); }

memory::CrossbarConfig crossbar_config(const StereoCoreConfig& config) {
  if (const std::size_t groups = config.memory.arbiter.priority.size(); groups != kGroupCount) {
    throw std::invalid_argument("memory.arbiter.priority = " + std::to_string(groups) +
                                " ports: must name all " + std::to_string(kGroupCount));
  }
  return {arbiter_of_ports(config.memory.arbiter, CorePorts(config.core)), config.memory.banks};
}

}  // namespace

StereoCore::StereoCore(const sc_core::sc_module_name& name, const StereoCoreConfig& config, Binder& binder)
    : sc_module(name),
      banks("bank", config.memory.banks.size()),
      config_(config),
      clock_(config.core.clock_mhz),
      ports_(config.core),
      crossbar_("crossbar", crossbar_config(config)),
      datapath_(config_.core, has_pixels(config_.fidelity), crossbar_, binder) {
  SC_HAS_PROCESS(StereoCore);
  if (const double banks_mhz = config.memory.banks.front().clock_mhz; banks_mhz != config.core.clock_mhz) {
    throw std::invalid_argument(std::string(this->name()) +
                                ": clock_mhz = " + std::to_string(config.core.clock_mhz) +
                                ": must be that of the banks, " + std::to_string(banks_mhz));
  }
  local_bus.bind(local_bus_.bus);
  binder.bind(local_bus_.memory, crossbar_.ports[ports_.host()], "host_to_crossbar");
  binder.bind(local_bus_.registers, register_file_.local_bus, "local_bus_to_registers");
  local_bus_.route_out.bind(route_in_);
  for (std::size_t bank = 0; bank < banks.size(); ++bank) crossbar_.banks[bank].bind(banks[bank]);
  registers.bind(register_file_.registers);
  register_file_.done(done);
  register_file_.start_out.bind(start_in_);
  SC_THREAD(run);
}

void StereoCore::start_frame(const FrameStart& start) {
  if (!frames_.has_banks(start.bases)) return register_file_.refuse_start();
  datapath_.start_frame(start.bases, start.joint_offsets);
  errors_before_ = datapath_.errors();
  // Cycle 0 is the first that begins at or after the strobe.
  const std::uint64_t cycle = clock_.edge_at_or_after(start.time_ps);
  is_direct_ = !steps_cycles(config_.fidelity) && fast_core_.start_frame(cycle, start);
  if (!is_direct_) {
    ++stepped_frames_;
    frames_.start_stepped(cycle, start.bases);
    host_port_.join();
  }
  frames_.strobe(start.time_ps);
  start_event_.notify(sc_core::SC_ZERO_TIME);
}

void StereoCore::frame_ended(bool failed) {
  register_file_.finish_frame(frames_.frame_cycles().back(), failed || datapath_.errors() != errors_before_);
}

void StereoCore::route_host(const HostRoute& route) {
  if (route.bank) crossbar_.aim(ports_.host(), *route.bank, route.write);
  if (fast_forwards()) {
    fast_core_.route(route);
  } else {
    host_port_.route(route);
    host_port_.join();
  }
}

void StereoCore::failed(const std::string& why) {
  SC_REPORT_ERROR("/stereotlm/core", (std::string(name()) + ": " + why).c_str());
}

std::uint64_t StereoCore::horizon_ps() const {
  return present_ps() + kernel_time::to_ps(sc_core::sc_time_to_pending_activity());
}

void StereoCore::run() {
  for (;;) {
    if (fast_forwards()) {
      fast_forward();
      continue;
    }
    if (frames_.is_running()) {
      if (const std::uint64_t cycles = frames_.stalled_cycles(); cycles != 0) stalled(cycles);
    }
    run_cycles();
  }
}

void StereoCore::stalled(std::uint64_t cycles) {
  failed("no slot consumed and no result written for " + std::to_string(cycles) + " cycles; " +
         frames_.waits());
}

bool StereoCore::fast_forwards() const {
  return !steps_cycles(config_.fidelity) && (!frames_.is_running() || is_direct_);
}

void StereoCore::catch_up() {
  if (!frames_.is_running() || !is_direct_) return;
  frames_.run_ahead(clock_.edge_at_or_after(present_ps()));
  host_port_.count_words();
}

// Does what is due now, then waits for the next event.
void StereoCore::fast_forward() {
  const std::uint64_t now = present_ps();
  const std::uint64_t next = fast_core_.advance(now);
  if (next == kNever) {
    wait(start_event_ | local_bus_.request_event());
  } else {
    wait_for_request_until(next);
  }
}

// Runs the cycles before the next pending event, then waits for it. An event at the time of an edge belongs
// to the cycle that begins there: while one is pending at that time, the cycle waits until 1 ps later.
void StereoCore::run_cycles() {
  const std::uint64_t now = present_ps();
  const std::uint64_t period_ps = clock_.edge_ps(1);
  const sc_core::sc_time period = kernel_time::to_time(period_ps);
  std::uint64_t horizon = horizon_ps();
  sc_core::sc_time at;  // start of the cycle, from now; mostly one period after that of the cycle before
  std::uint64_t offset_before = 0;
  for (const std::uint64_t last = frames_.cycle() + kMostSteppedCycles;;) {
    std::uint64_t next = frames_.cycle();
    if (!frames_.is_running()) {
      // No cycle matters before the next request. (A frame may begin before it.)
      const bool pending = local_bus_.control().word_waits();
      if (pending && local_bus_.control().request_ps() > clock_.edge_ps(next))
        next = clock_.edge_at_or_after(local_bus_.control().request_ps());
      if (frames_.is_finishing() && (!pending || next >= frames_.done_cycle())) {
        const std::uint64_t end_ps = clock_.edge_ps(frames_.done_cycle());
        if (end_ps > now) {
          wait_for_request_until(end_ps);
        } else {
          frames_.end();
          frame_ended(false);
        }
        return;
      }
      if (!pending) {
        wait(start_event_ | local_bus_.request_event());
        return;
      }
    }
    const std::uint64_t edge = clock_.edge_ps(next);
    if (edge >= now && (edge >= horizon || next >= last)) {
      wait_until(edge + 1);
      return;
    }
    if (!frames_.is_running()) frames_.set_cycle(next);
    const std::uint64_t offset = edge > now ? edge - now : 0;
    at = offset == offset_before + period_ps ? at + period : kernel_time::to_time(offset);
    offset_before = offset;
    if (step(edge, at)) horizon = horizon_ps();  // the end of the burst may have made other events pending
  }
}

// Runs the next cycle. Returns true if a burst of the local bus has ended in it.
bool StereoCore::step(std::uint64_t edge_ps, const sc_core::sc_time& at) {
  const std::uint64_t cycle = frames_.cycle();
  const bool host_requests = local_bus_.control().requests(edge_ps);
  if (host_requests) host_port_.place();
  PortMask granted = 0;
  bool host_is_served = false;
  bool burst_has_ended = false;
  const auto serve_host = [&] {
    host_is_served = true;
    burst_has_ended = host_port_.access(cycle, edge_ps);
  };
  if (frames_.is_running()) {
    granted = frames_.step(
        host_requests,
        [&](const CoreControl::Decision& decision, PortMask grants) {
          crossbar_.grant(grants);
          if (host_reads_where_core_writes(grants)) serve_host();
          return datapath_.move(control(), decision, grants, at);
        },
        [this](std::size_t lane) { return datapath_.next_entry(lane); });
    if (control().frame_done()) host_port_.finish_frame();
  } else {
    granted = crossbar_.arbitrate(cycle, host_requests ? memory::mask_of(ports_.host()) : 0);
    if (host_requests) host_port_.record_cycle(cycle, memory::has(granted, ports_.host()));
    frames_.set_cycle(cycle + 1);
  }
  if (memory::has(granted, ports_.host()) && !host_is_served) serve_host();
  return burst_has_ended;
}

// Whether the core writes a result to a bank with separate ports that the host reads in the same cycle. The
// read must come first, because it gets the old word. (move() reads before it writes, and before the host
// writes.)
bool StereoCore::host_reads_where_core_writes(PortMask granted) const {
  return memory::has(granted, ports_.host()) && memory::has(granted, ports_.result()) &&
         crossbar_.bank_of(ports_.host()) == crossbar_.bank_of(ports_.result());
}

void StereoCore::wait_for_request_until(std::uint64_t time_ps) {
  wait(kernel_time::to_time(time_ps) - sc_core::sc_time_stamp(), local_bus_.request_event());
}

}  // namespace stereotlm::fpga
