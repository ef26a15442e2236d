#pragma once

#include <algorithm>
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
//
// Groups are skipped in the memo alone: the core and the arbiters are taken to their new state only when
// somebody needs it (catch_up()).
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
  // Runs the cycles from `cycle` on until the host is granted `words` words. The first requests from cycle
  // `first` on, each other in the cycle after a grant; all words granted before are granted before `first`.
  // Ends earlier if the frame is done, or after 8192 cycles. Changes `cycle` to the next cycle, or to the
  // beginning of the group in which the last word is granted.
  struct HostRoute {
    std::size_t bank = 0;
    bool write = false;
  };
  struct Served {
    std::size_t words = 0;
    std::uint64_t last_cycle = 0;  // in which the last of them was granted
  };
  Served serve_host(std::uint64_t& cycle, const HostRoute& route, std::uint64_t first, std::size_t words);
  // Whether a burst in this direction is probably known, because others were lately. If not, step() is
  // faster. To be called once for each burst.
  bool expects_known_burst(bool write) { return trust_[write ? 1 : 0].is_there(); }
  // The number of cycles that were skipped and not stepped, over all frames.
  std::uint64_t skipped_cycles() const { return skipped_cycles_; }
  // What the core has not been taken through yet, of the cycles that were skipped.
  const Progress& ahead() const { return ahead_; }

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
    HostRequests host;
    std::size_t host_words;
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

  // Trust in the memo's knowledge of bursts. A known burst saves more time than is lost by looking for one
  // that is not known, and by recording it.
  class Trust {
   public:
    bool is_there();
    void note(bool is_known) {
      trust_ = is_known ? std::min(trust_ + 2, kMost) : trust_ - std::min(trust_, 1U);
    }

   private:
    static constexpr unsigned kMost = 256;
    static constexpr unsigned kNew = 8;  // after kBurstsWithout bursts without trust
    static constexpr unsigned kBurstsWithout = 2048;

    unsigned trust_ = kMost;
    unsigned bursts_ = 0;  // without trust
  };
  // Words that the host requests one after the other.
  struct HostWords {
    std::uint64_t first = 0;  // first cycle in which the next word requests
    std::size_t words = 0;
  };

  template <bool kMayRequest>
  memory::PortMask step_core(std::uint64_t cycle, bool host_requests);
  std::uint64_t step_group(std::uint64_t cycle, std::uint64_t end);
  void begin_walk(std::uint64_t cycle);
  void end_walk(std::uint64_t cycle);
  std::uint64_t walk(std::uint64_t cycle, std::uint64_t end);
  void route_host(std::uint64_t cycle, const HostRoute& route);
  std::optional<TransitionCache::Transition> find_host(std::uint64_t cycle) const;
  void follow(const TransitionCache::Transition& transition);
  void skip(const Progress& progress);
  void catch_up(std::uint64_t cycle);
  StateNumber walk_known(StateNumber state, Progress& room);
  StateNumber walk_varying(StateNumber state, Progress& room);
  StateNumber walk_uniform(StateNumber state, std::uint64_t consumed, Progress& room);
  bool find_strips();
  Progress room() const;
  bool holds_group(const Progress& room) const;
  TransitionCache::Accesses accesses_from(std::uint64_t consumed) const;
  std::uint64_t uniform_columns(std::uint64_t consumed) const;
  TransitionCache::Accesses accesses() const;
  HostRequests host_requests(std::uint64_t cycle) const;
  void end_group(std::uint64_t cycle);
  Progress progress(std::uint64_t cycle) const;
  StateNumber state(std::uint64_t cycle);
  // The number of slots that the matcher consumes in a group.
  std::uint64_t slots_of_group() const {
    return 4 * static_cast<std::uint64_t>(control().geometry().slots_per_column);
  }
  const CoreControl& control() const { return stepper_.control(); }

  CoreStepper& stepper_;
  std::uint64_t lane_fifo_slots_;
  std::vector<Strips> all_strips_;  // of a frame
  AssumedAccesses accesses_;
  TransitionCache known_;
  std::optional<Stepped> stepped_;
  std::uint64_t skipped_cycles_ = 0;
  // After a group, from which transitions can be followed.
  bool is_walking_ = false;
  StateNumber state_ = 0;
  Progress room_;               // how far they can be followed
  std::uint64_t consumed_ = 0;  // slots of the frame that the matcher has consumed
  Progress ahead_;              // of the state before that of the core
  HostGrants host_ahead_;       // and of the counts of the host; without `cycles`
  // Words of the host that are to be granted from the next cycle on.
  HostWords host_;
  std::array<Trust, 2> trust_;   // in bursts that [0] read, [1] write
  bool is_host_routed_ = false;  // by serve_host()
  bool keeps_route_ = false;     // after the burst
  // The transition of the group that comes next, in which these words are granted, if it is known.
  std::optional<TransitionCache::Transition> granting_;
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
