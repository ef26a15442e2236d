#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

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
  FastForward(CoreStepper& stepper, int lane_fifo_slots, std::size_t most_groups);

  // To be called when a frame with these accesses is to be fast-forwarded, after its ports have been routed
  // and the stepper has started it. The patterns must outlive the frame. `routes`: frames with the same
  // number have the same routes and latencies.
  void start_direct_frame(const AccessPatterns& patterns, std::uint64_t routes);
  // To be called when a frame starts that the owner steps itself.
  void start_stepped_frame();
  // To be called before the route of the host changes within a frame, and after the last cycle of a frame.
  // Corrects the counts that are provisional until then.
  void settle();

  // Runs one cycle. `host_requests`: whether the host port requests in it. Returns the ports granted.
  memory::PortMask step(std::uint64_t cycle, bool host_requests);
  // Runs the cycles from `cycle` up to `end`, `end` not included, or until the frame is done. Returns the
  // next cycle.
  std::uint64_t run_ahead(std::uint64_t cycle, std::uint64_t end);
  // The number of cycles that were skipped and not stepped, over all frames.
  std::uint64_t skipped_cycles() const { return skipped_cycles_; }

 private:
  using StateNumber = TransitionCache::StateNumber;
  // Strips one after the other whose columns have the same empty slots.
  struct Strips {
    std::uint64_t end = 0;    // number of slots of the frame up to the end of the strips
    std::uint64_t empty = 0;  // bit k: slot k of each column is empty
  };
  // The group that is being stepped, to be recorded at its end.
  struct Stepped {
    StateNumber state;
    TransitionCache::Accesses accesses;
    Progress begin;
    CoreControl::Counts counts;
    std::uint64_t match;  // MatchControl::state()
  };

  // A transition that was followed at some group of the frame. It is followed there again, if the state is
  // the same: frame after frame the slots make the same accesses.
  struct Followed {
    StateNumber state = UINT32_MAX;
    TransitionCache::Transition transition;
  };

  std::uint64_t skip_known(std::uint64_t cycle, std::uint64_t end);
  StateNumber walk(StateNumber state, Progress& room);
  StateNumber walk_varying(StateNumber state, Progress& room);
  StateNumber walk_uniform(StateNumber state, std::uint64_t consumed, Progress& room);
  bool find_strips();
  Progress room(std::uint64_t cycle, std::uint64_t end) const;
  bool holds_group(const Progress& room) const;
  TransitionCache::Accesses accesses_from(std::uint64_t consumed) const;
  std::uint64_t uniform_columns(std::uint64_t consumed) const;
  void begin_group(StateNumber state, const TransitionCache::Accesses& accesses, std::uint64_t cycle);
  void end_group(std::uint64_t cycle);
  Progress progress(std::uint64_t cycle) const;
  StateNumber state(std::uint64_t cycle);
  // The number of slots that the matcher consumes in a group.
  std::uint64_t slots_of_group() const {
    return 4 * static_cast<std::uint64_t>(control().geometry().slots_per_column);
  }
  // The number of slots of the frame that the matcher has consumed, after a group.
  std::uint64_t consumed() const { return control().match().columns() * slots_of_group() / 4; }
  const CoreControl& control() const { return stepper_.control(); }

  CoreStepper& stepper_;
  std::uint64_t lane_fifo_slots_;
  std::vector<Strips> all_strips_;  // of a frame
  AssumedAccesses accesses_;
  TransitionCache known_;
  std::optional<Stepped> stepped_;
  std::uint64_t skipped_cycles_ = 0;
  std::uint64_t routes_ = 0;
  std::size_t strips_ = 0;  // index of the strips in which the lanes take their next slots
  // [side]: the pattern by which the accesses of the side vary, or null.
  std::array<const AccessPattern*, 2> varying_{};
  std::vector<Followed> followed_;  // [group of the frame]; empty until it is used
  // The patterns for which followed_ holds, and their versions.
  const AccessPatterns* patterns_ = nullptr;
  std::array<std::uint64_t, 2> versions_{};  // [side]
};

}  // namespace stereotlm::fpga
