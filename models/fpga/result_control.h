#pragma once

#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/port_cycles.h"

namespace stereotlm::fpga {

// Decides the timing of the queue of result words, and of the port that writes them. A word enters the queue
// `result_delay_cycles` after its consume-cycle, and is on its way until then (contract 7.11).
class ResultControl {
 public:
  ResultControl(const FrameGeometry& geometry, int fifo_words)
      : words_per_frame_(geometry.result_words),
        words_of_whole_strips_((geometry.last_strip_column - geometry.result_delay_columns) / 4 *
                               static_cast<std::uint64_t>(geometry.rows)),
        rows_(geometry.rows),
        last_rows_(geometry.last_rows),
        delay_(geometry.result_delay_cycles),
        most_before_work_(fifo_words - geometry.rows) {}

  void start_frame() {
    queued_ = 0;
    coming_ = 0;
    arrivals_ = 0;
    written_ = 0;
  }
  // Whether the matcher may begin: the queue has a place for a word of each row of a strip, beside the words
  // that are in it or on their way.
  bool has_room() const { return queued_ + coming_ <= most_before_work_; }
  bool frame_done() const { return written_ == words_per_frame_; }
  Intent decide() const {
    if (queued_ > 0) return Intent::kRequest;
    return written_ == 0 || frame_done() ? Intent::kIdle : Intent::kStarved;
  }
  // `words_leaving`: the words that the matcher completes in this cycle.
  void commit(bool granted, int words_leaving) {
    int entering = words_leaving;
    if (delay_ != 0) {
      // A group of words has an arrival. Those of the last strip may be fewer.
      const bool is_whole = written_ + static_cast<std::uint64_t>(queued_) < words_of_whole_strips_;
      entering = (arrivals_ & 1U) == 0 ? 0 : is_whole ? rows_ : last_rows_;
      arrivals_ = arrivals_ >> 1U | std::uint64_t{words_leaving != 0} << static_cast<unsigned>(delay_ - 1);
      coming_ += words_leaving - entering;
    }
    queued_ += entering - int{granted};
    written_ += std::uint64_t{granted};
  }
  // The number of cycles, from the next one on, in which no word enters the queue.
  std::uint64_t cycles_to_arrival() const {
    return arrivals_ == 0 ? UINT64_MAX : static_cast<std::uint64_t>(__builtin_ctzll(arrivals_));
  }
  // Skips `cycles` of these cycles, in which no word is written and none leaves the matcher.
  void skip_waiting(std::uint64_t cycles) {
    if (arrivals_ != 0) arrivals_ >>= cycles;
  }

  std::uint64_t state() const {
    return static_cast<std::uint64_t>(queued_) | std::uint64_t{written_ != 0} << 8U |
           static_cast<std::uint64_t>(coming_) << kComingBit;
  }
  // The other part of the state. Bit 0 is 1 if words enter the queue at the end of the next cycle, bit 1 for
  // the cycle after that, and so on.
  std::uint64_t arrivals() const { return arrivals_; }
  // Skips the cycles in which `words` words are written. The queue is in `state` afterwards.
  void set_state(std::uint64_t state, std::uint64_t arrivals, std::uint64_t words) {
    static_assert(kResultFifoRule.max <= 0xff && kResultDelayRule.max <= 64);
    queued_ = static_cast<int>(state & 0xffU);
    coming_ = static_cast<int>(state >> kComingBit);
    arrivals_ = arrivals;
    written_ += words;
  }

  int queued() const { return queued_; }                                    // words in the queue
  int delay() const { return delay_; }                                      // cycles, Q of contract 7.11
  std::uint64_t words_written() const { return written_; }                  // of the frame
  std::uint64_t words_left() const { return words_per_frame_ - written_; }  // of the frame

 private:
  static constexpr unsigned kComingBit = 9;

  std::uint64_t words_per_frame_;
  std::uint64_t words_of_whole_strips_;  // of all strips but the last
  int rows_;
  int last_rows_;
  int delay_;
  int most_before_work_;  // words beside which there is room
  int queued_ = 0;
  int coming_ = 0;              // words on their way
  std::uint64_t arrivals_ = 0;  // see arrivals()
  std::uint64_t written_ = 0;
};

}  // namespace stereotlm::fpga
