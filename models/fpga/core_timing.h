#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_control.h"
#include "models/fpga/row_recorder.h"
#include "models/fpga/transition_cache.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// Whether the table entries that the LUT ports read in a cycle are valid.
struct EntriesRead {
  bool left_valid = false;
  bool right_valid = false;
};

// The cycles of the core: control and arbitration, stepped together. Plain C++, no SystemC.
//
// A frame can be stepped cycle by cycle, and the caller moves the data of each cycle. Or the frame runs ahead
// without data, in two faster ways:
// - TransitionCache: transitions that are recorded are skipped.
// - An uncontended pixel port needs the same cycles for a valid entry as for an invalid one. Until the frame
//   ends, a pass on such a port counts as a grant; resolve_validity() then corrects the counts.
//
// While rows are recorded, the cycles around the end of each row are stepped.
class CoreTiming {
 public:
  // `arbitration` outlives this object. `most_groups`: cap of the transition cache. Throws
  // std::invalid_argument if the configuration has problems.
  CoreTiming(const CoreConfig& config, memory::Arbitration& arbitration,
             std::size_t most_groups = TransitionCache::kMost);

  // Starts a frame whose data the caller moves as it is stepped. The ports are routed before.
  void start_frame(const FrameLatencies& latencies);
  // Starts a frame that runs ahead with these accesses. The patterns outlive the frame.
  void start_frame(const FrameLatencies& latencies, const AccessPattern& left, const AccessPattern& right);
  // To be called before the route of the host changes within a frame. The core's own routes stay.
  void host_route_changes();
  // To be called after the last cycle of a frame: corrects the provisional counts.
  void end_frame() { resolve_validity(); }

  // To be turned on between two frames.
  RowRecorder& rows() { return rows_; }
  const RowRecorder& rows() const { return rows_; }

  // One cycle, in which the host requests or not. `move` is called as move(decision, granted) between the
  // grants and what follows from them, and returns EntriesRead.
  template <class Move>
  memory::PortMask step(std::uint64_t cycle, bool host_requests, const Move& move) {
    using memory::PortMask;
    const CoreControl::Decision decision = control_.decide();
    const PortMask host = host_requests ? memory::mask_of(memory::Port::kHost) : PortMask{0};
    const PortMask granted = arbitration_.arbitrate(cycle, static_cast<PortMask>(decision.requests() | host));
    const EntriesRead read = move(decision, granted);
    four_columns_ = control_.commit(decision, granted, read.left_valid, read.right_valid);
    control_.count_host(host_requests, (granted & host) != 0);
    if (control_.result().words_written() == rows_.next_words()) rows_.note(cycle, control_);
    return granted;
  }
  // The same for a frame that runs ahead: the patterns say which entries are valid.
  memory::PortMask step(std::uint64_t cycle, bool host_requests);

  // Runs the cycles from `cycle` up to `end`, `end` not included, or until the frame is done. Returns the
  // next cycle.
  std::uint64_t run_ahead(std::uint64_t cycle, std::uint64_t end);
  // A lower bound of the cycle in which the last write of the frame is granted. `cycle` is the next to run.
  std::uint64_t earliest_last_write(std::uint64_t cycle) const;

  CoreControl& control() { return control_; }
  const CoreControl& control() const { return control_; }

 private:
  // The group that is being stepped, and recorded at its end.
  struct Stepped {
    TransitionCache::Group* group;
    Progress begin;
    CoreControl::Counts counts;
  };

  // The table of one side, and its pixel port.
  struct Side {
    const AccessPattern* pattern = nullptr;
    bool tracks_validity = true;  // false: all entries count as valid provisionally
  };

  void resolve_validity();
  void resolve_validity(Side& side, memory::Port port, LaneControl& lane);
  void forget();
  std::uint64_t skip_known(std::uint64_t cycle, std::uint64_t end);
  bool has_uniform_slots();
  std::uint64_t uniform_to(const LaneControl& lane, const Side& side) const;
  Progress room(std::uint64_t cycle, std::uint64_t end) const;
  bool holds_group(const Progress& room) const;
  void begin_group(TransitionCache::Group& group, std::uint64_t cycle);
  void end_group(std::uint64_t cycle);
  Progress progress(std::uint64_t cycle) const;
  TransitionCache::State state(std::uint64_t cycle) const {
    return {control_.state(), arbitration_.state(cycle)};
  }

  CoreControl control_;
  RowRecorder rows_;
  memory::Arbitration& arbitration_;
  AccessPattern all_valid_;
  Side left_;
  Side right_;
  bool four_columns_ = false;  // the last cycle completed them

  TransitionCache known_;
  std::optional<Stepped> stepped_;
  // Slots of the frame before which the cached transitions hold; 0: the cache is empty.
  std::uint64_t left_uniform_to_ = 0;
  std::uint64_t right_uniform_to_ = 0;
};

}  // namespace stereotlm::fpga
