#include "tests/support/plain_capture_board.h"

#include <algorithm>
#include <stdexcept>

namespace stereotlm::test {

void PlainCaptureBoard::arm(const PlainPicturePlace& place) {
  armed_ = true;
  next_place_ = place;
}

PlainCaptureBoard::Readiness PlainCaptureBoard::readiness() const {
  if (!armed_) return Readiness::kNotArmed;
  return capturing_ ? Readiness::kBusy : Readiness::kReady;
}

void PlainCaptureBoard::frame_begins(std::uint64_t number, bool partner_is_ready,
                                     const std::vector<std::uint8_t>& pixels) {
  if (!armed_) {
    ++stats_.dropped_not_armed;
  } else if (capturing_) {
    ++stats_.dropped_busy;
  } else if (!partner_is_ready) {
    ++stats_.dropped_by_partner;
  } else {
    ++stats_.captured_frames;
    armed_ = false;
    capturing_ = true;
    frame_ = number;
    begin_ps_ = events_.now();
    place_ = next_place_;
    pixels_ = pixels;
    column_ = 0;
    row_ = 0;
    await_pixel();
  }
}

void PlainCaptureBoard::await_pixel() {
  events_.at(begin_ps_ + plain_pixel_ps(config_.camera, column_, row_), PlainPhase::kPixels,
             [this] { pixel_arrives(); });
}

void PlainCaptureBoard::pixel_arrives() {
  const auto index = static_cast<std::size_t>(row_) * static_cast<std::size_t>(config_.camera.width) +
                     static_cast<std::size_t>(column_);
  if (column_ % 4 == 0 && !drops_line_) {
    if (fifo_.size() == static_cast<std::size_t>(config_.fifo_words)) {
      drops_line_ = true;
    } else {
      fifo_.push_back({index / 4, 0, 0, row_});
    }
  }
  if (drops_line_) {
    ++stats_.dropped_pixels;
  } else {
    fifo_.back().value |= std::uint32_t{pixels_[index]} << (8 * fifo_.back().pixels);
    if (++fifo_.back().pixels == 4) note_level();
  }
  if (++column_ == config_.camera.width) {
    column_ = 0;
    ++row_;
    drops_line_ = false;
  }
  if (!all_pixels_have_come()) await_pixel();
  request_or_finish();
}

std::size_t PlainCaptureBoard::complete_words() const {
  return static_cast<std::size_t>(
      std::count_if(fifo_.begin(), fifo_.end(), [](const Word& word) { return word.pixels == 4; }));
}

void PlainCaptureBoard::note_level() {
  if (levels_.empty() || levels_.back().time_ps != events_.now()) levels_.push_back({events_.now(), 0});
  levels_.back().words = complete_words();
}

void PlainCaptureBoard::request_or_finish() {
  if (asks_ || has_bus_) return;
  if (fifo_.empty()) {
    if (!all_pixels_have_come()) return;
    capturing_ = false;
    done_ = true;
    done_frame_ = frame_;
    done_ps_ = events_.now();
    return;
  }
  const bool line_has_ended = fifo_.front().row < row_;
  const bool triggered = complete_words() >= static_cast<std::size_t>(config_.fifo_trigger_words);
  if (!triggered && !line_has_ended && owed_ == 0) return;
  asks_ = true;
  bus_.request(master_);
}

PlainBurst PlainCaptureBoard::burst() {
  asks_ = false;
  has_bus_ = true;
  owed_ = complete_words();
  PlainBurst burst{true, place_.target, place_.wait_clocks, place_.word + fifo_.front().place, {}};
  for (const Word& word : fifo_) {
    if (word.pixels < 4 || word.place != fifo_.front().place + burst.words.size()) break;
    if (place_.striped && word.row != fifo_.front().row) break;
    burst.words.push_back(word.value);
  }
  burst_words_ = burst.words.size();
  return burst;
}

void PlainCaptureBoard::word_gone() {
  fifo_.pop_front();
  --owed_;
  note_level();
}

void PlainCaptureBoard::lost() {
  for (std::size_t word = 0; word < burst_words_; ++word) word_gone();
  stats_.lost_words += burst_words_;
}

void PlainCaptureBoard::ended(const PlainWords& /*words*/) {
  has_bus_ = false;
  request_or_finish();
}

void PlainCaptureRegisters::write(std::uint64_t word, const PlainWords& words) {
  const std::uint32_t value = words.at(0);
  switch (static_cast<PlainCaptureRegister>(word)) {
    case PlainCaptureRegister::kControl:
      if ((value & kPlainArm) != 0) board_.arm(place_of_(buffer_));
      if ((value & kPlainTrigger) != 0) trigger_();
      break;
    case PlainCaptureRegister::kStatus:
      if ((value & kPlainDone) != 0) board_.clear_done();
      break;
    case PlainCaptureRegister::kBuffer:
      buffer_ = value;
      break;
    case PlainCaptureRegister::kFrameLow:
    case PlainCaptureRegister::kFrameHigh:
      throw std::logic_error("plain capture board: a write of a register that is only read");
  }
}

void PlainCaptureRegisters::read(std::uint64_t word, std::size_t /*count*/, PlainTime /*end_ps*/,
                                 std::function<void(PlainWords)> answer) {
  switch (static_cast<PlainCaptureRegister>(word)) {
    case PlainCaptureRegister::kStatus:
      return answer({board_.done() ? kPlainDone : 0});
    case PlainCaptureRegister::kFrameLow:
      return answer({static_cast<std::uint32_t>(board_.frame_number())});
    case PlainCaptureRegister::kFrameHigh:
      return answer({static_cast<std::uint32_t>(board_.frame_number() >> 32U)});
    case PlainCaptureRegister::kControl:
    case PlainCaptureRegister::kBuffer:
      break;
  }
  throw std::logic_error("plain capture board: a read of a register that the program only writes");
}

}  // namespace stereotlm::test
