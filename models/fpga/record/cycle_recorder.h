#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/placement.h"
#include "models/fpga/record/conflict_recorder.h"
#include "models/fpga/record/core_cycle.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// A word of the host that requests, or will do so.
struct HostWord {
  std::size_t bank = 0;
  std::uint64_t address = 0;  // byte address in the bank
  HostTraffic traffic = HostTraffic::kCapture;
};
// The word that requests next, if there is one.
using NextHostWord = std::function<std::optional<HostWord>()>;

// Reports to an observer what every port does in each cycle of a window. FastForward must not skip these
// cycles. Addresses follow from the slots and from set_entries(), so that a frame without pixels has them.
// Plain C++; used at every fidelity, with the same cycles.
class CycleRecorder {
 public:
  // `conflicts` records all frames, and is given to FrameRun too. All references outlive this object.
  CycleRecorder(const CoreConfig& config, const ConflictRecorder& conflicts, const CycleWindow& window,
                CycleObserver& observer);
  // The entries of the table of a side, row by row. To be called for each side with table.
  void set_entries(Side side, const std::uint32_t* entries) { entries_[index_of(side)] = entries; }
  void set_host(NextHostWord host) { host_ = std::move(host); }

  // For FrameRun.
  void start_frame(std::uint64_t number, std::uint64_t first_cycle, const FrameBases& bases);
  // `end_cycle`: the first one behind the last write of the frame.
  void end_frame(std::uint64_t end_cycle);
  // The first cycle of the running frame, from this one on, that must be stepped; UINT64_MAX: there is none.
  std::uint64_t next_stepped(std::uint64_t cycle) const;

  // For CoreStepper, in a frame: what is decided and granted in a cycle. `control` is in the state before it.
  void step(std::uint64_t cycle, const CoreControl::Decision& decision, bool host_requests,
            memory::PortMask granted, const CoreControl& control, const memory::Arbitration& arbitration) {
    if (is_inside(cycle)) record(cycle, decision, host_requests, granted, control, arbitration);
  }

  // Reports accesses of the host that do not contend with the frame, or that come while no frame runs. If
  // `granted`, `first` and the words after it are granted, one in each of `cycles` cycles from `cycle` on. If
  // not, `first` waits in these cycles because of `cause`: memory::kTurnaround, .. To be called in the order
  // of the cycles, and for cycles of a frame before FrameRun steps them.
  void host_accesses(const HostWord& first, std::uint64_t cycle, std::uint64_t cycles, bool granted,
                     std::size_t cause = memory::kTurnaround) {
    accesses_.push_back({first, cycle, cycles, granted, cause});
  }

  // Hands out the accesses of the host before `end_cycle` while no frame runs, and keeps later ones. To be
  // called regularly, because they fill memory, and at the end of the run.
  void hand_out(std::uint64_t end_cycle) {
    if (!frame_) report_accesses(end_cycle);
  }

 private:
  struct Accesses {
    HostWord word;
    std::uint64_t cycle;
    std::uint64_t cycles;
    bool granted;
    std::size_t cause;  // of a wait
  };

  bool is_inside(std::uint64_t cycle) const;
  void record(std::uint64_t cycle, const CoreControl::Decision& decision, bool host_requests,
              memory::PortMask granted, const CoreControl& control, const memory::Arbitration& arbitration);
  std::uint64_t address_of(memory::Port port, std::uint64_t item);
  const SlotCursor& place_of_slot(memory::Port port, std::uint64_t slot);
  void set_host(CoreCycle& cycle, const HostWord& word, bool granted, std::size_t by) const;
  void set_access(CoreCycle& cycle) const;
  void drop_accesses(std::uint64_t end_cycle);
  void report_accesses(std::uint64_t end_cycle);

  CoreCycle new_cycle(std::uint64_t cycle) const;

  CoreConfig config_;
  FrameGeometry geometry_;
  Requesters requesters_;
  std::array<bool, 2> has_table_;  // [side]
  const ConflictRecorder& conflicts_;
  CycleWindow window_;
  CycleObserver& observer_;
  std::array<const std::uint32_t*, 2> entries_{};  // [side]
  NextHostWord host_;

  std::optional<std::uint64_t> frame_;  // that runs
  std::uint64_t first_cycle_ = 0;       // of the frame
  Placements placements_;
  // [port]: the place of the last slot, from which the next one is mostly one step away.
  struct Place {
    std::uint64_t slot = UINT64_MAX - 1;  // none
    SlotCursor cursor;
  };
  std::vector<Place> places_;
  std::deque<Accesses> accesses_;  // of the host, not handed out yet
};

}  // namespace stereotlm::fpga
