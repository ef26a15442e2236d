#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/capture/camera_timing.h"
#include "models/capture/capture_config.h"
#include "models/capture/capture_observer.h"
#include "models/checked.h"
#include "models/clock.h"
#include "models/kernels/words.h"
#include "models/pci/pci_slot.h"
#include "models/time_ps.h"

namespace stereotlm::capture {

// Consecutive words of a frame, also over ends of lines. Word 0 has the frame's first pixels.
struct FrameWords {
  int first = 0;  // number of the first word in the frame
  int count = 0;  // words
};

// Computes which words the FIFO of a CaptureBoard holds at each time, and when it requests the bus (contract
// section 3, "Capture board"). The times of all pixels are known in advance, so the state is computed only
// when it is needed. The FIFO stores no pixels. Plain C++.
//
// A word enters the FIFO with its first pixel, and is complete when its last pixel has arrived. A pixel that
// needs a new word is dropped, with the rest of its line, if the FIFO holds `fifo_words` words when the pixel
// arrives. A word that leaves at that very time makes room for the pixel. The FIFO requests the bus
// - when it holds `fifo_trigger_words` complete words,
// - when it holds words at the end of a line, which is the arrival time of the line's last pixel,
// - while it holds words that were complete at an earlier grant.
//
// Times are absolute, in ps, and never decrease from call to call.
class CaptureFifo {
 public:
  // Throws std::invalid_argument if the configuration has problems.
  explicit CaptureFifo(const CaptureBoardConfig& config)
      : fifo_words_(checked("capture", config).fifo_words), trigger_words_(config.fifo_trigger_words) {}

  // `observer` outlives the FIFO. Copies of the FIFO report to it too.
  void observe(FifoObserver& observer) { observer_ = &observer; }

  // The FIFO must be empty. `timing` outlives the frame.
  void begin_frame(const CameraTiming& timing, std::uint64_t begin_ps) {
    timing_ = &timing;
    begin_ps_ = begin_ps;
    now_ps_ = begin_ps;
    words_per_line_ = timing.width() / kernels::kPixelsPerWord;
    begin_line(0);
  }
  // Advances the FIFO to `now_ps`: pixels have arrived up to then, and no word has left.
  void advance(std::uint64_t now_ps) {
    take(now_ps, [](std::uint64_t /*time_ps*/) { return 0; });
  }
  // The bus is granted at the time of the last advance(). Returns the complete words, as far as their
  // addresses are contiguous. They stay in the FIFO until transfer() or lose().
  FrameWords grant() {
    owed_ = complete_words();
    return {ranges_.front().first, std::min(ranges_.front().count, owed_)};
  }
  // The burst of the last grant ends at `now_ps`. The words transferred have left, each at the end of its
  // clock.
  void transfer(std::uint64_t now_ps, const pci::BurstResult& transferred, const Clock& clock) {
    take(now_ps, [&](std::uint64_t time_ps) {
      const std::uint64_t running_clock = clock.edge_at_or_after(time_ps + 1) - 1;
      return static_cast<int>(transferred.words_before(running_clock));
    });
    remove(static_cast<int>(transferred.words));
    if (observer_ == nullptr) return;
    for (std::size_t left = 0; left < transferred.words; left += transferred.words_per_clock) {
      const std::uint64_t data_clock = transferred.first_data_clock + left / transferred.words_per_clock;
      observer_->words_left(clock.edge_ps(data_clock + 1), transferred.words_before(data_clock + 1) - left);
    }
  }
  // The burst of the last grant ends at `now_ps`, when all its `words` words leave.
  void lose(std::uint64_t now_ps, int words) {
    take(now_ps, [=](std::uint64_t time_ps) { return time_ps < now_ps ? 0 : words; });
    remove(words);
    if (observer_ != nullptr) observer_->words_left(now_ps, static_cast<std::size_t>(words));
  }

  // The following functions give the state at the time of the last advance(), transfer() or lose().

  std::uint64_t now_ps() const { return now_ps_; }  // the time of that call
  // Returns the time at which the FIFO requests the bus or the frame finishes; the present if that time has
  // passed. Not to be called while a burst runs.
  std::uint64_t next_ps() const {
    const bool line_has_ended = line_end_ps_ <= now_ps_;
    if (occupancy_ > 0) {
      const bool holds_ended_line = line_has_ended || ranges_.front().first < first_word_;
      if (owed_ > 0 || holds_ended_line || complete_words() >= trigger_words_) return now_ps_;
    } else if (line_has_ended || drops_line_) {
      // Nothing happens before the next line, which finds the FIFO empty.
      if (next_line_ps_ == kNever) return std::max(now_ps_, line_end_ps_);
      return first_request_ps(row_ + 1);
    }
    // Below the trigger, all words are of the arriving line, and none of its next words finds the FIFO full.
    const int triggering = taken_ + trigger_words_ - occupancy_;
    return drops_line_ || triggering >= words_per_line_
               ? line_end_ps_
               : arrival_ps(triggering * kernels::kPixelsPerWord - 1, row_);
  }
  // The number of words in the FIFO that are complete.
  // Only the last word of the arriving line can be incomplete.
  int complete_words() const { return occupancy_ - (taken_ * kernels::kPixelsPerWord > pixels_ ? 1 : 0); }
  // Whether the frame finishes at next_ps(), without a further request.
  bool finishes_next() const { return occupancy_ == 0 && next_line_ps_ == kNever && takes_no_more(); }

  // The number of pixels dropped in all frames. A pixel is counted when it arrives.
  std::uint64_t dropped_pixels() const {
    return drops_line_ ? dropped_pixels_ - static_cast<std::uint64_t>(timing_->width() - pixels_)
                       : dropped_pixels_;
  }

 private:
  // Advances to `now_ps`. `left_by(time_ps)`: how many words of the last grant have left by a time.
  template <class LeftBy>
  void take(std::uint64_t now_ps, const LeftBy& left_by) {
    now_ps_ = now_ps;
    for (;; begin_line(row_ + 1)) {
      pixels_ = line_end_ps_ <= now_ps ? timing_->width() : timing_->pixels_by(row_, now_ps - begin_ps_);
      take_words((pixels_ + kernels::kPixelsPerWord - 1) / kernels::kPixelsPerWord, left_by);
      if (observer_ != nullptr) show_words();
      if (now_ps < next_line_ps_) return;
    }
  }
  // Takes the words of the arriving line up to word `end`, while there is room.
  template <class LeftBy>
  void take_words(int end, const LeftBy& left_by) {
    if (drops_line_) return;
    // No word before this one can find the FIFO full, even if no word leaves.
    int word = std::min(end, taken_ + std::max(0, fifo_words_ - occupancy_));
    const auto finds_it_full = [&] {
      return occupancy_ + (word - taken_) - left_by(arrival_ps(word * kernels::kPixelsPerWord, row_)) >=
             fifo_words_;
    };
    while (word < end && !finds_it_full()) ++word;
    append(word - taken_);
    if (word == end) return;
    drops_line_ = true;
    dropped_pixels_ += static_cast<std::uint64_t>(timing_->width() - word * kernels::kPixelsPerWord);
  }
  // The next words of the arriving line enter.
  void append(int words) {
    if (words == 0) return;
    const int first = first_word_ + taken_;
    if (ranges_.empty() || ranges_.back().first + ranges_.back().count != first)
      ranges_.push_back({first, 0});
    ranges_.back().count += words;
    taken_ += words;
    occupancy_ += words;
  }
  // Words of the oldest range leave.
  void remove(int words) {
    if (words == 0) return;
    FrameWords& range = ranges_.front();
    range.first += words;
    range.count -= words;
    occupancy_ -= words;
    owed_ -= words;
    if (range.count == 0) ranges_.erase(ranges_.begin());
  }
  void begin_line(int row) {
    row_ = row;
    first_word_ = row * words_per_line_;
    line_end_ps_ = arrival_ps(timing_->width() - 1, row);
    next_line_ps_ = row + 1 < timing_->height() ? arrival_ps(0, row + 1) : kNever;
    pixels_ = 0;
    taken_ = shown_ = 0;
    drops_line_ = false;
  }
  void show_words() {
    for (; shown_ < std::min(taken_, pixels_ / kernels::kPixelsPerWord); ++shown_)
      observer_->word_came(arrival_ps((shown_ + 1) * kernels::kPixelsPerWord - 1, row_));
  }
  bool takes_no_more() const { return drops_line_ || taken_ == words_per_line_; }
  // The time of the first request in a line, if the line finds the FIFO empty.
  std::uint64_t first_request_ps(int row) const {
    return arrival_ps(std::min(trigger_words_, words_per_line_) * kernels::kPixelsPerWord - 1, row);
  }
  std::uint64_t arrival_ps(int column, int row) const { return begin_ps_ + timing_->pixel_ps(column, row); }

  int fifo_words_;
  int trigger_words_;
  FifoObserver* observer_ = nullptr;
  const CameraTiming* timing_ = nullptr;
  std::uint64_t begin_ps_ = 0;
  std::uint64_t now_ps_ = 0;
  int words_per_line_ = 0;

  // The arriving line; between two lines, the last one.
  int row_ = 0;
  int first_word_ = 0;                // its first word in the frame
  std::uint64_t line_end_ps_ = 0;     // its last pixel arrives
  std::uint64_t next_line_ps_ = 0;    // the first pixel of the next line arrives; kNever: no next line
  int pixels_ = 0;                    // how many of its pixels have arrived
  int taken_ = 0;                     // how many of its words have entered the FIFO
  int shown_ = 0;                     // how many of its words the observer has received
  bool drops_line_ = false;           // its other words are dropped
  std::uint64_t dropped_pixels_ = 0;  // pixels dropped up to the end of the line

  int owed_ = 0;  // number of the oldest words that were complete at the last grant and have not left
  // The words in the FIFO, oldest first. A new range begins behind words that were dropped.
  std::vector<FrameWords> ranges_;
  int occupancy_ = 0;  // number of words in the FIFO, complete or being filled
};

}  // namespace stereotlm::capture
