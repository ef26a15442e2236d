#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_stepper.h"
#include "models/fpga/fast/frame_areas.h"
#include "models/fpga/fast/sdram_parts.h"
#include "models/fpga/fast/transition_cache.h"

namespace stereotlm::fpga {

// Runs many cycles of a frame in one step, without data; used by FrameRun. It skips the transitions of the
// core that are in the TransitionCache; it steps and records all others. While rows are recorded, it steps
// the cycles around the end of each row.
//
// A walk looks up one transition after the other. The core and the arbiters keep their old state until
// catch_up(). The last grant of a burst of the host ends a transition, so that a group may hold several
// bursts.
//
// What a port requests in a striped buffer or in sdram follows from the place in the frame (FrameAreas), and
// from the open rows (OpenRows). Where it does not, the frame is stepped: see follows_from_places().
class FastForward : public CoreStepper {
 public:
  // `arbitration` outlives this object. Throws std::invalid_argument if the configuration has problems.
  FastForward(const CoreConfig& config, memory::Arbitration& arbitration);

  // Prepares to fast-forward a frame with these accesses. To be called after its ports have been routed and
  // after start_frame(). The patterns must outlive the frame. The caller guarantees that frames with buffers
  // in the same banks have the same routes and latencies. This and the next function throw std::logic_error
  // if settle() has not been called since the last frame.
  void start_direct_frame(const AccessPatterns& patterns);
  // To be called when a frame starts that the owner steps itself.
  void start_stepped_frame();
  // To be called before the owner changes the route of the host within a frame, and after the last cycle of a
  // frame. `cycle`: the next cycle.
  void settle(std::uint64_t cycle);

  using CoreStepper::step;
  // Runs one cycle. `host_requests`: whether the host port requests in it. Returns the ports granted.
  memory::PortMask step(std::uint64_t cycle, bool host_requests);
  // Runs the cycles from `cycle` up to `end`, `end` not included, or until the frame is done. Returns the
  // next cycle.
  std::uint64_t run_ahead(std::uint64_t cycle, std::uint64_t end);
  // As run_ahead(), but steps no cycle: it stops where a cycle must be stepped. The core itself keeps its
  // state until another function is called.
  std::uint64_t skip_ahead(std::uint64_t cycle, std::uint64_t end) {
    return is_walking_ && cycle < end ? walk(cycle, end) : cycle;
  }
  // The longest time that the words of a burst are served in one call.
  static constexpr std::uint64_t kMostHostCycles = std::uint64_t{1} << 13U;
  // The bank of a burst of the host, and its direction.
  struct Route {
    std::size_t bank = 0;
    bool write = false;
    HostTraffic traffic = HostTraffic::kCapture;
    std::uint32_t word = 0;  // the first of the burst
  };
  struct Served {
    std::size_t words = 0;         // of the burst
    std::uint64_t last_cycle = 0;  // in which the last of them was granted
  };
  // Runs the core from `cycle` on until the host has been granted `words` words. The first word requests from
  // cycle `first` on, each further word from the cycle after a grant on. Every earlier burst must have ended
  // before `first`. Returns early if the frame is done, or kMostHostCycles after the first request. Sets
  // `cycle` to the next cycle; only a call of another function takes the core there.
  Served serve_host(std::uint64_t& cycle, const Route& route, std::uint64_t first, std::size_t words);
  // The number of cycles that were skipped and not stepped, over all frames.
  std::uint64_t skipped_cycles() const { return skipped_cycles_; }
  // The cycles that were skipped so far, but not by the core: its control has the state before them.
  const Progress& ahead() const { return ahead_; }

 private:
  using StateNumber = TransitionCache::StateNumber;
  // Words that the host requests one after the other.
  struct HostWords {
    std::uint64_t first = 0;  // first cycle in which the next word requests
    std::size_t words = 0;
    std::uint8_t route = 0;  // HostRequests::route
    std::uint32_t word = 0;  // the number of the next word in its bank
  };
  // The transition that is being stepped, to be recorded at its end.
  struct Stepped {
    StateNumber state;
    TransitionCache::Accesses accesses;
    HostWords host;
    Progress begin;
    CoreControl::Counts counts;
    std::uint64_t part;          // MatchControl::part()
    std::uint64_t refresh_left;  // refresh_left_
  };

  template <bool kMayRequest>
  memory::PortMask step_core(std::uint64_t cycle, bool host_requests);
  std::uint64_t step_group(std::uint64_t cycle, std::uint64_t end);
  std::uint64_t skip_waiting(std::uint64_t cycle, std::uint64_t end);
  void begin_walk(std::uint64_t cycle);
  void leave_walk(std::uint64_t cycle);
  void end_walk(std::uint64_t cycle);
  std::uint64_t walk(std::uint64_t cycle, std::uint64_t end);
  void route_host(std::uint64_t& cycle, const Route& route, std::uint64_t first);
  PixelNeeds needs_pixel(memory::PortMask granted) const {
    PixelNeeds needs = 0;
    for (std::size_t lane = 0; lane < control().lanes().size(); ++lane) {
      if (memory::has(granted, control().table_port(lane)) &&
          accesses_pixel(control().side_of(lane), control().lane(lane).next_slot()))
        needs |= PixelNeeds{1} << lane;
    }
    return needs;
  }
  // Whether a slot that is not empty accesses its pixel.
  bool accesses_pixel(Side side, const SlotCursor& slot) const {
    const AccessPattern* const varying = varying_[index_of(side)];
    return varying == nullptr || varying->needs_pixel(slot.column(), slot.row());
  }
  std::uint32_t next_entry(std::size_t lane);
  std::uint64_t marks(std::size_t lane) const;
  void correct_marks();
  std::optional<TransitionCache::Transition> find_next(std::uint64_t cycle);
  const memory::StateWords& last_words(StateNumber state, std::uint64_t cycle);
  void find_refreshes(StateNumber state, std::uint64_t cycle);
  void set_refresh(std::uint64_t cycle);
  std::optional<TransitionCache::Transition> find_host(std::uint64_t cycle);
  bool fits_host(const TransitionCache::Transition& transition) const;
  void follow(const TransitionCache::Transition& transition, std::uint64_t cycle);
  // Where the recorder of the frame finds the transitions that were followed; null if there is none.
  TransitionCache::Log* log() { return conflicts() != nullptr ? &in_order_ : nullptr; }
  void skip(const Progress& progress);
  // Reports what has been skipped to the recorder of the frame, if there is one. `left_of_group`:
  // left_of_group_ before it was skipped. Returns true at the end of a strip: more may be skipped then.
  bool record_skipped(std::uint64_t cycle, std::uint64_t left_of_group) {
    return conflicts() != nullptr && hand_over(*conflicts(), cycle, left_of_group);
  }
  bool hand_over(ConflictRecorder& conflicts, std::uint64_t cycle, std::uint64_t left_of_group);
  void catch_up(std::uint64_t cycle);
  StateNumber walk_varying(StateNumber state, Progress& room);
  StateNumber walk_uniform(StateNumber state, std::uint64_t consumed, Progress& room);
  void find_layout();
  bool follows_from_places() const;
  Progress room() const;
  Progress room_of_area(std::uint64_t cycles) const;
  void set_area();
  void enter_area();
  bool change_area();
  // A place in a walk, from which areas may repeat. Marks move as in TransitionCache::walk().
  struct AreaMark {
    bool is_set = false;
    StateNumber state = 0;
    std::size_t area = 0;
    Progress progress;
    std::uint64_t areas = 0;  // since the mark
    std::uint64_t next = 1;   // number of areas after which the mark moves
  };
  std::uint64_t repeat_areas(AreaMark& mark, std::uint64_t cycle, std::uint64_t end);
  // Whether a whole group fits into `room`. If not, nothing may be recorded: after a walk up to the last
  // uniform consume-cycle, the state in the cache differs from that of the core.
  bool holds_group(const Progress& room) const { return room.consumed >= cycles_of_group(); }
  std::uint64_t slots_before(std::uint64_t consumed) const;
  void set_accesses(std::uint64_t consumed, std::uint64_t cycles);
  std::uint64_t uniform_cycles(std::uint64_t consumed) const;
  const TransitionCache::Accesses& accesses();
  TransitionCache::Accesses unhandled() const;
  static std::optional<HostRequests> requests_of(const HostWords& host, std::uint64_t cycle);
  void end_stepped(std::uint64_t cycle);
  // Whether the words of the host lie in sdram. Their rows are no part of a state.
  bool host_opens_rows() const {
    return arbitration().arbiter(arbitration().bank_of(control().ports().host())).has_rows();
  }
  Progress progress(std::uint64_t cycle) const;
  StateNumber state(std::uint64_t cycle);
  // Whether the accesses of the slots matter beside the state of the walk.
  bool varies() const { return !is_regular_ && !control().match().draining(); }
  // Consume-cycles of a column, of a group, and up to this column from the state of the walk on.
  std::uint64_t cycles_per_column() const {
    return static_cast<std::uint64_t>(control().geometry().cycles_per_column);
  }
  std::uint64_t cycles_of_group() const { return 4 * cycles_per_column(); }
  std::uint64_t cycles_to(std::uint64_t column) const { return column * cycles_per_column() - consumed_; }

  CoreConfig config_;
  std::uint64_t slots_ahead_;  // of a side: the most slots from the next one of the matcher to one in a lane
  // Of frames whose buffers lie alike: see find_layout().
  struct Layout {
    std::uint64_t number;
    FrameAreas areas;
  };
  std::map<std::vector<std::uint64_t>, Layout> layouts_;
  const Layout* layout_ = nullptr;  // of the frame
  bool can_walk_ = false;           // transitions can be followed: see find_layout()
  bool is_regular_ = false;         // the numbers of the places determine the accesses of varying_
  TransitionCache known_;
  TransitionCache::Accesses no_accesses_;
  TransitionCache::Accesses accesses_;
  TransitionCache::Accesses accesses_before_;
  std::optional<Stepped> stepped_;
  memory::StateWords state_words_;               // of state()
  memory::StateWords last_words_;                // of last_words()
  std::vector<std::int64_t> refreshes_;          // of find_refreshes()
  std::size_t rows_place_ = 0;                   // of the words of open_rows_ in state_words_
  std::vector<const GroupConflicts*> repeated_;  // of record_skipped()
  std::uint64_t skipped_cycles_ = 0;
  // Whether transitions are being followed. The next four are valid then.
  bool is_walking_ = false;
  StateNumber state_ = 0;
  Progress room_;                    // how far transitions can be followed
  std::uint64_t consumed_ = 0;       // consume-cycles of the frame
  std::uint64_t left_of_group_ = 0;  // consume-cycles to the end of the group
  std::uint64_t area_end_ = 0;       // consume-cycles of the frame up to the end of the area (FrameAreas)
  OpenRows open_rows_;
  // Cycles to the next refresh of a bank of sdram. A transition in which none begins is the same however far
  // away the next one is. Any other one is recorded from a state with the cycles to the next refreshes.
  std::uint64_t refresh_left_ = UINT64_MAX;
  Progress ahead_;                 // see ahead()
  HostGrants host_ahead_;          // words of the host in these cycles, without HostGrants::cycles
  HostWords host_;                 // words that are granted from the next cycle on
  TransitionCache::Log in_order_;  // what has been followed and is not yet handed to the recorder
  bool is_host_routed_ = false;    // by serve_host()
  // [side]: the pattern of a side whose accesses vary. Null if all slots inside the image access their
  // pixels. Null for a side without table: LaneControl itself finds hits of the cache.
  std::array<const AccessPattern*, 2> varying_{};
  const AccessPatterns* patterns_ = nullptr;  // of a direct frame
  // [lane]: the place of a slot that the pixel port has handled, with the number of slots before it.
  struct Handled {
    std::uint64_t slots = 0;
    SlotCursor slot;
  };
  std::vector<Handled> handled_;
};

}  // namespace stereotlm::fpga
