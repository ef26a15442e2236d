#include "models/capture/camera.h"

#include <stdexcept>
#include <string>

#include "models/kernel_time.h"

namespace stereotlm::capture {

Camera::Camera(const sc_core::sc_module_name& name, const CameraConfig& config, CameraSource& source)
    : sc_module(name), control_(config, source, *this) {
  kernel_time::check_resolution();
  SC_HAS_PROCESS(Camera);
  SC_METHOD(step);
  sensitive << step_due_;
  if (control_.next_ps() == kNever) dont_initialize();
  SC_METHOD(send_line);
  sensitive << line_begins_;
  dont_initialize();
}

void Camera::trigger(const Trigger& trigger) {
  control_.trigger(kernel_time::now_ps() + kernel_time::to_ps(trigger.delay));
  step_due_.set(control_.next_ps());
}

void Camera::step() {
  step_due_.taken();
  control_.step(kernel_time::now_ps());
  step_due_.set(control_.next_ps());
}

void Camera::take(const TakeFrame& taken) {
  try {
    control_.take(taken.number);
  } catch (const std::logic_error& error) {
    SC_REPORT_ERROR("/stereotlm/camera", (std::string(name()) + ": " + error.what()).c_str());
    return;
  }
  row_ = 0;
  line_begins_.notify(sc_core::SC_ZERO_TIME);
}

void Camera::send_line() {
  const int row = row_++;
  if (row_ < timing().height()) {
    const std::uint64_t next_ps = control_.frame_begin_ps() + timing().row_ps(row_);
    line_begins_.notify(kernel_time::to_time(next_ps - kernel_time::now_ps()));
  }
  lines_out->push({row, control_.row(row)});
}

}  // namespace stereotlm::capture
