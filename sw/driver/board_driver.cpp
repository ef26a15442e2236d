#include "sw/driver/board_driver.h"

#include "platform/buffer_words.h"

namespace stereotlm::driver {

DriverConfig driver_config(const platform::BoardConfig& board, std::uint64_t frames) {
  const platform::BufferWords buffers = platform::buffer_words(board);
  DriverConfig config;
  config.width = board.image.width;
  config.height = board.image.height;
  config.frames = frames;
  config.left_images = buffers.left_images;
  config.right_images = buffers.right_images;
  config.disparities = buffers.disparities;
  config.left_lut = buffers.left_lut;
  config.right_lut = buffers.right_lut;
  config.capture_to_host = board.capture.destination == platform::CaptureDestination::kHostMemory;
  config.host_frames = board.capture.host_frames;
  config.trigger_cameras = board.cameras.trigger == platform::CameraTrigger::kOnDemand;
  return config;
}

}  // namespace stereotlm::driver
