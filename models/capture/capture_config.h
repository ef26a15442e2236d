#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/integer_rule.h"

namespace stereotlm::capture {

inline constexpr kernels::IntegerRule kWidthRule{4, 8192, 4};   // pixels
inline constexpr kernels::IntegerRule kHeightRule{1, 8192};     // pixels
inline constexpr double kMinFrameRateHz = 0.1;                  // of CameraConfig::frame_rate_hz
inline constexpr double kMaxFrameRateHz = 1000;                 // of CameraConfig::frame_rate_hz
inline constexpr kernels::IntegerRule kFifoWordsRule{1, 4096};  // 32-bit words

// When the frames of a camera begin.
enum class CameraTrigger : std::uint8_t {
  kFreeRunning,  // frame k begins at k / frame_rate_hz
  kOnDemand,     // a frame begins when the camera is triggered
};

// The configuration of a Camera.
struct CameraConfig {
  int width = 640;               // pixels, kWidthRule
  int height = 480;              // pixels, kHeightRule
  double frame_rate_hz = 29.97;  // kMinFrameRateHz..kMaxFrameRateHz; stands for the decimal number as written
  CameraTrigger trigger = CameraTrigger::kFreeRunning;  // free-running, or on demand
};

// The configuration of a CaptureBoard.
struct CaptureBoardConfig {
  int fifo_words = 140;         // capacity in 32-bit words, kFifoWordsRule
  int fifo_trigger_words = 32;  // complete words at which the FIFO requests the bus, 1..fifo_words
};

// Every broken rule as `field = value: rule`; empty if the block can be built.
std::vector<std::string> problems(const CameraConfig& config);
std::vector<std::string> problems(const CaptureBoardConfig& config);

}  // namespace stereotlm::capture
