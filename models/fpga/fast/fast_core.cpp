#include "models/fpga/fast/fast_core.h"

#include <algorithm>

#include "models/memory/memory_config.h"

namespace stereotlm::fpga {
namespace {

// The largest number of cycles that one call of advance() runs without a burst.
constexpr std::uint64_t kMostCyclesAhead = std::uint64_t{1} << 22U;

}  // namespace

FastCore::FastCore(const CoreConfig& config, bool has_pixels, FrameRun& frames, HostPort& host_port,
                   LocalBusControl& local_bus, memory::DirectBanks& banks, const Clock& clock, Board& board)
    : frames_(frames),
      host_port_(host_port),
      local_bus_(local_bus),
      clock_(clock),
      board_(board),
      direct_frame_(config, has_pixels, banks) {}

bool FastCore::start_frame(std::uint64_t cycle, const FrameStart& start) {
  failed_ = false;
  next_check_ps_ = 0;
  if (!works_directly(start)) return false;
  host_port_.leave();
  frames_.start_direct(cycle, start.bases, direct_frame_.patterns());
  return true;
}

// Reads the data of the frame. Returns false if the frame cannot work directly on memory.
bool FastCore::works_directly(const FrameStart& start) {
  direct_frame_.set_buffers(start.bases);
  const HostRoute& burst = host_port_.burst();
  if (burst.bank && direct_frame_.hazard_with(host_port_.words_left(), burst.write)) return false;
  return direct_frame_.disparities_are_apart() && direct_frame_.read(start.joint_offsets);
}

void FastCore::route(const HostRoute& route) {
  host_port_.route(route);
  if (!route.bank) return;
  if (frames_.is_running()) {
    if (const auto group = direct_frame_.hazard_with(host_port_.words_left(), route.write))
      report_hazard(route, *group);
  }
  host_port_.serve_new_burst();
}

// A burst of the local bus is a hazard: it accesses the buffer of this port group.
void FastCore::report_hazard(const HostRoute& burst, std::size_t group) {
  const auto word = [](std::uint64_t address) {
    return std::to_string((address - memory::crossbar_address(memory::bank_of_address(address), 0)) / 4);
  };
  fail("a burst of the local bus " + std::string(burst.write ? "writes" : "reads") + " words " +
       word(burst.first) + ".." + word(burst.end - 4) + " of bank number " + std::to_string(*burst.bank) +
       ", where the running frame has its " + kPortGroups[group].buffer + ": needs fidelity cycle");
}

void FastCore::fail(const std::string& why) {
  failed_ = true;
  board_.failed(why);
}

std::uint64_t FastCore::advance(std::uint64_t now_ps) {
  for (;;) {
    if (frames_.is_running()) {
      if (const std::uint64_t cycles = frames_.stalled_cycles(); cycles != 0) board_.stalled(cycles);
    }
    if (local_bus_.word_waits() && !host_port_.is_contended()) {
      const auto next_ps = host_port_.serve_uncontended(board_.horizon_ps());
      if (next_ps && *next_ps > now_ps) return *next_ps;
      if (next_ps) end_frame();
      continue;
    }
    if (frames_.is_finishing()) {
      const std::uint64_t end_ps = clock_.edge_ps(frames_.done_cycle());
      if (end_ps > now_ps) return end_ps;
      if (end_ps < now_ps) fail("the end of the frame was noticed too late");
      end_frame();
      continue;
    }
    if (!frames_.is_running()) return kNever;
    if (local_bus_.word_waits()) {
      host_port_.serve_contended();
    } else if (now_ps < next_check_ps_) {
      return next_check_ps_;
    } else {
      const std::uint64_t most_ps = clock_.edge_ps(frames_.cycle() + kMostCyclesAhead);
      const std::uint64_t end = clock_.edge_at_or_after(std::min(board_.horizon_ps(), most_ps));
      frames_.skip_ahead(end);
      if (clock_.edge_ps(frames_.earliest_last_write()) < now_ps) frames_.run_ahead(end);
    }
    if (frames_.control().frame_done()) {
      host_port_.finish_frame();
      // The disparities cannot change a table: disparities_are_apart().
      if (!direct_frame_.write()) fail("direct access to the disparities was taken back within a frame");
    } else {
      next_check_ps_ = clock_.edge_ps(frames_.earliest_last_write()) + 1;
    }
  }
}

void FastCore::end_frame() {
  frames_.end();
  board_.frame_ended(failed_);
}

}  // namespace stereotlm::fpga
