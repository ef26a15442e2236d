#include "tests/unit/capture/plain_capture.h"

#include <algorithm>
#include <deque>

namespace stereotlm::test {
namespace {

struct FifoWord {
  std::uint64_t address = 0;
  std::uint32_t value = 0;
  int pixels = 0;
  int row = 0;
};

class Board {
 public:
  Board(const PlainBoard& board, const std::vector<std::uint8_t>& pixels,
        const std::vector<PlainAnswer>& answers)
      : board_(board), pixels_(pixels), answers_(answers) {}

  // At every time at which anything happens: words leave, a pixel arrives, a burst ends, the bus is asked
  // for, a burst begins.
  PlainCapture run() {
    while (!result_.end_ps) {
      const auto now = next_time();
      if (!now) return result_;
      while (burst_ && left_ < answer().left_ps.size() && answer().left_ps[left_] <= *now) leave();
      if (burst_ && answer().lost && answer().end_ps == *now) lose();
      if (row_ < board_.camera.height && pixel_time() == *now) arrive();
      if (burst_ && answer().end_ps == *now) end_burst();
      if (!burst_ && !asked_) consider(*now);
      if (asked_ && answers_.size() > answered_ && answer().granted_ps == *now) begin_burst();
    }
    return result_;
  }

 private:
  const PlainAnswer& answer() const { return answers_[answered_]; }
  std::uint64_t pixel_time() const { return board_.begin_ps + plain_pixel_ps(board_.camera, column_, row_); }

  std::optional<std::uint64_t> next_time() const {
    std::optional<std::uint64_t> next;
    const auto consider_time = [&next](std::uint64_t time) { next = std::min(next.value_or(time), time); };
    if (row_ < board_.camera.height) consider_time(pixel_time());
    if (burst_) consider_time(left_ < answer().left_ps.size() ? answer().left_ps[left_] : answer().end_ps);
    if (asked_ && answered_ < answers_.size()) consider_time(answer().granted_ps);
    return next;
  }

  void arrive() {
    const auto index = static_cast<std::uint64_t>(row_) * static_cast<std::uint64_t>(board_.camera.width) +
                       static_cast<std::uint64_t>(column_);
    if (column_ % 4 == 0 && !dropping_) {
      if (fifo_.size() == static_cast<std::size_t>(board_.fifo_words)) {
        dropping_ = true;
      } else {
        fifo_.push_back({board_.address + index, 0, 0, row_});
      }
    }
    if (dropping_) {
      ++result_.dropped_pixels;
      if (!result_.first_dropped) result_.first_dropped = {column_, row_};
    } else {
      FifoWord& word = fifo_.back();
      word.value |= std::uint32_t{pixels_[index]} << (8 * word.pixels);
      ++word.pixels;
    }
    if (++column_ < board_.camera.width) return;
    column_ = 0;
    ++row_;
    dropping_ = false;
  }

  int complete() const {
    return static_cast<int>(
        std::count_if(fifo_.begin(), fifo_.end(), [](const FifoWord& word) { return word.pixels == 4; }));
  }

  void consider(std::uint64_t now) {
    if (fifo_.empty()) {
      if (row_ == board_.camera.height) result_.end_ps = now;
      return;
    }
    const bool line_has_ended = fifo_.front().row < row_;
    if (complete() < board_.trigger_words && !line_has_ended && owed_ == 0) return;
    asked_ = true;
    result_.asked_ps.push_back(now);
  }

  void begin_burst() {
    asked_ = false;
    burst_ = true;
    left_ = 0;
    owed_ = complete();
    std::vector<PlainCapture::Word> words;
    for (const FifoWord& word : fifo_) {
      if (word.pixels < 4 || (!words.empty() && word.address != words.back().first + 4)) break;
      words.emplace_back(word.address, word.value);
    }
    result_.bursts.push_back(words);
  }
  void leave() {
    fifo_.pop_front();
    --owed_;
    ++left_;
  }
  void lose() {
    for (std::size_t i = 0; i < result_.bursts.back().size(); ++i) {
      fifo_.pop_front();
      --owed_;
      ++result_.lost_words;
    }
  }
  void end_burst() {
    burst_ = false;
    ++answered_;
  }

  const PlainBoard& board_;
  const std::vector<std::uint8_t>& pixels_;
  const std::vector<PlainAnswer>& answers_;
  int column_ = 0;
  int row_ = 0;
  bool dropping_ = false;
  std::deque<FifoWord> fifo_;
  int owed_ = 0;
  bool asked_ = false;
  bool burst_ = false;
  std::size_t answered_ = 0;
  std::size_t left_ = 0;
  PlainCapture result_;
};

}  // namespace

PlainCapture plain_capture(const PlainBoard& board, const std::vector<std::uint8_t>& pixels,
                           const std::vector<PlainAnswer>& answers) {
  return Board(board, pixels, answers).run();
}

}  // namespace stereotlm::test
