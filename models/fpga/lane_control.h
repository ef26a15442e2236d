#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "models/fpga/frame_geometry.h"

namespace stereotlm::fpga {

// What a port does in a cycle, decided from the state at its beginning (contract section 2, "Port states").
enum class Intent : std::uint8_t { kRequest, kPass, kIdle, kBlocked, kStarved };

// Cycles by state: a request ends granted or stalled.
class PortCycles {
 public:
  void count(Intent intent, bool granted) {
    ++cycles_[granted ? kGranted : static_cast<std::size_t>(intent)];
  }

  std::uint64_t granted() const { return cycles_[kGranted]; }
  std::uint64_t stalled() const { return of(Intent::kRequest); }
  std::uint64_t passed() const { return of(Intent::kPass); }
  std::uint64_t idle() const { return of(Intent::kIdle); }
  std::uint64_t blocked() const { return of(Intent::kBlocked); }
  std::uint64_t starved() const { return of(Intent::kStarved); }
  std::uint64_t sum() const { return std::accumulate(cycles_.begin(), cycles_.end(), std::uint64_t{0}); }

 private:
  static constexpr std::size_t kGranted = 5;
  std::uint64_t of(Intent intent) const { return cycles_[static_cast<std::size_t>(intent)]; }

  std::array<std::uint64_t, 6> cycles_{};  // [intent], requests only while not granted
};

// A running count as it was some cycles ago: what entered in cycle c is seen from cycle c + latency on.
class DelayedCount {
 public:
  void start(int latency_cycles) {
    latency_ = latency_cycles;
    ends_ = {};
  }
  std::uint64_t seen() const { return ends_[static_cast<std::size_t>(latency_ - 1)]; }
  // `count`: at the end of this cycle.
  void end_of_cycle(std::uint64_t count) {
    ends_[1] = ends_[0];
    ends_[0] = count;
  }

 private:
  int latency_ = 1;                      // 1 or 2
  std::array<std::uint64_t, 2> ends_{};  // the count at the end of the last cycle, and of the one before
};

// One side of the core, from the sequence of slots to the matcher: which port asks for what in each cycle,
// and what follows from the grants. Plain C++: the single description of the lane's timing, whatever steps
// it.
//
// A cycle is decide() and ready(), then the arbitration, then commit().
class LaneControl {
 public:
  struct Decision {
    Intent lut = Intent::kIdle;
    Intent pixel = Intent::kIdle;
  };

  LaneControl(const FrameGeometry& geometry, bool has_table, int fifo_slots)
      : geometry_(geometry), has_table_(has_table), fifo_slots_(static_cast<std::uint64_t>(fifo_slots)) {}

  // Latencies of the banks that hold this frame's table and image.
  void start_frame(int table_latency_cycles, int image_latency_cycles) {
    cursor_ = SlotCursor(geometry_);
    taken_ = 0;
    handled_ = 0;
    consumed_ = 0;
    marks_ = 0;
    taken_seen_.start(has_table_ ? table_latency_cycles : 1);
    handled_seen_.start(image_latency_cycles);
  }

  Decision decide() const {
    if (!has_table_) return {Intent::kIdle, take_intent()};
    return {take_intent(), handle_intent()};
  }
  // Whether the matcher can consume a slot of this lane.
  bool ready() const { return handled_seen_.seen() > consumed_; }

  // `lut_granted`, `pixel_granted`: the request was granted. `entry_valid`: of the table entry that the LUT
  // port has just read; without effect otherwise. `consumes`: the matcher consumes a slot in this cycle.
  void commit(Decision decision, bool lut_granted, bool pixel_granted, bool entry_valid, bool consumes) {
    lut_cycles_.count(decision.lut, lut_granted);
    pixel_cycles_.count(decision.pixel, pixel_granted);
    const bool pixel_moves = pixel_granted || decision.pixel == Intent::kPass;
    bool takes = pixel_moves;
    if (has_table_) {
      takes = lut_granted || decision.lut == Intent::kPass;
      if (pixel_moves) marks_ >>= 1U;
      // The slots between the ports are those taken before this cycle and not handled by its end.
      const std::uint64_t between = taken_ - handled_ - std::uint64_t{pixel_moves};
      if (takes) marks_ |= std::uint64_t{lut_granted && entry_valid} << between;
    }
    if (takes) {
      cursor_.advance();
      ++taken_;
    }
    handled_ += std::uint64_t{pixel_moves};
    consumed_ += std::uint64_t{consumes};
    all_consumed_ += std::uint64_t{consumes};
    taken_seen_.end_of_cycle(taken_);
    handled_seen_.end_of_cycle(handled_);
  }

  const PortCycles& lut_cycles() const { return lut_cycles_; }
  const PortCycles& pixel_cycles() const { return pixel_cycles_; }
  std::uint64_t consumed() const { return all_consumed_; }  // slots, over all frames

 private:
  Intent take_intent() const {
    if (cursor_.done()) return Intent::kIdle;
    if (taken_ - consumed_ >= fifo_slots_) return Intent::kBlocked;
    return cursor_.empty() ? Intent::kPass : Intent::kRequest;
  }
  Intent handle_intent() const {
    if (taken_seen_.seen() > handled_) return (marks_ & 1U) != 0 ? Intent::kRequest : Intent::kPass;
    return taken_seen_.seen() == 0 || handled_ == geometry_.slots ? Intent::kIdle : Intent::kStarved;
  }

  FrameGeometry geometry_;
  bool has_table_;
  std::uint64_t fifo_slots_;
  SlotCursor cursor_;
  // Slots of this frame, until now.
  std::uint64_t taken_ = 0;
  std::uint64_t handled_ = 0;
  std::uint64_t consumed_ = 0;
  DelayedCount taken_seen_;    // by the pixel port
  DelayedCount handled_seen_;  // by the matcher
  std::uint64_t marks_ = 0;    // per slot taken and not yet handled, oldest lowest: needs an access
  PortCycles lut_cycles_;
  PortCycles pixel_cycles_;
  std::uint64_t all_consumed_ = 0;
};

}  // namespace stereotlm::fpga
