#include "models/capture/capture_fifo.h"

#include <algorithm>

#include "models/checked.h"
#include "models/kernels/words.h"

namespace stereotlm::capture {

using kernels::kPixelsPerWord;

CaptureFifo::CaptureFifo(const CaptureBoardConfig& config)
    : fifo_words_(checked("capture", config).fifo_words), trigger_words_(config.fifo_trigger_words) {}

void CaptureFifo::begin_frame(const CameraTiming& timing, std::uint64_t begin_ps) {
  timing_ = &timing;
  begin_ps_ = begin_ps;
  now_ps_ = begin_ps;
  words_per_line_ = timing.width() / kPixelsPerWord;
  row_ = 0;
  word_ = 0;
  drops_line_ = false;
}

void CaptureFifo::advance(std::uint64_t now_ps) { take(now_ps, nullptr); }

void CaptureFifo::take(std::uint64_t now_ps, const LeftBy* left_by) {
  now_ps_ = now_ps;
  const std::uint64_t since_begin_ps = now_ps - begin_ps_;
  for (;;) {
    if (word_ < words_per_line_) {
      const int pixels = timing_->pixels_by(row_, since_begin_ps);
      take_words((pixels + kPixelsPerWord - 1) / kPixelsPerWord, left_by);
    }
    if (word_ < words_per_line_ || row_ + 1 == timing_->height() ||
        timing_->row_ps(row_ + 1) > since_begin_ps)
      return;
    ++row_;
    word_ = 0;
    drops_line_ = false;
  }
}

void CaptureFifo::take_words(int end, const LeftBy* left_by) {
  // No word before this one can find the FIFO full, even if no word leaves.
  int word = std::min(end, word_ + std::max(0, fifo_words_ - occupancy_));
  const auto finds_it_full = [&] {
    const int left = left_by == nullptr ? 0 : (*left_by)(arrival_ps(word * kPixelsPerWord, row_));
    return occupancy_ + (word - word_) - left >= fifo_words_;
  };
  while (word < end && !finds_it_full()) ++word;
  const int taken = word - word_;
  if (taken > 0) {
    if (lines_.empty() || lines_.back().row != row_) lines_.push_back({row_, word_, 0});
    lines_.back().count += taken;
    occupancy_ += taken;
  }
  word_ = word;
  if (word == end) return;
  dropped_pixels_ += static_cast<std::uint64_t>(timing_->width() - word * kPixelsPerWord);
  word_ = words_per_line_;
  drops_line_ = true;
}

std::uint64_t CaptureFifo::dropped_pixels() const {
  if (!drops_line_) return dropped_pixels_;
  const int arrived = timing_->pixels_by(row_, now_ps_ - begin_ps_);
  return dropped_pixels_ - static_cast<std::uint64_t>(timing_->width() - arrived);
}

int CaptureFifo::complete_words() const {
  if (lines_.empty()) return 0;
  const LineWords& last = lines_.back();
  const int last_column = (last.first + last.count) * kPixelsPerWord - 1;
  return occupancy_ - (arrival_ps(last_column, last.row) > now_ps_ ? 1 : 0);
}

int CaptureFifo::grant(std::vector<LineWords>& burst) {
  burst.clear();
  owed_ = complete_words();
  int granted = 0;
  for (const LineWords& line : lines_) {
    const bool contiguous = burst.empty() || (line.row == burst.back().row + 1 &&
                                              burst.back().first + burst.back().count == words_per_line_);
    const int count = std::min(owed_ - granted, line.count);
    if (!contiguous || count == 0) break;
    burst.push_back({line.row, line.first, count});
    granted += count;
  }
  return granted;
}

void CaptureFifo::leave(std::uint64_t now_ps, int words, const LeftBy& left_by) {
  take(now_ps, &left_by);
  occupancy_ -= words;
  owed_ -= words;
  while (words > 0) {
    LineWords& line = lines_.front();
    const int count = std::min(words, line.count);
    line.first += count;
    line.count -= count;
    words -= count;
    if (line.count == 0) lines_.pop_front();
  }
}

std::optional<std::uint64_t> CaptureFifo::next_ps() const {
  if (owed_ > 0 || complete_words() >= trigger_words_ || finished()) return now_ps_;
  if (!lines_.empty() && line_end_ps(lines_.front().row) <= now_ps_) return now_ps_;
  // Below the trigger, all words are of the arriving line, and none of its next words finds the FIFO full.
  const int triggering = word_ + trigger_words_ - occupancy_ - 1;
  if (triggering < words_per_line_) return arrival_ps((triggering + 1) * kPixelsPerWord - 1, row_);
  const std::uint64_t line_end = line_end_ps(row_);
  if (line_end <= now_ps_) return std::nullopt;
  const bool has_words = occupancy_ > 0 || word_ < words_per_line_;
  if (has_words || row_ + 1 == timing_->height()) return line_end;
  return std::nullopt;
}

bool CaptureFifo::finished() const {
  return lines_.empty() && row_ + 1 == timing_->height() && line_end_ps(row_) <= now_ps_;
}

}  // namespace stereotlm::capture
