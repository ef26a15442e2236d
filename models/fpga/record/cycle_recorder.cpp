#include "models/fpga/record/cycle_recorder.h"

#include <algorithm>

#include "models/fpga/core_ports.h"
#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"
#include "models/memory/memory_config.h"

namespace stereotlm::fpga {
namespace {

// a + b, but at most UINT64_MAX.
std::uint64_t sum(std::uint64_t a, std::uint64_t b) { return a > UINT64_MAX - b ? UINT64_MAX : a + b; }

}  // namespace

CycleRecorder::CycleRecorder(const CoreConfig& config, const ConflictRecorder& conflicts,
                             const CycleWindow& window, CycleObserver& observer)
    : config_(config),
      geometry_(config),
      requesters_(CorePorts(config)),
      has_table_{has_table(config, Side::kLeft), has_table(config, Side::kRight)},
      conflicts_(conflicts),
      window_(window),
      observer_(observer),
      places_(requesters_.ports().core_size()) {}

CoreCycle CycleRecorder::new_cycle(std::uint64_t cycle) const {
  CoreCycle out;
  out.cycle = cycle;
  out.ports.resize(requesters_.ports().size());
  out.lane_slots.resize(2 * requesters_.ports().lanes());
  return out;
}

void CycleRecorder::start_frame(std::uint64_t number, std::uint64_t first_cycle, const FrameBases& bases) {
  report_accesses(first_cycle);
  frame_ = number;
  first_cycle_ = first_cycle;
  placements_ = placements_of(config_, bases);
}

void CycleRecorder::end_frame(std::uint64_t end_cycle) {
  drop_accesses(end_cycle);
  frame_.reset();
}

std::uint64_t CycleRecorder::next_stepped(std::uint64_t cycle) const {
  if (window_.frame && window_.frame != frame_) return UINT64_MAX;
  if (window_.unit == CycleWindow::Unit::kRows) {
    const bool is_over = conflicts_.strip() > window_.last / static_cast<std::uint64_t>(geometry_.rows) + 1;
    return is_over ? UINT64_MAX : cycle;  // in which cycle the rows begin is not known before
  }
  const std::uint64_t origin = window_.frame ? first_cycle_ : 0;
  const std::uint64_t next = std::max(cycle, sum(origin, window_.first));
  return next <= sum(origin, window_.last) ? next : UINT64_MAX;
}

bool CycleRecorder::is_inside(std::uint64_t cycle) const {
  if (window_.frame && window_.frame != frame_) return false;
  std::uint64_t place = cycle;
  if (window_.unit == CycleWindow::Unit::kRows) {
    if (conflicts_.strip() == 0) return false;
    const auto rows = static_cast<std::uint64_t>(geometry_.rows);
    const std::uint64_t first_row = (conflicts_.strip() - 1) * rows;
    return first_row <= window_.last && window_.first < first_row + rows;
  }
  if (window_.frame) place -= first_cycle_;
  return window_.first <= place && place <= window_.last;
}

void CycleRecorder::record(std::uint64_t cycle, const CoreControl::Decision& decision, bool host_requests,
                           memory::PortMask granted, const CoreControl& control,
                           const memory::Arbitration& arbitration) {
  CoreCycle out = new_cycle(cycle);
  out.frame = frame_;
  const auto blamed = [&](memory::Port port) {
    return conflicts_.requester_of_port(arbitration.cause_of(port, granted));
  };
  const CorePorts& ports = requesters_.ports();
  for (memory::Port port = 0; port < ports.core_size(); ++port) {
    PortCycle& of_port = out.ports[port];
    of_port.intent = decision.intents[port];
    const PortGroup& group = ports.group(port);
    const LaneControl& lane = control.lane(control.lane_index(group.side, ports.lane_of(port)));
    if (of_port.intent == Intent::kRequest || of_port.intent == Intent::kPass) {
      of_port.item = port == ports.result()                 ? control.result().words_written()
                     : group.stage == PortStage::kLutReader ? lane.taken()
                                                            : lane.handled();
    }
    if (of_port.intent != Intent::kRequest) continue;
    of_port.granted = memory::has(granted, port);
    of_port.bank = arbitration.bank_of(port);
    of_port.address = memory::address_in_bank(address_of(port, of_port.item));
    if (!of_port.granted) of_port.by = blamed(port);
  }
  if (host_requests) {
    const bool is_granted = memory::has(granted, ports.host());
    set_host(out, *host_(), is_granted, is_granted ? 0 : blamed(ports.host()));
  } else {
    drop_accesses(cycle);
    set_access(out);
  }
  for (std::size_t lane = 0; lane < out.lane_slots.size(); ++lane)
    out.lane_slots[lane] = static_cast<std::uint32_t>(control.lane(lane).slots());
  out.result_words = static_cast<std::uint32_t>(control.result().queued());
  out.works = decision.work;
  observer_.cycle(out);
}

// The address on the crossbar of what an access of a port is for.
std::uint64_t CycleRecorder::address_of(memory::Port port, std::uint64_t item) {
  const PortGroup& group = requesters_.ports().group(port);
  const Placement& buffer = placements_[requesters_.ports().group_of(port)];
  if (group.stage == PortStage::kResultWriter) {
    const std::uint64_t place = geometry_.place_of_result_word(item);
    return buffer.address(place / buffer.row_words(), place % buffer.row_words());
  }
  const SlotCursor& slot = place_of_slot(port, item);
  auto row = static_cast<std::uint64_t>(slot.row());
  auto column = static_cast<std::uint64_t>(slot.column());
  if (group.stage == PortStage::kLutReader) return buffer.address(row, column);
  const std::size_t side = index_of(group.side);
  if (has_table_[side]) {
    const std::uint32_t entry = entries_[side][row * geometry_.columns_per_strip() + column];
    row = static_cast<std::uint64_t>(kernels::entry_row(entry));
    column = static_cast<std::uint64_t>(kernels::entry_column(entry));
  }
  return buffer.address(row, column / kernels::kPixelsPerWord);
}

// The place of a slot that is not empty.
const SlotCursor& CycleRecorder::place_of_slot(memory::Port port, std::uint64_t slot) {
  Place& place = places_[port];
  if (slot == place.slot + 1) {
    place.cursor.advance();
  } else if (slot != place.slot) {
    place.cursor = SlotCursor(geometry_, static_cast<int>(requesters_.ports().lane_of(port)));
    place.cursor.advance(slot);
  }
  place.slot = slot;
  return place.cursor;
}

void CycleRecorder::set_host(CoreCycle& cycle, const HostWord& word, bool granted, std::size_t by) const {
  cycle.ports.back() = {Intent::kRequest, granted, word.bank, word.address, by, 0};
  cycle.host_traffic = word.traffic;
}

// Drops the accesses before `end_cycle`.
void CycleRecorder::drop_accesses(std::uint64_t end_cycle) {
  while (!accesses_.empty() && accesses_.front().cycle < end_cycle) {
    Accesses& accesses = accesses_.front();
    const std::uint64_t cycles = std::min(accesses.cycles, end_cycle - accesses.cycle);
    if (accesses.granted) accesses.word.address += 4 * cycles;
    accesses.cycle += cycles;
    accesses.cycles -= cycles;
    if (accesses.cycles != 0) return;
    accesses_.pop_front();
  }
}

// Sets what the host's port does in the cycle. accesses_ must have no earlier cycle.
void CycleRecorder::set_access(CoreCycle& cycle) const {
  if (accesses_.empty() || cycle.cycle < accesses_.front().cycle) return;
  const Accesses& accesses = accesses_.front();
  set_host(cycle, accesses.word, accesses.granted,
           accesses.granted ? 0 : requesters_.of_port(accesses.cause, accesses.word.traffic));
}

// Reports the accesses before `end_cycle`, while no frame runs.
void CycleRecorder::report_accesses(std::uint64_t end_cycle) {
  while (!accesses_.empty() && accesses_.front().cycle < end_cycle) {
    CoreCycle out = new_cycle(accesses_.front().cycle);
    set_access(out);
    if (is_inside(out.cycle)) observer_.cycle(out);
    drop_accesses(out.cycle + 1);
  }
}

}  // namespace stereotlm::fpga
