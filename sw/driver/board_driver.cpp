#include "sw/driver/board_driver.h"

#include "platform/config/buffer_layout.h"

namespace stereotlm::driver {

DriverConfig driver_config(const platform::BoardConfig& board, std::uint64_t frames) {
  DriverConfig config;
  config.width = board.image.width;
  config.height = board.image.height;
  config.frames = frames;
  config.buffers = platform::buffer_bases(board);
  config.capture_to_host = board.capture.destination == platform::CaptureDestination::kHostMemory;
  config.host_frames = board.capture.host_frames;
  config.trigger_cameras = board.cameras.trigger == platform::CameraTrigger::kOnDemand;
  return config;
}

}  // namespace stereotlm::driver
