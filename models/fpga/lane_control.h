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

// Slots under way: one that enters in cycle c is available from cycle c + latency on. `enter` and `leave`
// take effect at end_of_cycle().
class LatencyQueue {
 public:
  void start(int latency_cycles) {
    latency_ = latency_cycles;
    available_ = 0;
    under_way_ = 0;
    entering_ = 0;
    leaving_ = 0;
  }
  int available() const { return available_; }
  void enter() { entering_ = 1; }
  void leave() { leaving_ = 1; }
  void end_of_cycle() {
    under_way_ = under_way_ << 1U | entering_;
    available_ += static_cast<int>(under_way_ >> (latency_ - 1) & 1U) - leaving_;
    entering_ = 0;
    leaving_ = 0;
  }

 private:
  int latency_ = 1;
  int available_ = 0;
  std::uint32_t under_way_ = 0;  // bit i: one entered i cycles before the last
  std::uint32_t entering_ = 0;
  int leaving_ = 0;
};

// One side of the core, from the sequence of slots to the matcher: which port asks for what in each cycle,
// and what follows from the grants. Plain C++: the single description of the lane's timing, whatever steps
// it.
//
// A cycle is decide(), then the arbitration, then commit() and perhaps consume() in any order, then
// end_of_cycle().
class LaneControl {
 public:
  struct Decision {
    Intent lut = Intent::kIdle;
    Intent pixel = Intent::kIdle;
  };

  LaneControl(const FrameGeometry& geometry, bool has_table, int fifo_slots)
      : geometry_(geometry), has_table_(has_table), fifo_slots_(fifo_slots) {}

  // Latencies of the banks that hold this frame's table and image.
  void start_frame(int table_latency_cycles, int image_latency_cycles) {
    cursor_ = SlotCursor(geometry_);
    in_lane_ = 0;
    marks_ = 0;
    marked_ = 0;
    handled_ = 0;
    pixel_began_ = false;
    taken_.start(has_table_ ? table_latency_cycles : 1);
    handled_queue_.start(image_latency_cycles);
  }

  Decision decide() const {
    if (!has_table_) return {Intent::kIdle, take_intent()};
    return {take_intent(), handle_intent()};
  }

  // `lut_granted`, `pixel_granted`: the request was granted. `entry_valid`: of the table entry that the LUT
  // port has just read; without effect otherwise.
  void commit(Decision decision, bool lut_granted, bool pixel_granted, bool entry_valid) {
    lut_cycles_.count(decision.lut, lut_granted);
    pixel_cycles_.count(decision.pixel, pixel_granted);
    const bool pixel_moves = pixel_granted || decision.pixel == Intent::kPass;
    if (!has_table_) {
      if (pixel_moves) {
        take();
        handled_queue_.enter();
      }
      return;
    }
    if (pixel_moves) {
      marks_ >>= 1U;
      --marked_;
      ++handled_;
      taken_.leave();
      handled_queue_.enter();
    }
    if (lut_granted || decision.lut == Intent::kPass) {
      const bool needs_access = lut_granted && entry_valid;
      marks_ |= std::uint64_t{needs_access} << marked_;
      ++marked_;
      take();
      taken_.enter();
    }
  }

  // Whether the matcher can consume a slot of this lane.
  bool ready() const { return handled_queue_.available() > 0; }
  // The matcher consumes one in this cycle.
  void consume() {
    handled_queue_.leave();
    ++consumed_;
    consuming_ = 1;
  }

  void end_of_cycle() {
    taken_.end_of_cycle();
    handled_queue_.end_of_cycle();
    in_lane_ -= consuming_;
    consuming_ = 0;
    pixel_began_ = pixel_began_ || taken_.available() > 0;
  }

  const PortCycles& lut_cycles() const { return lut_cycles_; }
  const PortCycles& pixel_cycles() const { return pixel_cycles_; }
  std::uint64_t consumed() const { return consumed_; }  // slots, over all frames

 private:
  Intent take_intent() const {
    if (cursor_.done()) return Intent::kIdle;
    if (in_lane_ >= fifo_slots_) return Intent::kBlocked;
    return cursor_.empty() ? Intent::kPass : Intent::kRequest;
  }
  Intent handle_intent() const {
    if (taken_.available() == 0) {
      return pixel_began_ && handled_ < geometry_.slots ? Intent::kStarved : Intent::kIdle;
    }
    return (marks_ & 1U) != 0 ? Intent::kRequest : Intent::kPass;
  }
  void take() {
    cursor_.advance();
    ++in_lane_;
  }

  FrameGeometry geometry_;
  bool has_table_;
  int fifo_slots_;
  SlotCursor cursor_;
  int in_lane_ = 0;  // taken and not yet consumed
  int consuming_ = 0;
  LatencyQueue taken_;
  std::uint64_t marks_ =
      0;  // of the slots taken and not yet handled, oldest lowest: whether it needs an access
  int marked_ = 0;
  std::uint64_t handled_ = 0;
  bool pixel_began_ = false;
  LatencyQueue handled_queue_;
  PortCycles lut_cycles_;
  PortCycles pixel_cycles_;
  std::uint64_t consumed_ = 0;
};

}  // namespace stereotlm::fpga
