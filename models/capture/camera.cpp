#include "models/capture/camera.h"

#include <stdexcept>
#include <string>

namespace stereotlm::capture {

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

}  // namespace stereotlm::capture
