#pragma once

#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/port_cycles.h"

namespace stereotlm::fpga {

// Decides the timing of the queue of result words, and of the port that writes them.
class ResultControl {
 public:
  ResultControl(const FrameGeometry& geometry, int fifo_words)
      : words_per_frame_(geometry.result_words), most_before_work_(fifo_words - geometry.rows) {}

  void start_frame() {
    queued_ = 0;
    written_ = 0;
  }
  // Whether the matcher may begin: the queue has a place for a word of each row of a strip.
  bool has_room() const { return queued_ <= most_before_work_; }
  bool frame_done() const { return written_ == words_per_frame_; }
  Intent decide() const {
    if (queued_ > 0) return Intent::kRequest;
    return written_ == 0 || frame_done() ? Intent::kIdle : Intent::kStarved;
  }
  void commit(bool granted, int words_entering) {
    queued_ += words_entering - int{granted};
    written_ += std::uint64_t{granted};
  }

  std::uint64_t state() const {
    return static_cast<std::uint64_t>(queued_) | std::uint64_t{written_ != 0} << 8U;
  }
  // Skips the cycles in which `words` words are written. The queue is in `state` afterwards.
  void set_state(std::uint64_t state, std::uint64_t words) {
    static_assert(kResultFifoRule.max <= 0xff);
    queued_ = static_cast<int>(state & 0xffU);
    written_ += words;
  }

  int queued() const { return queued_; }                                    // words in the queue
  std::uint64_t words_written() const { return written_; }                  // of the frame
  std::uint64_t words_left() const { return words_per_frame_ - written_; }  // of the frame

 private:
  std::uint64_t words_per_frame_;
  int most_before_work_;  // words in the queue beside which there is room
  int queued_ = 0;
  std::uint64_t written_ = 0;
};

}  // namespace stereotlm::fpga
