#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "models/capture/camera_timing.h"
#include "models/capture/capture_config.h"

namespace stereotlm::capture {

// Consecutive words of one line.
struct LineWords {
  int row = 0;
  int first = 0;  // number of the first word in its line
  int count = 0;
};

// Computes which words the FIFO of a CaptureBoard holds at each time, and when it requests the bus (contract
// section 3, "Capture board"). The times of all pixels are known in advance, so the state is computed only
// when it is needed. The FIFO stores no pixels. No SystemC.
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
  // Returns how many words of the last grant have left by a time.
  using LeftBy = std::function<int(std::uint64_t time_ps)>;

  // Throws std::invalid_argument if the configuration has problems.
  explicit CaptureFifo(const CaptureBoardConfig& config);

  // The FIFO must be empty. `timing` outlives the frame.
  void begin_frame(const CameraTiming& timing, std::uint64_t begin_ps);
  // Advances the FIFO to `now_ps`: pixels have arrived up to then, and no word has left.
  void advance(std::uint64_t now_ps);
  // The bus is granted at the time of the last advance(). Fills `burst` with the complete words, as far as
  // their addresses are contiguous, and returns their number. These words stay in the FIFO until leave().
  int grant(std::vector<LineWords>& burst);
  // The burst ends at `now_ps`. Its first `words` words have left, at the times given by `left_by`.
  void leave(std::uint64_t now_ps, int words, const LeftBy& left_by);

  // The following functions give the state at the time of the last advance() or leave().

  // Returns the time at which the FIFO requests the bus or the frame finishes; the present if that time has
  // passed. Returns nothing if the time depends on the next line. Not to be called while a burst runs.
  std::optional<std::uint64_t> next_ps() const;
  // Whether the frame finishes at next_ps(), without a further request.
  bool finishes_next() const { return occupancy_ == 0 && word_ == words_per_line_; }
  std::uint64_t words_per_line() const { return static_cast<std::uint64_t>(words_per_line_); }
  // Whether all pixels have arrived, and all words have left or been dropped.
  bool finished() const;
  // The number of pixels dropped in all frames. A pixel is counted when it arrives.
  std::uint64_t dropped_pixels() const;

 private:
  // Advances to `now_ps`. `left_by`: null if no word has left.
  void take(std::uint64_t now_ps, const LeftBy* left_by);
  // Takes the words of the arriving line up to word `end`, while there is room.
  void take_words(int end, const LeftBy* left_by);
  std::uint64_t arrival_ps(int column, int row) const { return begin_ps_ + timing_->pixel_ps(column, row); }
  std::uint64_t line_end_ps(int row) const { return arrival_ps(timing_->width() - 1, row); }
  int complete_words() const;

  int fifo_words_;
  int trigger_words_;
  const CameraTiming* timing_ = nullptr;
  std::uint64_t begin_ps_ = 0;
  std::uint64_t now_ps_ = 0;
  int words_per_line_ = 0;
  int row_ = 0;                  // the arriving line; between two lines, the last one
  int word_ = 0;                 // next word of that line to begin; words_per_line_ if the rest is dropped
  std::deque<LineWords> lines_;  // words in the FIFO, oldest first, one entry per line
  int occupancy_ = 0;            // number of words in the FIFO, complete or being filled
  int owed_ = 0;  // number of the oldest words that were complete at the last grant and have not left
  bool drops_line_ = false;           // the rest of the arriving line is dropped
  std::uint64_t dropped_pixels_ = 0;  // pixels dropped up to the end of the arriving line
};

}  // namespace stereotlm::capture
