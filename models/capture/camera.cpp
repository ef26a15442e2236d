#include "models/capture/camera.h"

#include <stdexcept>
#include <string>

#include "models/kernel_time.h"

namespace stereotlm::capture {

Camera::Camera(const sc_core::sc_module_name& name, const CameraConfig& config, CameraSource& source)
    : sc_module(name), control_(config, source, *this) {
  kernel_time::check_resolution(*this);
  link.bind(*this);
  SC_HAS_PROCESS(Camera);
  SC_METHOD(step);
  sensitive << step_due_;
  if (control_.next_ps() == kNever) dont_initialize();
}

// Not inline: see TestHost::nb_transport_bw().
void Camera::begin_frame(const VideoFrame& frame) { frames_out->push(frame); }

bool Camera::take(std::uint64_t number) {
  try {
    return control_.take(number);
  } catch (const std::logic_error& error) {
    SC_REPORT_ERROR("/stereotlm/camera", (std::string(name()) + ": " + error.what()).c_str());
    return false;
  }
}

void Camera::trigger(std::uint64_t begin_ps) {
  control_.trigger(begin_ps);
  step_due_.set(control_.next_ps());
}

void Camera::step() {
  step_due_.taken();
  control_.step(kernel_time::now_ps());
  step_due_.set(control_.next_ps());
}

}  // namespace stereotlm::capture
