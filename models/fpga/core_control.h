#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/lane_control.h"
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
  // One consume-cycle. True if it completes a word of results.
  bool consume() {
    --(draining() ? drain_left_ : slots_left_);
    if (++k_ < geometry_.slots_per_column) return false;
    k_ = 0;
    ++columns_;
    // The column just consumed is number columns_ - 1, so this many results have left.
    return columns_ > geometry_.result_delay_columns && (columns_ - geometry_.result_delay_columns) % 4 == 0;
  }

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
  }
  const PortCycles& cycles() const { return cycles_; }

 private:
  std::uint64_t words_per_frame_;
  int fifo_words_;
  int queued_ = 0;
  std::uint64_t written_ = 0;
  PortCycles cycles_;
};

// Read latencies, in cycles, of the banks that hold the buffers of a frame.
struct FrameLatencies {
  int left_lut = 2;
  int right_lut = 2;
  int left_image = 2;
  int right_image = 2;
};

// The timing of the whole core (contract section 2): what every port asks for in a cycle and what follows
// from the grants. Plain C++, no data, no SystemC: stepped by the core's process, and by whatever else needs
// the same cycles.
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
  // `*_entry_valid`: of the table entry that the side's LUT port has read in this cycle.
  void commit(const Decision& decision, memory::PortMask granted, bool left_entry_valid,
              bool right_entry_valid);
  // The host port is not the core's own: what it did in this cycle is counted here beside the others.
  void count_host(bool requested, bool granted) {
    host_cycles_.count(requested ? Intent::kRequest : Intent::kIdle, granted);
  }
  // The last word of the frame has been written.
  bool frame_done() const { return result_.frame_done(); }

  const FrameGeometry& geometry() const { return geometry_; }
  // Over all frames, for the cycles from the start of each to its last write.
  const PortCycles& port_cycles(memory::Port port) const;
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

inline void CoreControl::commit(const Decision& decision, memory::PortMask granted, bool left_entry_valid,
                                bool right_entry_valid) {
  using memory::Port;
  const auto is_granted = [granted](Port port) { return (granted & memory::mask_of(port)) != 0; };
  const bool consumes_slot = decision.consume && !decision.drain;
  left_.commit(decision.left, is_granted(Port::kLeftLut), is_granted(Port::kLeftPixel), left_entry_valid,
               consumes_slot);
  right_.commit(decision.right, is_granted(Port::kRightLut), is_granted(Port::kRightPixel), right_entry_valid,
                consumes_slot);
  const bool word_enters = decision.consume && match_.consume();
  result_.commit(decision.result, is_granted(Port::kResult), word_enters);
}

}  // namespace stereotlm::fpga
