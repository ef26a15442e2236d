#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/lane_control.h"
#include "models/fpga/row_profile.h"
#include "models/memory/bank_arbiter.h"
#include "models/memory/memory_config.h"

namespace stereotlm::fpga {

// When the matcher consumes, and which consume-cycle completes a word of results.
class MatchControl {
 public:
  explicit MatchControl(const FrameGeometry& geometry) : geometry_(geometry) {}

  void start_frame() {
    slots_left_ = geometry_.slots;
    drain_left_ = geometry_.drain_cycles;
    k_ = 0;
    columns_ = 0;
  }
  // After the last slot the matcher runs on by the columns of the drain, which need no slots.
  bool draining() const { return slots_left_ == 0; }
  bool decide(bool slots_ready, bool result_queue_has_room) const {
    return result_queue_has_room && (draining() ? drain_left_ > 0 : slots_ready);
  }
  // One consume-cycle. True if it completes four columns, from column result_delay_columns % 4 on.
  bool consume() {
    --(draining() ? drain_left_ : slots_left_);
    if (++k_ < geometry_.slots_per_column) return false;
    k_ = 0;
    ++columns_;
    return (columns_ - geometry_.result_delay_columns) % 4 == 0;
  }
  // After consume() was true: whether the four columns complete a word of results. The column just consumed
  // is number columns_ - 1, so columns_ - result_delay_columns results have left.
  bool word_leaves() const { return columns_ > geometry_.result_delay_columns; }

  // Between two columns: the matcher's part of the state that determines the next cycles.
  std::uint64_t state() const {
    return std::uint64_t{columns_ >= geometry_.result_delay_columns} | std::uint64_t{draining()} << 1U;
  }
  std::uint64_t columns() const { return columns_; }
  // Words of results that have left in this frame.
  std::uint64_t words() const {
    return columns_ > geometry_.result_delay_columns ? (columns_ - geometry_.result_delay_columns) / 4 : 0;
  }
  // Between two columns: the number of columns up to the next change of state(), the last of them included.
  std::uint64_t uniform_columns() const {
    const auto slots_per_column = static_cast<std::uint64_t>(geometry_.slots_per_column);
    const std::uint64_t left = (draining() ? drain_left_ : slots_left_) / slots_per_column;
    if (columns_ >= geometry_.result_delay_columns) return left;
    return std::min(left, geometry_.result_delay_columns - columns_);
  }
  // Skips columns, at most uniform_columns().
  void skip_columns(std::uint64_t columns) {
    (draining() ? drain_left_ : slots_left_) -=
        columns * static_cast<std::uint64_t>(geometry_.slots_per_column);
    columns_ += columns;
  }
  // Consume-cycles to come.
  std::uint64_t cycles_left() const { return slots_left_ + drain_left_; }

 private:
  FrameGeometry geometry_;
  std::uint64_t slots_left_ = 0;
  std::uint64_t drain_left_ = 0;
  int k_ = 0;
  std::uint64_t columns_ = 0;  // consumed
};

// The queue of result words and the port that writes them.
class ResultControl {
 public:
  ResultControl(const FrameGeometry& geometry, int fifo_words)
      : words_per_frame_(geometry.result_words), fifo_words_(fifo_words) {}

  void start_frame() {
    queued_ = 0;
    written_ = 0;
  }
  bool has_room() const { return queued_ < fifo_words_; }
  bool frame_done() const { return written_ == words_per_frame_; }
  Intent decide() const {
    if (queued_ > 0) return Intent::kRequest;
    return written_ == 0 || frame_done() ? Intent::kIdle : Intent::kStarved;
  }
  void commit(Intent intent, bool granted, bool word_enters) {
    cycles_.count(intent, granted);
    queued_ += int{word_enters} - int{granted};
    written_ += std::uint64_t{granted};
    most_queued_ = std::max(most_queued_, queued_);
  }
  // Adds cycles that were skipped.
  void count(const PortCycles& cycles, std::uint64_t times) { cycles_.count(cycles, times); }

  std::uint64_t state() const {
    return static_cast<std::uint64_t>(queued_) | std::uint64_t{written_ != 0} << 8U;
  }
  // Skips cycles in which `words` words are written; they end in this state.
  void skip_to(std::uint64_t state, std::uint64_t words) {
    static_assert(kResultFifoRule.max <= 0xff);
    queued_ = static_cast<int>(state & 0xffU);
    written_ += words;
  }

  // Words of this frame.
  std::uint64_t words_written() const { return written_; }
  std::uint64_t words_left() const { return words_per_frame_ - written_; }
  // The most words queued at one time, over all frames.
  int most_queued() const { return most_queued_; }
  const PortCycles& cycles() const { return cycles_; }

 private:
  std::uint64_t words_per_frame_;
  int fifo_words_;
  int queued_ = 0;
  std::uint64_t written_ = 0;
  int most_queued_ = 0;
  PortCycles cycles_;
};

// Read latencies, in cycles, of the banks that hold the buffers of a frame.
struct FrameLatencies {
  int left_lut = 2;
  int right_lut = 2;
  int left_image = 2;
  int right_image = 2;
};

// The timing of the whole core (contract section 2): what every port requests in a cycle, and what follows
// from the grants. Plain C++ without data and without SystemC, so that the core's process and run_core() step
// the same object.
//
// A cycle is decide(), then the arbitration of the ports that request, then commit().
class CoreControl {
 public:
  struct Decision {
    LaneControl::Decision left;
    LaneControl::Decision right;
    Intent result = Intent::kIdle;
    bool consume = false;  // the matcher consumes a slot of both lanes, or a cycle of the drain
    bool drain = false;

    memory::PortMask requests() const { return ports_that(Intent::kRequest); }
    memory::PortMask passes() const { return ports_that(Intent::kPass); }

   private:
    memory::PortMask ports_that(Intent intent) const {
      using memory::index_of;
      using memory::Port;
      return static_cast<memory::PortMask>(unsigned{left.lut == intent} << index_of(Port::kLeftLut) |
                                           unsigned{right.lut == intent} << index_of(Port::kRightLut) |
                                           unsigned{left.pixel == intent} << index_of(Port::kLeftPixel) |
                                           unsigned{right.pixel == intent} << index_of(Port::kRightPixel) |
                                           unsigned{result == intent} << index_of(Port::kResult));
    }
  };

  // Throws std::invalid_argument if the configuration has problems.
  explicit CoreControl(const CoreConfig& config);

  void start_frame(const FrameLatencies& latencies);
  Decision decide() const;
  // `*_entry_valid`: whether the table entry is valid that the side's LUT port has read in this cycle.
  // Returns true if the matcher has completed a group of four columns, counted from result_delay_columns % 4
  // on.
  bool commit(const Decision& decision, memory::PortMask granted, bool left_entry_valid,
              bool right_entry_valid);
  // Counts the cycle of the host port, which is not the core's own.
  void count_host(bool requested, bool granted, std::uint64_t cycles = 1) {
    host_cycles_.count(requested ? Intent::kRequest : Intent::kIdle, granted, cycles);
  }
  // Corrects cycles that are counted as idle, before or later: the host requested an uncontended bank in
  // them.
  void host_was_busy(bool granted, std::uint64_t cycles) {
    host_cycles_.count(Intent::kIdle, false, ~cycles + 1);  // may become negative until they are counted
    count_host(true, granted, cycles);
  }
  // Cycles of the core's own ports, over all frames.
  using Counts = std::array<PortCycles, kCorePortCount>;
  Counts counts() const;
  static Counts difference(const Counts& after, const Counts& before);
  // Adds cycles that were skipped.
  void count(const Counts& counts, std::uint64_t times);

  // After a group of four columns: the state that determines the next cycles, together with the arbiters'
  // state and the slots not yet taken.
  struct State {
    LaneControl::State left;
    LaneControl::State right;
    std::uint64_t rest = 0;

    friend bool operator==(const State& a, const State& b) {
      return a.left == b.left && a.right == b.right && a.rest == b.rest;
    }
  };
  State state() const { return {left_.state(), right_.state(), match_.state() | result_.state() << 8U}; }
  // Skips cycles in which the matcher consumes `columns` columns, at most uniform_columns(), and `words`
  // words of results are written; lanes and result queue end in this state.
  void skip_to(const State& state, std::uint64_t columns, std::uint64_t words);
  const MatchControl& match() const { return match_; }
  const ResultControl& result() const { return result_; }
  // The last word of the frame has been written.
  bool frame_done() const { return result_.frame_done(); }

  const FrameGeometry& geometry() const { return geometry_; }
  // Counts over all frames, of the cycles from the start of each frame to its last write.
  const PortCycles& port_cycles(memory::Port port) const;
  LaneControl& left() { return left_; }
  LaneControl& right() { return right_; }
  const LaneControl& left() const { return left_; }
  const LaneControl& right() const { return right_; }

 private:
  FrameGeometry geometry_;
  LaneControl left_;
  LaneControl right_;
  MatchControl match_;
  ResultControl result_;
  PortCycles host_cycles_;
};

inline CoreControl::Decision CoreControl::decide() const {
  return {left_.decide(), right_.decide(), result_.decide(),
          match_.decide(left_.ready() && right_.ready(), result_.has_room()), match_.draining()};
}

inline bool CoreControl::commit(const Decision& decision, memory::PortMask granted, bool left_entry_valid,
                                bool right_entry_valid) {
  using memory::Port;
  const auto is_granted = [granted](Port port) { return (granted & memory::mask_of(port)) != 0; };
  const bool consumes_slot = decision.consume && !decision.drain;
  left_.commit(decision.left, is_granted(Port::kLeftLut), is_granted(Port::kLeftPixel), left_entry_valid,
               consumes_slot);
  right_.commit(decision.right, is_granted(Port::kRightLut), is_granted(Port::kRightPixel), right_entry_valid,
                consumes_slot);
  const bool four_columns = decision.consume && match_.consume();
  result_.commit(decision.result, is_granted(Port::kResult), four_columns && match_.word_leaves());
  return four_columns;
}

}  // namespace stereotlm::fpga
