#include "models/capture/camera.h"

#include <string>

#include "models/kernel_time.h"

namespace stereotlm::capture {
namespace {

constexpr const char* kReport = "/stereotlm/camera";

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

Camera::Camera(const sc_core::sc_module_name& name, const CameraConfig& config, CameraSource& source)
    : sc_module(name), timing_(config), trigger_mode_(config.trigger), source_(source) {
  kernel_time::check_resolution();
  SC_HAS_PROCESS(Camera);
  SC_METHOD(begin_frame);
  sensitive << frame_begins_;
  if (trigger_mode_ == CameraTrigger::kOnDemand) dont_initialize();
  SC_METHOD(send_line);
  sensitive << line_begins_;
  dont_initialize();
}

void Camera::trigger(const Trigger& trigger) {
  const std::uint64_t begin_ps = kernel_time::now_ps() + kernel_time::to_ps(trigger.delay);
  if (trigger_mode_ == CameraTrigger::kFreeRunning || triggered_ || begin_ps < next_begin_ps_) {
    ++stats_.ignored_triggers;
    return;
  }
  triggered_ = true;
  frame_begins_.notify(trigger.delay);
}

void Camera::begin_frame() {
  triggered_ = false;
  frame_begin_ps_ = kernel_time::now_ps();
  next_begin_ps_ = frame_begin_ps_ + timing_.last_pixel_ps();
  image_ = nullptr;
  const std::uint64_t number = stats_.frames++;
  if (trigger_mode_ == CameraTrigger::kFreeRunning)
    frame_begins_.notify(kernel_time::to_time(timing_.frame_ps(number + 1) - frame_begin_ps_));
  frames_out->push({number, frame_begin_ps_, &timing_});
}

void Camera::take(const TakeFrame& taken) {
  if (taken.number + 1 != stats_.frames || image_ != nullptr) {
    const std::string text = std::string(name()) + ": frame " + std::to_string(taken.number) +
                             " taken: must be the running one, once; " + std::to_string(stats_.frames) +
                             " have begun";
    SC_REPORT_ERROR(kReport, text.c_str());
    return;
  }
  const kernels::GrayImage& image = source_.frame(taken.number, frame_begin_ps_);
  if (image.width != timing_.width() || image.height != timing_.height()) {
    const std::string text = std::string(name()) + ": picture of frame " + std::to_string(taken.number) +
                             " = " + size_text(image.width, image.height) + ": must be " +
                             size_text(timing_.width(), timing_.height());
    SC_REPORT_ERROR(kReport, text.c_str());
    return;
  }
  image_ = &image;
  row_ = 0;
  line_begins_.notify(sc_core::SC_ZERO_TIME);
}

void Camera::send_line() {
  const int row = row_++;
  if (row_ < timing_.height())
    line_begins_.notify(kernel_time::to_time(frame_begin_ps_ + timing_.row_ps(row_) - kernel_time::now_ps()));
  const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(timing_.width());
  lines_out->push({row, image_->pixels.data() + first});
}

}  // namespace stereotlm::capture
