#pragma once

#include <cstdint>

#include "models/fpga/frame_geometry.h"
#include "models/fpga/port_cycles.h"
#include "models/memory/bank_traits.h"

namespace stereotlm::fpga {

// The read latencies that a lane supports, in cycles.
inline constexpr kernels::IntegerRule kLaneLatencyRule{1, 8};

static_assert(
    [] {
      for (const memory::BankTraits& bank : memory::kBankTraits) {
        if (bank.kind != memory::BankKind::kSdram && !kLaneLatencyRule.allows(bank.read_latency_cycles))
          return false;
      }
      return kLaneLatencyRule.allows(memory::kCasLatencyRule.min) &&
             kLaneLatencyRule.allows(memory::kCasLatencyRule.max);
    }(),
    "a lane cannot hold the read latency of a kind of bank");

// Decides the timing of one lane of the core, from the sequence of slots to the matcher: what its ports
// request in each cycle, and what follows from the grants. Plain C++. It is the only description of the
// lane's timing, used at every fidelity.
//
// A cycle is decide() and ready(), then the arbitration, then commit().
class LaneControl {
 public:
  struct Decision {
    Intent lut = Intent::kIdle;
    Intent pixel = Intent::kIdle;
  };

  // `lane`: 0 .. geometry.lanes - 1. `fifo_slots`: the most slots in the lane. Throws std::invalid_argument
  // outside kLaneFifoRule.
  LaneControl(const FrameGeometry& geometry, int lane, bool has_table, PixelCache cache, int fifo_slots)
      : first_slot_(geometry, lane),
        has_table_(has_table),
        has_cache_(cache == PixelCache::kWord),
        fifo_slots_(static_cast<std::uint64_t>(kLaneFifoRule.required("lane_fifo_slots", fifo_slots))) {}

  // Read latencies of the banks that hold this frame's table and image; without a table the first has no
  // effect. Throws std::invalid_argument outside kLaneLatencyRule.
  void start_frame(int table_latency_cycles, int image_latency_cycles) {
    const auto more_than_one = [](const char* field, int latency) {
      return static_cast<unsigned>(kLaneLatencyRule.required(field, latency) - 1);
    };
    table_cycles_ = has_table_ ? more_than_one("table_latency_cycles", table_latency_cycles) : 0;
    image_cycles_ = more_than_one("image_latency_cycles", image_latency_cycles);
    coming_entries_ = 0;
    coming_pixels_ = 0;
    next_slot_ = first_slot_;
    consumed_before_frame_ += consumed_;
    taken_ = 0;
    handled_ = 0;
    consumed_ = 0;
    arrived_entries_ = 0;
    arrived_pixels_ = 0;
  }

  Decision decide() const {
    if (!has_table_) return {Intent::kIdle, take_intent()};
    return {take_intent(), handle_intent()};
  }
  // Whether the matcher can consume a slot of this lane.
  bool ready() const { return arrived_pixels_ > consumed_; }

  // `lut_granted`, `pixel_granted`: whether the request of the port was granted. `needs_pixel`: whether the
  // slot whose table entry the LUT port has just read needs an access for its pixel; without effect if it has
  // read none. `consumes`: whether the matcher consumes a slot in this cycle.
  void commit(Decision decision, bool lut_granted, bool pixel_granted, bool needs_pixel, bool consumes) {
    const bool pixel_moves = pixel_granted || decision.pixel == Intent::kPass;
    const bool takes = has_table_ ? lut_granted || decision.lut == Intent::kPass : pixel_moves;
    if (takes) {
      const std::uint64_t mark = std::uint64_t{1} << taken_ % kMostSlots;
      marks_ = lut_granted && needs_pixel ? marks_ | mark : marks_ & ~mark;
      next_slot_.advance();
      ++taken_;
    }
    handled_ += std::uint64_t{pixel_moves};
    consumed_ += std::uint64_t{consumes};
    // What is read in cycle c can be used from cycle c + latency on.
    coming_entries_ = coming_entries_ << 1U | unsigned{takes};
    coming_pixels_ = coming_pixels_ << 1U | unsigned{pixel_moves};
    arrived_entries_ += coming_entries_ >> table_cycles_ & 1U;
    arrived_pixels_ += coming_pixels_ >> image_cycles_ & 1U;
  }

  // Sets, for each slot that is taken but not handled, whether it needs an access: bit i of `marks` is for
  // slot handled() + i.
  void set_marks(std::uint64_t marks) {
    const std::uint64_t place = handled_ % kMostSlots;
    marks_ = place == 0 ? marks : marks << place | marks >> (kMostSlots - place);
  }

  // The state that determines the lane's next cycles, together with the slots that the pixel port has not
  // handled yet.
  using State = std::uint64_t;
  State state() const {
    return (taken_ - consumed_) | (handled_ - consumed_) << 8U | (arrived_entries_ - consumed_) << 16U |
           (arrived_pixels_ - consumed_) << 24U | std::uint64_t{next_slot_.done()} << 32U |
           std::uint64_t{arrived_entries_ != 0} << 33U |
           std::uint64_t{coming_entries_ & ((1U << table_cycles_) - 1)} << kComingEntriesBit |
           std::uint64_t{coming_pixels_ & ((1U << image_cycles_) - 1)} << kComingPixelsBit;
  }
  // Skips the cycles in which the matcher consumes `slots` slots. The lane is in `state` afterwards. The
  // caller then calls set_marks().
  void set_state(State state, std::uint64_t slots) {
    static_assert(kMostSlots <= 0xff);
    const auto behind_consumed = [&](unsigned bit) { return consumed_ + (state >> bit & 0xffU); };
    const std::uint64_t taken_before = taken_;
    consumed_ += slots;
    taken_ = behind_consumed(0);
    handled_ = behind_consumed(8);
    arrived_entries_ = behind_consumed(16);
    arrived_pixels_ = behind_consumed(24);
    coming_entries_ = state >> kComingEntriesBit & 0xffU;
    coming_pixels_ = state >> kComingPixelsBit & 0xffU;
    next_slot_.advance(taken_ - taken_before);
  }

  // Whether everything that was read can be used. Then nothing changes in a cycle in which no port of the
  // lane moves and the matcher consumes nothing.
  bool has_all() const { return arrived_entries_ == taken_ && arrived_pixels_ == handled_; }
  // The number of slots in the lane, and of those that are handled.
  std::uint64_t slots() const { return taken_ - consumed_; }
  std::uint64_t handled_slots() const { return handled_ - consumed_; }
  // The number of slots of the frame that the lane has taken, and the number that the pixel port has handled.
  std::uint64_t taken() const { return taken_; }
  std::uint64_t handled() const { return handled_; }
  bool has_table() const { return has_table_; }
  // The first slot of the lane in a frame.
  const SlotCursor& first_slot() const { return first_slot_; }
  // The slot that the lane takes next.
  const SlotCursor& next_slot() const { return next_slot_; }
  // The number of slots that the matcher has consumed, over all frames.
  std::uint64_t consumed() const { return consumed_before_frame_ + consumed_; }

 private:
  static constexpr std::uint64_t kMostSlots = kLaneFifoRule.max;
  static constexpr unsigned kComingEntriesBit = 40;  // of State
  static constexpr unsigned kComingPixelsBit = 48;

  Intent take_intent() const {
    if (next_slot_.done()) return Intent::kIdle;
    if (taken_ - consumed_ >= fifo_slots_) return Intent::kBlocked;
    return next_slot_.empty() || (!has_table_ && has_cached_word()) ? Intent::kPass : Intent::kRequest;
  }
  // Whether the cache of a side without table has the word of the next slot.
  bool has_cached_word() const { return has_cache_ && !begins_word(next_slot_.column()); }
  Intent handle_intent() const {
    if (arrived_entries_ > handled_) {
      return (marks_ >> handled_ % kMostSlots & 1U) != 0 ? Intent::kRequest : Intent::kPass;
    }
    return arrived_entries_ == 0 || (handled_ == taken_ && next_slot_.done()) ? Intent::kIdle
                                                                              : Intent::kStarved;
  }

  SlotCursor first_slot_;  // of a frame
  bool has_table_;
  bool has_cache_;
  std::uint64_t fifo_slots_;
  // Cycles of the read latencies beyond the first. Bit i of the next two: a slot was taken, and its pixel was
  // handled, i + 1 cycles ago.
  unsigned table_cycles_ = 0;
  unsigned image_cycles_ = 0;
  unsigned coming_entries_ = 0;
  unsigned coming_pixels_ = 0;
  SlotCursor next_slot_;
  // Numbers of slots of the frame.
  std::uint64_t taken_ = 0;
  std::uint64_t handled_ = 0;
  std::uint64_t consumed_ = 0;
  std::uint64_t arrived_entries_ = 0;  // slots taken whose entry the pixel port can use
  std::uint64_t arrived_pixels_ = 0;   // slots handled whose pixel the matcher can consume
  std::uint64_t marks_ = 0;  // bit slot % kMostSlots: the slot is taken, not handled, and needs an access
  std::uint64_t consumed_before_frame_ = 0;
};

}  // namespace stereotlm::fpga
