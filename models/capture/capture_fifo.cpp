#include "models/capture/capture_fifo.h"

#include <algorithm>

#include "models/checked.h"
#include "models/kernels/words.h"

namespace stereotlm::capture {

using kernels::kPixelsPerWord;

// While a burst runs, ranges for fifo_words further words may enter before its own words are removed.
CaptureFifo::CaptureFifo(const CaptureBoardConfig& config)
    : fifo_words_(checked("capture", config).fifo_words),
      trigger_words_(config.fifo_trigger_words),
      ranges_(2 * static_cast<std::size_t>(fifo_words_)) {}

void CaptureFifo::begin_frame(const CameraTiming& timing, std::uint64_t begin_ps) {
  timing_ = &timing;
  begin_ps_ = begin_ps;
  now_ps_ = begin_ps;
  words_per_line_ = timing.width() / kPixelsPerWord;
  begin_line(0);
}

void CaptureFifo::begin_line(int row) {
  row_ = row;
  first_word_ = row * words_per_line_;
  line_end_ps_ = arrival_ps(timing_->width() - 1, row);
  next_line_ps_ = row + 1 < timing_->height() ? arrival_ps(0, row + 1) : kNever;
  pixels_ = 0;
  taken_ = shown_ = 0;
  drops_line_ = false;
}

void CaptureFifo::advance(std::uint64_t now_ps) {
  take(now_ps, [](std::uint64_t /*time_ps*/) { return 0; });
}

template <class LeftBy>
void CaptureFifo::take(std::uint64_t now_ps, const LeftBy& left_by) {
  now_ps_ = now_ps;
  for (;; begin_line(row_ + 1)) {
    pixels_ = line_end_ps_ <= now_ps ? timing_->width() : timing_->pixels_by(row_, now_ps - begin_ps_);
    take_words((pixels_ + kPixelsPerWord - 1) / kPixelsPerWord, left_by);
    if (observer_ != nullptr) show_words();
    if (now_ps < next_line_ps_) return;
  }
}

template <class LeftBy>
void CaptureFifo::take_words(int end, const LeftBy& left_by) {
  if (drops_line_) return;
  // No word before this one can find the FIFO full, even if no word leaves.
  int word = std::min(end, taken_ + std::max(0, fifo_words_ - occupancy_));
  const auto finds_it_full = [&] {
    return occupancy_ + (word - taken_) - left_by(arrival_ps(word * kPixelsPerWord, row_)) >= fifo_words_;
  };
  if (word < end) ++full_checks_;
  while (word < end && !finds_it_full()) ++word;
  append(word - taken_);
  if (word == end) return;
  drops_line_ = true;
  dropped_pixels_ += static_cast<std::uint64_t>(timing_->width() - word * kPixelsPerWord);
}

void CaptureFifo::show_words() {
  for (; shown_ < std::min(taken_, pixels_ / kPixelsPerWord); ++shown_)
    observer_->word_came(arrival_ps((shown_ + 1) * kPixelsPerWord - 1, row_));
}

void CaptureFifo::skip_line(std::uint64_t now_ps) {
  begin_line(row_ + 1);
  pixels_ = timing_->width();
  taken_ = words_per_line_;
  now_ps_ = now_ps;
  if (observer_ == nullptr) return;
  show_words();
  observer_->words_left(now_ps, static_cast<std::size_t>(taken_));
}

// The number of words changes with the first and with the last pixel of each word.
CaptureFifo::Span CaptureFifo::same_words(int row, std::uint64_t time_ps) const {
  const int pixels = timing_->pixels_by(row, time_ps - begin_ps_);
  const int first_of_word = pixels / kPixelsPerWord * kPixelsPerWord;
  if (pixels != first_of_word)
    return {arrival_ps(first_of_word, row), arrival_ps(first_of_word + kPixelsPerWord - 1, row)};
  return {arrival_ps(pixels - 1, row),
          pixels != timing_->width() ? arrival_ps(pixels, row) : arrival_ps(0, row + 1)};
}

// The next words of the arriving line enter.
void CaptureFifo::append(int words) {
  if (words == 0) return;
  const int first = first_word_ + taken_;
  if (occupancy_ == 0) {
    ranges_[oldest_] = {first, 0};
    newest_ = oldest_;
  } else if (ranges_[newest_].first + ranges_[newest_].count != first) {
    newest_ = newest_ + 1 < ranges_.size() ? newest_ + 1 : 0;
    ranges_[newest_] = {first, 0};
  }
  ranges_[newest_].count += words;
  taken_ += words;
  occupancy_ += words;
}

// Words of the oldest range leave.
void CaptureFifo::remove(int words) {
  FrameWords& range = ranges_[oldest_];
  range.first += words;
  range.count -= words;
  occupancy_ -= words;
  owed_ -= words;
  if (range.count == 0 && occupancy_ > 0) oldest_ = oldest_ + 1 < ranges_.size() ? oldest_ + 1 : 0;
}

std::uint64_t CaptureFifo::dropped_pixels() const {
  return drops_line_ ? dropped_pixels_ - static_cast<std::uint64_t>(timing_->width() - pixels_)
                     : dropped_pixels_;
}

// Only the last word of the arriving line can be incomplete.
int CaptureFifo::complete_words() const { return occupancy_ - (taken_ * kPixelsPerWord > pixels_ ? 1 : 0); }

FrameWords CaptureFifo::grant() {
  owed_ = complete_words();
  const FrameWords& range = ranges_[oldest_];
  return {range.first, std::min(range.count, owed_)};
}

void CaptureFifo::transfer(std::uint64_t now_ps, const pci::BurstResult& transferred, const Clock& clock) {
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

void CaptureFifo::lose(std::uint64_t now_ps, int words) {
  take(now_ps, [=](std::uint64_t time_ps) { return time_ps < now_ps ? 0 : words; });
  remove(words);
  if (observer_ != nullptr) observer_->words_left(now_ps, static_cast<std::size_t>(words));
}

std::uint64_t CaptureFifo::next_ps() const {
  const bool line_has_ended = line_end_ps_ <= now_ps_;
  if (occupancy_ > 0) {
    const bool holds_ended_line = line_has_ended || ranges_[oldest_].first < first_word_;
    if (owed_ > 0 || holds_ended_line || complete_words() >= trigger_words_) return now_ps_;
  } else if (line_has_ended || drops_line_) {
    // Nothing happens before the next line, which finds the FIFO empty.
    if (next_line_ps_ == kNever) return std::max(now_ps_, line_end_ps_);
    return first_request_ps(row_ + 1);
  }
  // Below the trigger, all words are of the arriving line, and none of its next words finds the FIFO full.
  const int triggering = taken_ + trigger_words_ - occupancy_;
  return drops_line_ || triggering >= words_per_line_ ? line_end_ps_
                                                      : arrival_ps(triggering * kPixelsPerWord - 1, row_);
}

}  // namespace stereotlm::capture
