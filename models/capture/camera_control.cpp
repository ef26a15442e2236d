#include "models/capture/camera_control.h"

#include <cstddef>
#include <stdexcept>
#include <string>

#include "models/kernels/words.h"

namespace stereotlm::capture {
namespace {

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

CameraControl::CameraControl(const CameraConfig& config, CameraSource& source, FrameReceiver& board)
    : timing_(config),
      trigger_mode_(config.trigger),
      source_(source),
      board_(board),
      next_ps_(config.trigger == CameraTrigger::kFreeRunning ? 0 : kNever) {}

void CameraControl::trigger(std::uint64_t begin_ps) {
  if (trigger_mode_ == CameraTrigger::kFreeRunning || next_ps_ != kNever || begin_ps < earliest_trigger_ps_) {
    ++stats_.ignored_triggers;
    return;
  }
  next_ps_ = begin_ps;
}

void CameraControl::step(std::uint64_t now_ps) {
  const std::uint64_t number = stats_.frames++;
  frame_begin_ps_ = now_ps;
  earliest_trigger_ps_ = now_ps + timing_.last_pixel_ps();
  taken_ = false;
  next_ps_ = trigger_mode_ == CameraTrigger::kFreeRunning ? timing_.frame_ps(number + 1) : kNever;
  board_.begin_frame({number, now_ps, &timing_});
}

bool CameraControl::take(std::uint64_t number) {
  if (number + 1 != stats_.frames || taken_) {
    throw std::logic_error("frame " + std::to_string(number) + " taken: must be the running one, once; " +
                           std::to_string(stats_.frames) + " have begun");
  }
  const kernels::GrayImage& picture = source_.frame(number, frame_begin_ps_);
  if (picture.width != timing_.width() || picture.height != timing_.height()) {
    throw std::logic_error("picture of frame " + std::to_string(number) + " = " +
                           size_text(picture.width, picture.height) + ": must be " +
                           size_text(timing_.width(), timing_.height()));
  }
  taken_ = true;
  picture_ = &picture;
  return true;
}

void CameraControl::copy_words(int first, int count, std::uint32_t* to) const {
  kernels::words_of_pixels(picture_->pixels.data() + std::ptrdiff_t{first} * kernels::kPixelsPerWord, count,
                           to);
}

}  // namespace stereotlm::capture
