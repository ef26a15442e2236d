#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "models/capture/camera_link.h"
#include "models/capture/camera_timing.h"
#include "models/capture/capture_config.h"
#include "models/kernels/gray_image.h"
#include "models/kernels/words.h"
#include "models/time_ps.h"

namespace stereotlm::capture {

// Supplies the pictures of a camera.
class CameraSource {
 public:
  virtual ~CameraSource() = default;
  // Returns the picture of camera frame `number`, which began at `begin_ps`. It has the camera's size and
  // stays valid until the next call. Called only for taken frames, in their order.
  virtual const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t begin_ps) = 0;
};

// The frames of a Camera: when they begin, which of them are taken, and which triggers are ignored. Its only
// steps are the beginnings of frames. Plain C++.
class CameraControl : public FrameCamera {
 public:
  // What the camera has counted since time 0.
  struct Stats {
    std::uint64_t frames = 0;            // frames that have begun
    std::uint64_t ignored_triggers = 0;  // as described at Camera
  };

  // `source` and `board` outlive the camera. Throws std::invalid_argument if the configuration has problems.
  CameraControl(const CameraConfig& config, CameraSource& source, FrameReceiver& board)
      : timing_(config),
        trigger_mode_(config.trigger),
        source_(source),
        board_(board),
        next_ps_(config.trigger == CameraTrigger::kFreeRunning ? 0 : kNever) {}

  // The time at which step() is to be called next; kNever: a trigger may change it.
  std::uint64_t next_ps() const { return next_ps_; }
  // Begins a frame.
  void step(std::uint64_t now_ps) {
    const std::uint64_t number = stats_.frames++;
    frame_begin_ps_ = now_ps;
    earliest_trigger_ps_ = now_ps + timing_.last_pixel_ps();
    taken_ = false;
    next_ps_ = trigger_mode_ == CameraTrigger::kFreeRunning ? timing_.frame_ps(number + 1) : kNever;
    board_.begin_frame({number, now_ps, &timing_});
  }

  // Throws std::logic_error if frame `number` is not the running one, has been taken already, or if its
  // picture has another size.
  bool take(std::uint64_t number) override {
    const auto size_text = [](int width, int height) {
      return std::to_string(width) + " x " + std::to_string(height);
    };
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
  void copy_words(int first, int count, std::uint32_t* to) const override {
    kernels::words_of_pixels(picture_->pixels.data() + std::ptrdiff_t{first} * kernels::kPixelsPerWord, count,
                             to);
  }
  void trigger(std::uint64_t begin_ps) override {
    if (trigger_mode_ == CameraTrigger::kFreeRunning || next_ps_ != kNever ||
        begin_ps < earliest_trigger_ps_) {
      ++stats_.ignored_triggers;
      return;
    }
    next_ps_ = begin_ps;
  }

  const CameraTiming& timing() const { return timing_; }  // when frames begin and pixels arrive
  const Stats& stats() const { return stats_; }           // counts up to the last step

 private:
  CameraTiming timing_;
  CameraTrigger trigger_mode_;
  CameraSource& source_;
  FrameReceiver& board_;
  std::uint64_t next_ps_;
  std::uint64_t earliest_trigger_ps_ = 0;
  std::uint64_t frame_begin_ps_ = 0;
  bool taken_ = false;                           // the running frame
  const kernels::GrayImage* picture_ = nullptr;  // of the last frame taken
  Stats stats_;
};

}  // namespace stereotlm::capture
