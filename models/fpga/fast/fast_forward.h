#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "models/fpga/access_pattern.h"
#include "models/fpga/core_stepper.h"
#include "models/fpga/fast/frame_places.h"
#include "models/fpga/fast/sdram_parts.h"
#include "models/fpga/fast/transition_cache.h"

namespace stereotlm::fpga {

// Runs many cycles of a frame in one step, without data; used by FrameRun. A transition of the core is
// stepped once and recorded in the TransitionCache. Where it comes again, it is skipped. Its surroundings are
// the place in the frame (FramePlaces), the cycles to the next refreshes of sdram, and the slots that access
// their pixels.
//
// The core and the arbiters keep their old state while transitions are skipped; ahead() says how far they are
// behind. The recorder of conflicts hears what is skipped. Rows of results that are recorded end in cycles
// that are stepped, as do the cycles for a CycleRecorder.
//
// Where pictures in stripes or sdram are read through a table that points to other pixels, and where two
// buffers share a row of sdram, all cycles are stepped.
class FastForward : public CoreStepper {
 public:
  // `arbitration` outlives this object. Throws std::invalid_argument if the configuration has problems.
  FastForward(const CoreConfig& config, memory::Arbitration& arbitration);

  // Prepares to fast-forward a frame with these accesses. To be called after its ports have been routed and
  // after start_frame(). The patterns must outlive the frame. The caller guarantees that frames with buffers
  // in the same banks have the same routes and latencies.
  void start_direct_frame(const AccessPatterns& patterns);
  // To be called after the last cycle of such a frame. `cycle`: the next one.
  void end_direct_frame(std::uint64_t cycle);

  // Runs the cycles from `cycle` up to `end`, `end` not included, or until the frame is done. Returns the
  // next cycle.
  std::uint64_t run_ahead(std::uint64_t cycle, std::uint64_t end);
  // As run_ahead(), but steps no cycle: it stops where a cycle must be stepped. The core itself keeps its
  // state until another function is called.
  std::uint64_t skip_ahead(std::uint64_t cycle, std::uint64_t end);
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
  using Transition = TransitionCache::Transition;
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
    TransitionCache::Surroundings around;
    std::uint64_t refresh_left;
    HostWords host;
    Progress begin;
    CoreControl::Counts counts;
  };
  // Transitions that were followed one after the other from a state on, at one place. Where they lead back to
  // this state, they come again.
  struct Loop {
    static constexpr std::size_t kMost = 16;  // transitions

    StateNumber from = 0;
    std::uint64_t place = 0;  // its number
    std::vector<Transition> transitions;
    std::size_t most = 0;  // so many transitions may follow `from`; 0: another state is taken
  };
  // The place of a slot that the pixel port has handled, with the number of slots before it.
  struct Handled {
    std::uint64_t slots = 0;
    SlotCursor slot;
  };

  void find_layout();
  bool follows_from_places() const;
  void route_host(std::uint64_t cycle, const Route& route);
  bool skip_transition(std::uint64_t& cycle, std::uint64_t end);
  std::optional<Transition> find_with_host(std::uint64_t cycle, std::uint64_t end);
  std::optional<Transition> find(std::uint64_t cycle, HostRequests host, std::uint64_t most_cycles);
  bool accesses_vary() const { return varying_[0] != nullptr || varying_[1] != nullptr; }
  // To the end of the group: the cycles that the matcher consumes. Waits make them more.
  std::uint64_t least_cycles() const { return group_end_ * cycles_per_column_ - consumed_; }
  std::uint64_t times_alike(const Transition& transition, std::uint64_t most_cycles) const;
  void follow(const Transition& transition, std::uint64_t& cycle, std::uint64_t times);
  void follow_loop(const Transition& last, std::uint64_t& cycle, std::uint64_t end);
  void replay(const Transition& transition, std::uint64_t cycle, std::uint64_t times) const;
  void catch_up(std::uint64_t cycle);
  std::uint64_t step_group(std::uint64_t cycle, std::uint64_t end);
  bool step_cycle(std::uint64_t cycle);
  std::uint64_t skip_waiting(std::uint64_t cycle, std::uint64_t end);
  std::uint64_t next_recorded(std::uint64_t cycle) const;
  void record_stepped(const Stepped& stepped, std::uint64_t cycle);
  static std::optional<HostRequests> requests_of(const HostWords& host, std::uint64_t cycle);
  bool host_opens_rows() const;
  void set_state(std::uint64_t cycle);
  void set_accesses();
  void set_refreshes(std::uint64_t cycle);
  void set_refresh_left(std::uint64_t cycle);
  TransitionCache::Surroundings mask_of_state() const;
  bool accesses_pixel(std::size_t lane, const SlotCursor& slot) const {
    return (*patterns_)[index_of(control().side_of(lane))].needs_pixel(slot.column(), slot.row());
  }
  PixelNeeds needs_pixel(memory::PortMask granted) const;
  std::uint32_t next_entry(std::size_t lane);
  std::uint64_t marks(std::size_t lane) const;
  std::uint64_t slots_consumed() const;
  // Where progress begins is arbitrary: only differences have a meaning.
  Progress progress(std::uint64_t cycle) const {
    return {cycle, control().match().consumed(), control().result().words_written()};
  }
  // The words that can be written before a row of results is complete.
  std::uint64_t most_words() const {
    return rows().next_words() - control().result().words_written() - ahead_.words - 1;
  }

  CoreConfig config_;
  std::uint64_t slots_ahead_;  // of a side: the most slots from the next one of the matcher to one in a lane
  std::uint64_t cycles_per_column_;  // consume-cycles
  std::size_t refreshing_banks_;     // of sdram
  // Of frames whose buffers lie alike: see find_layout().
  struct Layout {
    std::uint64_t number;
    FramePlaces places;
  };
  std::map<std::vector<std::uint64_t>, Layout> layouts_;
  const Layout* layout_ = nullptr;                 // of the frame; null: all of its cycles must be stepped
  const AccessPatterns* patterns_ = nullptr;       // of the frame
  std::array<const AccessPattern*, 2> varying_{};  // [side]: null if the place determines the accesses
  OpenRows open_rows_;
  std::vector<Handled> handled_;  // [lane]
  HostWords host_;                // words that are granted from the next cycle on
  Served served_;                 // words that were granted in serve_host()
  bool is_host_routed_ = false;
  TransitionCache known_;
  std::uint64_t skipped_cycles_ = 0;
  Progress ahead_;  // see ahead()

  // Whether the state before the next cycle is known, and a group is left. The others are valid then.
  bool can_follow_ = false;
  StateNumber state_ = 0;
  Loop loop_;
  std::uint64_t column_ = 0;        // of the matcher
  std::uint64_t group_end_ = 0;     // column
  std::uint64_t consumed_ = 0;      // consume-cycles of the frame
  std::uint64_t refresh_left_ = 0;  // cycles to the next refresh of a bank of sdram; UINT64_MAX: none
  FramePlaces::Place place_;
  // The number of the place; the cycles to the refreshes, if one begins in the transition, else 0; the slots
  // that access their pixels, half of the words for the left side.
  TransitionCache::Surroundings around_;
  memory::StateWords state_words_;  // of set_state()
  std::size_t rows_word_ = 0;       // the first word of open_rows_ in them
};

}  // namespace stereotlm::fpga
