#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/fpga/assumed_accesses.h"
#include "models/fpga/core_stepper.h"
#include "models/fpga/transition_cache.h"

namespace stereotlm::fpga {

// Runs many cycles of a frame in one step, without data; used by FrameRun. A transition of the core that is
// in the TransitionCache is skipped; others are stepped and recorded. While rows are recorded, the cycles
// around the end of each row are stepped.
class FastForward {
 public:
  // `stepper` outlives this object. `most_groups`: cap of the transition cache.
  FastForward(CoreStepper& stepper, std::size_t most_groups)
      : stepper_(stepper), accesses_(stepper), known_(most_groups) {}

  // To be called when a frame with these accesses is to be fast-forwarded, after its ports have been routed
  // and the stepper has started it. The patterns must outlive the frame.
  void start_direct_frame(const AccessPatterns& patterns) {
    accesses_.start_direct_frame(patterns);
    forget();
  }
  // To be called when a frame starts that the owner steps itself.
  void start_stepped_frame() {
    accesses_.start_stepped_frame();
    forget();
  }
  // To be called before the route of the host changes within a frame, and after the last cycle of a frame.
  // Corrects the counts that are provisional until then.
  void settle();

  // Runs one cycle. `host_requests`: whether the host port requests in it. Returns the ports granted.
  memory::PortMask step(std::uint64_t cycle, bool host_requests);
  // Runs the cycles from `cycle` up to `end`, `end` not included, or until the frame is done. Returns the
  // next cycle.
  std::uint64_t run_ahead(std::uint64_t cycle, std::uint64_t end);

 private:
  // The group that is being stepped, to be recorded at its end.
  struct Stepped {
    TransitionCache::Group* group;
    Progress begin;
    CoreControl::Counts counts;
  };

  void forget();
  std::uint64_t skip_known(std::uint64_t cycle, std::uint64_t end);
  bool has_uniform_slots();
  std::uint64_t uniform_slots(Side side) const;
  Progress room(std::uint64_t cycle, std::uint64_t end) const;
  bool holds_group(const Progress& room) const;
  void begin_group(TransitionCache::Group& group, std::uint64_t cycle);
  void end_group(std::uint64_t cycle);
  Progress progress(std::uint64_t cycle) const;
  TransitionCache::State state(std::uint64_t cycle) const {
    return {control().state(), stepper_.arbitration().state(cycle)};
  }
  const CoreControl& control() const { return stepper_.control(); }

  CoreStepper& stepper_;
  AssumedAccesses accesses_;
  TransitionCache known_;
  std::optional<Stepped> stepped_;
  // [side]: the cached transitions hold for the slots of the frame before this one. 0: the cache is empty.
  std::array<std::uint64_t, 2> uniform_to_{};
};

}  // namespace stereotlm::fpga
