#include "models/capture/capture_config.h"

#include <array>
#include <charconv>

namespace stereotlm::capture {

std::vector<std::string> problems(const CameraConfig& config) {
  // The shortest decimal number that parses to the same double.
  const auto text_of = [](double value) {
    std::array<char, 32> text{};
    return std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
  };
  std::vector<std::string> found;
  kWidthRule.check("width", config.width, found);
  kHeightRule.check("height", config.height, found);
  if (!(config.frame_rate_hz >= kMinFrameRateHz && config.frame_rate_hz <= kMaxFrameRateHz)) {
    found.push_back("frame_rate_hz = " + text_of(config.frame_rate_hz) + ": must be " +
                    text_of(kMinFrameRateHz) + ".." + text_of(kMaxFrameRateHz));
  }
  return found;
}

std::vector<std::string> problems(const CaptureBoardConfig& config) {
  std::vector<std::string> found;
  kFifoWordsRule.check("fifo_words", config.fifo_words, found);
  if (config.fifo_trigger_words < 1 || config.fifo_trigger_words > config.fifo_words) {
    found.push_back("fifo_trigger_words = " + std::to_string(config.fifo_trigger_words) + ": must be 1.." +
                    std::to_string(config.fifo_words) + " (fifo_words)");
  }
  return found;
}

}  // namespace stereotlm::capture
