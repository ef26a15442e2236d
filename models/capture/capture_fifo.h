#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/capture/camera_timing.h"
#include "models/capture/capture_config.h"
#include "models/capture/capture_observer.h"
#include "models/clock.h"
#include "models/kernels/words.h"
#include "models/pci/pci_slot.h"
#include "models/time_ps.h"

namespace stereotlm::capture {

// Consecutive words of a frame, also over ends of lines. Word 0 has the frame's first pixels.
struct FrameWords {
  int first = 0;
  int count = 0;
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
  explicit CaptureFifo(const CaptureBoardConfig& config);

  // `observer` outlives the FIFO. Copies of the FIFO report to it too.
  void observe(FifoObserver& observer) { observer_ = &observer; }

  // The FIFO must be empty. `timing` outlives the frame.
  void begin_frame(const CameraTiming& timing, std::uint64_t begin_ps);
  // Advances the FIFO to `now_ps`: pixels have arrived up to then, and no word has left.
  void advance(std::uint64_t now_ps);
  // The bus is granted at the time of the last advance(). Returns the complete words, as far as their
  // addresses are contiguous. They stay in the FIFO until transfer() or lose().
  FrameWords grant();
  // The burst of the last grant ends at `now_ps`. The words transferred have left, each at the end of its
  // clock.
  void transfer(std::uint64_t now_ps, const pci::BurstResult& transferred, const Clock& clock);
  // The burst of the last grant ends at `now_ps`, when all its `words` words leave.
  void lose(std::uint64_t now_ps, int words);

  // The following functions give the state at the time of the last advance(), transfer() or lose().

  std::uint64_t now_ps() const { return now_ps_; }
  // Returns the time at which the FIFO requests the bus or the frame finishes; the present if that time has
  // passed. Not to be called while a burst runs.
  std::uint64_t next_ps() const;
  // The number of words in the FIFO that are complete.
  int complete_words() const;
  // Whether the frame finishes at next_ps(), without a further request.
  bool finishes_next() const { return occupancy_ == 0 && next_line_ps_ == kNever && takes_no_more(); }
  // To skip lines that repeat:
  //
  // Whether a line can be skipped: no word of the lines up to now is to come or to leave, and a line comes,
  // which is next_row().
  bool is_between_lines() const { return occupancy_ == 0 && takes_no_more() && next_line_ps_ != kNever; }
  int next_row() const { return row_ + 1; }
  bool has_row(int row) const { return row < timing_->height(); }
  int words_per_line() const { return words_per_line_; }
  // The time of the first request in a line, if the line finds the FIFO empty.
  std::uint64_t first_request_ps(int row) const {
    return arrival_ps(std::min(trigger_words_, words_per_line_) * kernels::kPixelsPerWord - 1, row);
  }
  // From `first_ps` on, and before `end_ps`, as many words have begun, and are complete, as at `time_ps`.
  // Some of this row's pixels have arrived then, but none of the next row's, which exists.
  struct Span {
    std::uint64_t first_ps = 0;
    std::uint64_t end_ps = 0;
  };
  Span same_words(int row, std::uint64_t time_ps) const;
  // The number of times that a word needed a check for a free place.
  std::uint64_t full_checks() const { return full_checks_; }
  // The next line has come, and all its words have entered and left, the last of them at `now_ps`.
  void skip_line(std::uint64_t now_ps);

  // The number of pixels dropped in all frames. A pixel is counted when it arrives.
  std::uint64_t dropped_pixels() const;

 private:
  // Advances to `now_ps`. `left_by(time_ps)`: how many words of the last grant have left by a time.
  template <class LeftBy>
  void take(std::uint64_t now_ps, const LeftBy& left_by);
  // Takes the words of the arriving line up to word `end`, while there is room.
  template <class LeftBy>
  void take_words(int end, const LeftBy& left_by);
  void append(int words);
  void remove(int words);
  void begin_line(int row);
  void show_words();
  bool takes_no_more() const { return drops_line_ || taken_ == words_per_line_; }
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

  // The words in the FIFO, oldest first: a ring of ranges. A new range begins behind words that were dropped.
  std::vector<FrameWords> ranges_;
  std::size_t oldest_ = 0;
  std::size_t newest_ = 0;
  int occupancy_ = 0;  // number of words in the FIFO, complete or being filled
  std::uint64_t full_checks_ = 0;
  int owed_ = 0;  // number of the oldest words that were complete at the last grant and have not left
};

}  // namespace stereotlm::capture
