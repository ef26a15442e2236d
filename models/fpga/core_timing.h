#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/fpga/core_config.h"
#include "models/fpga/core_control.h"
#include "models/fpga/known_groups.h"
#include "models/fpga/row_recorder.h"
#include "models/fpga/slot_pattern.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// Whether the table entries that the LUT ports read in a cycle are valid.
struct EntriesRead {
  bool left_valid = false;
  bool right_valid = false;
};

// The cycles of the core: control and arbitration, stepped together. Plain C++, no SystemC.
//
// A frame can be stepped cycle by cycle, while whoever steps it moves the data; or it runs ahead by itself.
// Then what has come before is not stepped again: what four columns of the matcher do depends on the state
// before them, as long as the slots to come make the same accesses (KnownGroups). Of a pixel port that is
// alone on its bank it does not matter which entries are valid: a slot that needs an access takes the cycle
// of one that passes. Running ahead, all are taken for valid then, and the counts are put right in the end.
//
// While rows are recorded the cycles around the end of each are stepped.
class CoreTiming {
 public:
  // `arbitration` outlives it; `most_groups`: that it keeps in mind. Throws std::invalid_argument if the
  // configuration has problems.
  CoreTiming(const CoreConfig& config, memory::Arbitration& arbitration,
             std::size_t most_groups = KnownGroups::kMost);

  // Ports are routed. A frame whose data is moved as it is stepped ..
  void start_frame(const FrameLatencies& latencies);
  // .. or one that runs ahead, on these accesses, which outlive it.
  void start_frame(const FrameLatencies& latencies, const SlotPattern& left, const SlotPattern& right);
  // The route of the host is about to change within a frame. The core's own stay as long as it runs.
  void host_route_changes();
  // All cycles of the frame have been run: puts the counts right.
  void end_frame() { look_at_entries(); }

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
  // The same, with the entries that the patterns foretell.
  memory::PortMask step(std::uint64_t cycle, bool host_requests);

  // From cycle `cycle` to before cycle `end`, or until the frame is done. Returns the cycle that comes next.
  std::uint64_t run_ahead(std::uint64_t cycle, std::uint64_t end);
  // With `cycle` the next to run: the last write of the frame is not granted before the cycle returned.
  std::uint64_t earliest_last_write(std::uint64_t cycle) const;

  CoreControl& control() { return control_; }
  const CoreControl& control() const { return control_; }

 private:
  // A group that is being stepped, to be known from then on.
  struct Stepped {
    KnownGroups::Group* group;
    Progress begin;
    CoreControl::Counts counts;
  };

  // The table of one side, and its pixel port.
  struct Side {
    const SlotPattern* pattern = nullptr;
    bool looks = true;  // else all entries are taken for valid
  };

  void look_at_entries();
  void look_at_entries(Side& side, memory::Port port, LaneControl& lane);
  void forget();
  std::uint64_t skip_known(std::uint64_t cycle, std::uint64_t end);
  bool look_at_slots();
  std::uint64_t alike_to(const LaneControl& lane, const Side& side) const;
  Progress room(std::uint64_t cycle, std::uint64_t end) const;
  bool holds_group(const Progress& room) const;
  void begin_group(KnownGroups::Group& group, std::uint64_t cycle);
  void end_group(std::uint64_t cycle);
  Progress progress(std::uint64_t cycle) const;
  KnownGroups::State state(std::uint64_t cycle) const {
    return {control_.state(), arbitration_.state(cycle)};
  }

  CoreControl control_;
  RowRecorder rows_;
  memory::Arbitration& arbitration_;
  SlotPattern all_valid_;
  Side left_;
  Side right_;
  bool four_columns_ = false;  // the last cycle completed them

  KnownGroups known_;
  std::optional<Stepped> stepped_;
  // Slots of the frame that make the accesses of those for which the groups are known; 0: none are.
  std::uint64_t left_alike_to_ = 0;
  std::uint64_t right_alike_to_ = 0;
};

}  // namespace stereotlm::fpga
