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
  int first = 0;  // word of the line
  int count = 0;
};

// What is in the FIFO of a capture board at which time, and when it asks for the bus (contract section 3,
// "Capture board"): the timing of the pixels is known, so the state is computed only when somebody asks. No
// SystemC, no pixels.
//
// A word enters with its first pixel and is complete when its last has arrived. A pixel that needs a new word
// is dropped, and with it the rest of its line, if `fifo_words` words are in the FIFO at its arrival; a word
// that leaves at that very time has left. The FIFO asks when `fifo_trigger_words` complete words are in it,
// when a line has ended (its last pixel has arrived, or would have) and words are in it, and as long as words
// are in it that were complete at a grant.
//
// Times are absolute, in ps, and never go back from call to call.
class CaptureFifo {
 public:
  // Of the words that were granted last, how many have left by a time.
  using LeftBy = std::function<int(std::uint64_t time_ps)>;

  // Throws std::invalid_argument if the configuration has problems.
  explicit CaptureFifo(const CaptureBoardConfig& config);

  // `timing` outlives the frame. The FIFO is empty: the last frame has finished.
  void begin_frame(const CameraTiming& timing, std::uint64_t begin_ps);
  // Pixels arrive until now, and no word leaves.
  void advance(std::uint64_t now_ps);
  // The bus is granted now, after advance(): the complete words as far as their addresses are contiguous.
  // They stay in the FIFO until they leave. Returns how many.
  int grant(std::vector<LineWords>& burst);
  // The burst ends now: its first `words` words have left, when left_by says.
  void leave(std::uint64_t now_ps, int words, const LeftBy& left_by);

  // As of the last advance() or leave(): when the bus is to be asked for, or the frame finishes; at that time
  // itself if it has come. None if that waits for another line. Not while a burst is running.
  std::optional<std::uint64_t> next_ps() const;
  // Whether that is the time at which the frame finishes, with nothing left to ask for.
  bool finishes_next() const { return occupancy_ == 0 && word_ == words_per_line_; }
  std::uint64_t words_per_line() const { return static_cast<std::uint64_t>(words_per_line_); }
  // All pixels have arrived and all words left, or been dropped.
  bool finished() const;
  // Over all frames, as of the last advance() or leave(): a pixel is dropped when it arrives.
  std::uint64_t dropped_pixels() const;

 private:
  void take(std::uint64_t now_ps, const LeftBy* left_by);
  // The words of the arriving line up to word `end`, as far as there is room.
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
  int row_ = 0;                  // the line that arrives, or did last
  int word_ = 0;                 // the next of that line to begin; words_per_line_ if the rest is dropped
  std::deque<LineWords> lines_;  // in the FIFO, oldest first, one entry per line
  int occupancy_ = 0;            // words in it, complete or being filled
  int owed_ = 0;                 // the oldest of them, complete at the last grant
  bool drops_line_ = false;      // the rest of the line that arrives
  std::uint64_t dropped_pixels_ = 0;  // to the end of that line
};

}  // namespace stereotlm::capture
